"""Checkpoints of a batch: keys of cells, the file of task results, and their reuse."""
