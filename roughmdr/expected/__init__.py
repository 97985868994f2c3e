"""The expected law of an ensemble: integrals over the distribution of its asperities, instead of draws from it."""

from roughmdr.expected.compute import compute, prepare
from roughmdr.expected.force import Changes, ForceRule, expected_force

__all__ = ["Changes", "ForceRule", "compute", "expected_force", "prepare"]
