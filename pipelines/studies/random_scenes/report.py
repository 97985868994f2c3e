"""The study of scenes drawn at random: its picture and its words."""

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.random_scenes.judge import OUTCOMES
from studies.random_scenes.measure import KINDS
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = ("#1b6ca8", "#e0a030", "#b8bcc2")
_LISTED = 12  # reasons in the table


def draw(result: xr.Dataset) -> "Figure":
    """Draw a bar of outcomes for each shape of the asperities, adhesion, source and estimator."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.5, 6.2), layout="constrained")
    panels = figure.subplot_mosaic([["shape", kind] for kind in KINDS[1:]])
    for kind, panel in panels.items():
        names = np.unique(result[kind])
        before = np.zeros(names.size)
        for outcome, colour in zip(OUTCOMES, _COLOURS, strict=True):
            counts = Counter(result[kind].values[result.outcome == outcome])
            own = np.array([counts[name] for name in names])
            panel.barh([name.replace("_", " ") for name in names], own, left=before, color=colour, label=outcome)
            before += own
        panel.invert_yaxis()
        panel.set(title=kind, xlabel="scenes")
        panel.grid(axis="x", color="0.92")
        panel.set_axisbelow(True)
    panels["shape"].legend(loc="lower right", fontsize=9)
    return figure


def report(result: xr.Dataset) -> str:
    """Return how many scenes there were, what became of them, and why those were refused that were."""
    count, found = result.sizes["scene"], Counter(result.outcome.values)
    outcomes = ", ".join(f"{found[name]} ({100.0 * found[name] / count:.1f} %) {name}" for name in OUTCOMES)
    median, nearly_all, longest = np.quantile(result.run_time, (0.5, 0.99, 1.0))
    reasons = [[f"{n}", f"{why}"] for why, n in Counter(result.reason.values).most_common() if why]
    return f"""
{count} scenes drawn over all that a scene may ask for: {outcomes}. In none of them was there a NaN, an infinite number,
or an exception that is no refusal, and {int(result.comparisons.sum())} claims about their numbers all held: without
adhesion force, area, count and stiffness grow as the flat comes down and have no memory, and the force lies between the
lines that the stiffness draws; with it contacts grow as the flat comes down and shrink as it rises, those that were
pressed deeper before are larger and pull more, nothing lost comes back, and more work of adhesion means larger contacts
and less force. Forces may be off by their stated error, other sums by 1e-12 of the largest; expected curves by their
error.
Half of the scenes take up to {1e3 * median:.0f} ms, 99 % up to {nearly_all:.1g} s, one {longest:.1f} s.

The most frequent of {len(reasons)} reasons to refuse a scene or a run, without their numbers:

{table(["scenes", "reason"], reasons[:_LISTED])}
"""
