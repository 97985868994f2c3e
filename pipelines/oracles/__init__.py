"""Slow and plain references, each independent of the formulas and the kernels of ``roughmdr`` that it checks."""
