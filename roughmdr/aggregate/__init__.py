"""The sum over asperities along the path of the flat."""

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.load_separation import compute, load_separation, prepare
from roughmdr.loading.path import LoadingPath

__all__ = ["LoadSeparation", "LoadingPath", "compute", "load_separation", "prepare"]
