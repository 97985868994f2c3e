"""The sum over asperities along the path of the flat."""

from roughmdr.aggregate.load_separation import LoadSeparation, compute, load_separation, prepare
from roughmdr.loading.path import Route

__all__ = ["LoadSeparation", "Route", "compute", "load_separation", "prepare"]
