"""The profiles of single asperities. A new shape is one file here and one line in ``SHAPES``."""

from roughmdr.shapes.base import Curved, Shape
from roughmdr.shapes.capped import CappedParaboloid
from roughmdr.shapes.flat import FlatPunch
from roughmdr.shapes.power import Cone, Paraboloid, PowerLaw
from roughmdr.shapes.rounded import RoundedCone, RoundedPunch
from roughmdr.shapes.sphere import Sphere
from roughmdr.shapes.truncated import TruncatedCone, TruncatedParaboloid

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
    )
}

__all__ = [
    "SHAPES",
    "CappedParaboloid",
    "Cone",
    "Curved",
    "FlatPunch",
    "Paraboloid",
    "PowerLaw",
    "RoundedCone",
    "RoundedPunch",
    "Shape",
    "Sphere",
    "TruncatedCone",
    "TruncatedParaboloid",
]
