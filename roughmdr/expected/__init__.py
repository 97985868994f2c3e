"""The expected law of an ensemble: integrals over the distribution of its asperities, instead of draws from it."""

from roughmdr.expected.compute import compute, force_of_equal_shapes, prepare

__all__ = ["compute", "force_of_equal_shapes", "prepare"]
