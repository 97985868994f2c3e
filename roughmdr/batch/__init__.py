"""From a plan to its numbers: tasks, their shards, what is kept of them on disk, and when there are enough."""
