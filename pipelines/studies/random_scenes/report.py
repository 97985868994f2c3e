"""The study of scenes drawn at random: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from studies.random_scenes.judge import OUTCOMES
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = ("#1b6ca8", "#e0a030", "#b8bcc2")
_LISTED = 12  # reasons in the table


def draw(result: xr.Dataset) -> "Figure":
    """Draw a bar of outcomes for each shape of the asperities, adhesion, source and estimator."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.5, 6.2), layout="constrained")
    kinds = ("shape", "adhesion", "source", "estimator")
    panels = figure.subplot_mosaic([["shape", kind] for kind in kinds[1:]])
    for kind in kinds:
        panel, names = panels[kind], [str(name).replace("_", " ") for name in result[kind].to_numpy()]
        others = [name for name in result.scenes.dims if name not in (kind, "outcome")]
        before = np.zeros(len(names))
        for outcome, colour in zip(OUTCOMES, _COLOURS, strict=True):
            own = result.scenes.sum(others).sel(outcome=outcome).to_numpy()
            panel.barh(names, own, left=before, color=colour, label=outcome)
            before += own
        panel.invert_yaxis()
        panel.set(title=kind, xlabel="scenes")
        panel.grid(axis="x", color="0.92")
        panel.set_axisbelow(True)
    panels["shape"].legend(loc="lower right", fontsize=9)
    return figure


def report(result: xr.Dataset) -> str:
    """Return how many scenes there were, what became of them, and why those were refused that were."""
    count = int(result.scenes.sum())
    shares = [int(result.scenes.sel(outcome=name).sum()) for name in OUTCOMES]
    outcomes = ", ".join(f"{n} ({100.0 * n / count:.1f} %) {name}" for n, name in zip(shares, OUTCOMES, strict=True))
    median, nearly_all, longest = result.scene_time.to_numpy()
    # The most frequent reasons come first.
    reasons = [[f"{n}", f"{why}"] for n, why in zip(result.reason_count.values, result.reason.values, strict=True)]
    return f"""
{count} scenes drawn over all that a scene may ask for: {outcomes}. In none of them was there a NaN, an infinite number,
or an exception that is no refusal, and {int(result.comparisons)} claims about their numbers all held: without adhesion
force, area, count and stiffness grow as the flat comes down and have no memory, and the force lies between the lines
that the stiffness draws; with it contacts grow as the flat comes down and shrink as it rises, those that were pressed
deeper before are larger and pull more, nothing lost comes back, and more work of adhesion means larger contacts and
less force. Forces may be off by their stated error, other sums by 1e-12 of the largest; expected curves by their error.
Half of the scenes take up to {1e3 * median:.0f} ms, 99 % up to {nearly_all:.1g} s, one {longest:.1f} s.

The most frequent of {len(reasons)} reasons to refuse a scene or a run, without their numbers:

{table(["scenes", "reason"], reasons[:_LISTED])}
"""
