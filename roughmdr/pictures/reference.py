"""The law by boundary elements over a picture of the result that holds it."""

from roughmdr.pictures.lines import REFERENCE, Overlay, OverlayLine
from roughmdr.result.layout import cells_of, controlled_values
from roughmdr.result.means import holds, mean_of
from roughmdr.storage.labelled import Labelled

_ABSENT = "the result holds no reference; run its scene with --set reference.model=boundary_elements"


def overlay_reference(result: Labelled, names: list[str]) -> Overlay:
    """Return the mean law by boundary elements of each cell, in those of the variables that the result has of it."""
    given = [name for name in names if holds(result, f"reference_{name}")]
    if not given:
        return Overlay([], [f"not drawn: {_ABSENT}"])
    separation = controlled_values(result)
    lines = [
        OverlayLine(REFERENCE, name, number, separation[cell], mean_of(result, f"reference_{name}")[0][cell])
        for name in given
        for number, cell in enumerate(cells_of(result))
    ]
    return Overlay(lines, ["drawn"])
