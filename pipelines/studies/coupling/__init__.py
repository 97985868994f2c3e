"""The study of coupled asperities: error against run time, and run time against their number."""
