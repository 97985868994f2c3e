"""The profiles of single asperities. A new shape is one file here and one line in ``SHAPES``."""

from roughmdr.shapes.base import Shape
from roughmdr.shapes.power import Cone, Paraboloid, PowerLaw

SHAPES: dict[str, type[Shape]] = {shape.name: shape for shape in (Paraboloid, Cone, PowerLaw)}

__all__ = ["SHAPES", "Cone", "Paraboloid", "PowerLaw", "Shape"]
