"""Pictures of results, ensembles and asperities."""
