"""The picture of ``random_scenes.py``, drawn from its numbers."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = ("#1b6ca8", "#e0a030", "#b8bcc2")


def draw(result: xr.Dataset) -> "Figure":
    """What became of the scenes, by shape and by how they were asked for."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.5, 6.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 0.9))
    _bars(left, [("shape", str(name)) for name in result["shape"].to_numpy()], result)
    others = ("adhesion", "source", "estimator")
    _bars(right, [(kind, str(name)) for kind in others for name in result[kind].to_numpy()], result)
    left.set_title(f"{int(result.scenes.sum())} scenes by the shape of the asperities")
    right.set_title("and by adhesion, source and estimator")
    left.legend(loc="lower right", fontsize=9)
    return figure


def _bars(panel: "Axes", rows: list[tuple[str, str]], result: xr.Dataset) -> None:
    """A bar for each of some kinds of scenes, with one part for each outcome."""
    others = {kind: [name for name in result.scenes.dims if name not in (kind, "outcome")] for kind, _ in rows}
    counts = np.array([result.scenes.sum(others[kind]).sel({kind: name}).to_numpy() for kind, name in rows])
    # A gap between one kind and the next.
    kinds = [kind for kind, _ in rows]
    places = np.arange(len(rows)) + np.array([0.7 * len(dict.fromkeys(kinds[: i + 1])) for i in range(len(rows))])
    before = np.zeros(len(rows))
    for own, outcome, colour in zip(counts.T, result.outcome.to_numpy(), _COLOURS, strict=True):
        panel.barh(places, own, left=before, color=colour, label=str(outcome), height=0.78)
        before += own
    labels = [f"{name} ({kind})" if len(set(kinds)) > 1 else name.replace("_", " ") for kind, name in rows]
    panel.set_yticks(places, labels)
    panel.invert_yaxis()
    panel.set_xlabel("scenes")
    panel.grid(axis="x", color="0.92")
    panel.set_axisbelow(True)
