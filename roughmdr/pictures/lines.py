"""Lines drawn over the curves of a result: its expected law, theory curves, its reference."""

from typing import NamedTuple

from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView

EXPECTED = "expected"
REFERENCE = "boundary elements"
_ABSENT = "the result holds no reference; run its scene with --set reference.model=boundary_elements"


class OverlayLine(NamedTuple):
    """A curve drawn over a result: a variable in one cell, over the whole path."""

    label: str  # name of the theory curve; ``EXPECTED`` for the expected law of the scene, or ``REFERENCE``
    variable: str
    cell: int
    x: Floats  # separation [m], or the variable drawn over
    values: Floats  # NaN where the theory gives none


class Overlay(NamedTuple):
    """Lines to draw, and remarks on those that are drawn or, with the reason, are not."""

    lines: list[OverlayLine]
    remarks: list[str]

    def over(self, name: str) -> "Overlay":
        """Return the lines over another of their variables, without those that lack it."""
        x = {(line.label, line.cell): line.values for line in self.lines if line.variable == name}
        found = [line for line in self.lines if line.variable != name and (line.label, line.cell) in x]
        remarks = self.remarks if found or not self.lines else [f"not drawn: nothing of it is over {name}"]
        return Overlay([line._replace(x=x[line.label, line.cell]) for line in found], remarks)


def overlay_reference(result: ResultView, names: list[str]) -> Overlay:
    """Return the mean law by boundary elements of each cell, in those of the variables that the result has of it."""
    given = [name for name in names if result.holds(f"reference_{name}")]
    if not given:
        return Overlay([], [f"not drawn: {_ABSENT}"])
    separation = result.path
    lines = [
        OverlayLine(REFERENCE, name, number, separation[cell], result.mean(f"reference_{name}")[0][cell])
        for name in given
        for number, cell in enumerate(result.cells)
    ]
    return Overlay(lines, ["drawn"])
