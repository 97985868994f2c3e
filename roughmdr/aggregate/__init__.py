"""The sum over asperities along the path of the flat."""

from roughmdr.aggregate.law import LoadSeparation, compute, load_separation, path_coordinates, whole_path

__all__ = ["LoadSeparation", "compute", "load_separation", "path_coordinates", "whole_path"]
