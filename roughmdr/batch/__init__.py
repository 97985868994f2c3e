"""From a plan to its numbers: tasks, their results, their storage, and when there are enough realisations."""
