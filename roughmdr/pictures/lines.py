"""Lines drawn over the curves of a result: its expected law, theory curves, its reference."""

from typing import NamedTuple

from roughmdr.numerics.arguments import Floats

EXPECTED = "expected"
REFERENCE = "boundary elements"


class OverlayLine(NamedTuple):
    """A curve drawn over a result: a variable in one cell, over the whole path."""

    label: str  # name of the theory curve; ``EXPECTED`` for the expected law of the scene, or ``REFERENCE``
    variable: str
    cell: int
    separation: Floats
    values: Floats  # NaN where the theory gives none


class Overlay(NamedTuple):
    """Lines to draw, and remarks on whether they are drawn, and if not why."""

    lines: list[OverlayLine]
    remarks: list[str]
