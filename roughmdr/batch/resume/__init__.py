"""Checkpoints of a batch: keys of cells, the folder of shards, and their reuse."""
