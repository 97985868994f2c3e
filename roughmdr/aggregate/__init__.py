"""The sum over asperities along the path of the flat."""

from roughmdr.aggregate.law import LoadSeparation, Route, compute, load_separation, prepare

__all__ = ["LoadSeparation", "Route", "compute", "load_separation", "prepare"]
