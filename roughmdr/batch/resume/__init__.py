"""Checkpoints of a batch: keys of cells, the folder of task results, and their reuse."""
