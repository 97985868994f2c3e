"""Measurements of what the package costs: time, memory and workers."""
