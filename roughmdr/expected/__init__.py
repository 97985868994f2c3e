"""The expected law of an ensemble: integrals over the distribution of its asperities, instead of draws from it."""

from roughmdr.expected.compute import compute, prepare
from roughmdr.expected.force import Changes, Force, ForceRule, Slopes, expected_force, expected_slopes

__all__ = ["Changes", "Force", "ForceRule", "Slopes", "compute", "expected_force", "expected_slopes", "prepare"]
