"""The reference of a result: how far its force is off that by boundary elements, and their law over a picture."""

from collections.abc import Iterator

import numpy as np

from roughmdr.batch.moments import mean_and_error
from roughmdr.elements.refine import LIGHT
from roughmdr.numerics.arguments import Floats
from roughmdr.report.plots import REFERENCE, Overlay, OverlayLine
from roughmdr.result.layout import cells_of, controlled_values, done_of
from roughmdr.storage.labelled import Labelled

_ABSENT = "the result holds no reference; run its scene with --set reference.model=boundary_elements"


def reference_lines(result: Labelled) -> Iterator[tuple[str, str]]:
    """Yield how far the mean force is off the reference, where that bears at least ``LIGHT`` of the largest force."""
    name = next((each for each in ("force", "pressure") if _holds(result, each)), None)
    if name is None:
        return
    force, reference, error = (_mean(result, each) for each in (name, f"reference_{name}", "reference_error"))
    points = float(np.nanmax(result.variables["reference_points"].values))
    largest = np.nanmax(reference, axis=-1, initial=0.0)[..., None]
    told = (reference > 0.0) & (reference >= LIGHT * largest) & np.isfinite(force)
    if not told.any():
        missed = "" if float(np.nanmax(error, initial=0.0)) == 0.0 else ", but may have missed light contacts"
        yield "reference", f"boundary elements found no force along the whole path{missed}"
        return
    own = float(np.nanmax(error * reference / np.where(largest > 0.0, np.maximum(reference, LIGHT * largest), 1.0)))
    off = force[told] / reference[told] - 1.0
    yield (
        "reference",
        f"boundary elements on up to {points:.0f} points, right to about {_percent(own)} %: the mean force of the law "
        f"differs from theirs by {_percent(off.min(), '+')} to {_percent(off.max(), '+')} %, "
        f"{_percent(np.sqrt(np.mean(off * off)))} % r.m.s., where theirs is above {100.0 * LIGHT:g} % of the largest",
    )


def _percent(share: float, sign: str = "") -> str:
    """Return a share in per cent with about two digits."""
    value = 100.0 * share
    return f"{value:{sign}.0f}" if abs(value) >= 9.95 else f"{value:{sign}.2g}"


def overlay_reference(result: Labelled, names: list[str]) -> Overlay:
    """Return the mean law by boundary elements of each cell, in those of the variables that the result has of it."""
    given = [name for name in names if _holds(result, name)]
    if not given:
        return Overlay([], [f"not drawn: {_ABSENT}"])
    separation = controlled_values(result)
    lines = [
        OverlayLine(REFERENCE, name, number, separation[cell], _mean(result, f"reference_{name}")[cell])
        for name in given
        for number, cell in enumerate(cells_of(result))
    ]
    return Overlay(lines, ["drawn"])


def _holds(result: Labelled, name: str) -> bool:
    """Return whether a result has a variable beside that of its reference."""
    return any({f"{name}{end}", f"reference_{name}{end}"} <= set(result.variables) for end in ("", "_mean"))


def _mean(result: Labelled, name: str) -> Floats:
    """Return the mean of a variable over the realisations that were computed, over swept keys and step."""
    if f"{name}_mean" in result.variables:
        return result.variables[f"{name}_mean"].values
    return mean_and_error(result.variables[name].values, done_of(result))[0]
