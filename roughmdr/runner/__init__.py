"""Tasks over threads, processes or a cluster, and their results as one dataset."""
