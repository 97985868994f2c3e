"""The profiles of single asperities. CONTRIBUTING.md says how to add one: a file here and a line in ``SHAPES``."""

from roughmdr.shapes.array_shapes import SharedProfile, TabledShape
from roughmdr.shapes.base import ProfileShape, Shape
from roughmdr.shapes.blunt_tips import CappedParaboloid, RoundedCone
from roughmdr.shapes.flat_tips import FlatPunch, RoundedPunch, TruncatedCone, TruncatedParaboloid
from roughmdr.shapes.mdr_table import MdrTable
from roughmdr.shapes.power import Cone, Paraboloid, PowerLaw
from roughmdr.shapes.series import PowerSeries
from roughmdr.shapes.sphere import Sphere
from roughmdr.shapes.tabulated.shape import Tabulated

SHAPES: dict[str, type[Shape]] = {
    shape.name: shape
    for shape in (
        Paraboloid,
        Cone,
        PowerLaw,
        FlatPunch,
        Sphere,
        TruncatedCone,
        TruncatedParaboloid,
        RoundedCone,
        CappedParaboloid,
        RoundedPunch,
        PowerSeries,
        Tabulated,
        MdrTable,
    )
}

SCENE_SHAPES = {name: shape for name, shape in SHAPES.items() if not issubclass(shape, TabledShape)}
"""Shapes that a scene draws asperities of; the others are of files and maps alone."""

__all__ = [
    "SCENE_SHAPES",
    "SHAPES",
    "CappedParaboloid",
    "Cone",
    "FlatPunch",
    "MdrTable",
    "Paraboloid",
    "PowerLaw",
    "PowerSeries",
    "ProfileShape",
    "RoundedCone",
    "RoundedPunch",
    "Shape",
    "SharedProfile",
    "Sphere",
    "TabledShape",
    "Tabulated",
    "TruncatedCone",
    "TruncatedParaboloid",
]
