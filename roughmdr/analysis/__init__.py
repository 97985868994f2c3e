"""Analysis of results and ensembles as Datasets: the accessor ``ds.roughmdr``."""
