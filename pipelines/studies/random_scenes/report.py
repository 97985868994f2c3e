"""The study of scenes drawn at random: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from studies.random_scenes.judge import OUTCOMES
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = ("#1b6ca8", "#e0a030", "#b8bcc2")
_LISTED = 12  # reasons in the table


def draw(result: xr.Dataset) -> "Figure":
    """Draw what became of the scenes, by shape and by the rest of their kind."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.5, 6.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 0.9))
    _bars(left, result, ["shape"])
    _bars(right, result, ["adhesion", "source", "estimator"])
    left.set_title(f"{int(result.scenes.sum())} scenes by the shape of the asperities")
    right.set_title("and by adhesion, source and estimator")
    left.legend(loc="lower right", fontsize=9)
    return figure


def _bars(panel: "Axes", result: xr.Dataset, kinds: list[str]) -> None:
    """Draw a bar for each kind of scenes, with one part for each outcome, and a gap between kinds."""
    y, labels, counts = list[float](), list[str](), []
    for number, kind in enumerate(kinds):
        sums = result.scenes.sum([name for name in result.scenes.dims if name not in (kind, "outcome")])
        y += (len(y) + 0.7 * number + np.arange(result.sizes[kind])).tolist()
        names = map(str, result[kind].to_numpy())
        labels += [f"{name} ({kind})" if len(kinds) > 1 else name.replace("_", " ") for name in names]
        counts.append(sums.transpose(kind, "outcome").to_numpy())
    before = np.zeros(len(y))
    for own, outcome, colour in zip(np.concatenate(counts).T, OUTCOMES, _COLOURS, strict=True):
        panel.barh(y, own, left=before, color=colour, label=outcome, height=0.78)
        before += own
    panel.set_yticks(y, labels)
    panel.invert_yaxis()
    panel.set_xlabel("scenes")
    panel.grid(axis="x", color="0.92")
    panel.set_axisbelow(True)


def report(result: xr.Dataset) -> str:
    """Return how many scenes there were, what became of them, and why those were refused that were."""
    count = int(result.scenes.sum())
    shares = [int(result.scenes.sel(outcome=name).sum()) for name in OUTCOMES]
    outcomes = ", ".join(f"{n} ({100.0 * n / count:.1f} %) {name}" for n, name in zip(shares, OUTCOMES, strict=True))
    median, nearly_all, longest = result.scene_time.to_numpy()
    pairs = zip(result.reason_count.to_numpy(), result.reason.to_numpy(), strict=True)  # the most frequent first
    reasons = [[f"{number}", str(reason)] for number, reason in pairs]
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
