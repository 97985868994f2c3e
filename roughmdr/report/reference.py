"""The reference of a result: how far its force is off that by boundary elements."""

from collections.abc import Iterator

import numpy as np

from roughmdr.elements.refine import LIGHT
from roughmdr.result.view import ResultView


def reference_lines(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield how far the mean force is off the reference, where that bears at least ``LIGHT`` of the largest force."""
    name = next(
        (each for each in ("force", "pressure") if result.holds(each) and result.holds(f"reference_{each}")), None
    )
    if name is None:
        return
    force, reference, error = (result.mean(each)[0] for each in (name, f"reference_{name}", "reference_error"))
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
