"""The expected law of an ensemble: integrals over the distribution that asperities are drawn from, instead of draws."""

from roughmdr.expected.compute import compute, prepare

__all__ = ["compute", "prepare"]
