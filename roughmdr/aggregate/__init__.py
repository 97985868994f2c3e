"""The sum over asperities along the path of the flat, or of the machine that moves it."""

from roughmdr.aggregate.compute import compute, prepare
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.load_separation import load_separation
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.simulate import simulate
from roughmdr.loading.path import LoadingPath

__all__ = ["LoadSeparation", "LoadingPath", "Problem", "compute", "load_separation", "prepare", "simulate"]
