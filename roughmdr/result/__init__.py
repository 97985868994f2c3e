"""The result of a batch as a dataset, and numbers derived from it."""
