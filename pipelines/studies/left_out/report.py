"""The study of what is left out: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw(result: xr.Dataset) -> "Figure":
    """Draw how many times as much there is with each part forced on; a mark where there is nothing without."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 0.34 * result.sizes["case"] + 1.2), layout="constrained")
    panel = figure.subplots()
    y = np.arange(result.sizes["case"])
    left, forced = result.counted.to_numpy().T
    ratio = forced / np.where(left > 0.0, left, np.nan)
    panel.barh(y, ratio - 1.0, left=1.0, color="#c8553d", height=0.7)
    panel.plot(np.full(int((left == 0.0).sum()), 1.08), y[left == 0.0], ">", color="#c8553d")
    for at, end, low, high, unit in zip(y, ratio, left, forced, result.unit.to_numpy(), strict=True):
        text = f"{low:,.6g} to {high:,.6g} {unit}"
        panel.annotate(text, (1.12 if np.isnan(end) else end, at), (4, 0), textcoords="offset points", va="center")
    panel.axvline(1.0, color="0.3", lw=1.0)
    panel.set(xscale="log", xlim=(0.9, 300.0 * float(np.nanmax(ratio))))
    panel.set_yticks(y, [f"{part} ({scene})" for part, scene in zip(result.part.data, result.scene.data, strict=True)])
    panel.invert_yaxis()
    panel.set(title="What leaving out saves", xlabel="times as much with the part forced on")
    return figure


def _numbers(case: xr.Dataset) -> list[str]:
    return [f"{number:,.6g}" for number in case.counted.to_numpy()]


def report(result: xr.Dataset) -> str:
    """Return the table, and how far the forces are apart."""
    rows = [
        [*(str(case[name].values) for name in ("part", "scene")), *_numbers(case), str(case.unit.values)]
        for case in (result.isel(case=number) for number in range(result.sizes["case"]))
    ]
    ranged = result.part == "range of adhesion"
    return f"""
{table(["part", "scene", "left out", "forced on", "of"], rows)}

Forced on or left out, the forces are the same to {float(result.difference.where(~ranged).max()):.1g} of the largest.
JKR in place of adhesion with a range is off by {float(result.difference.where(ranged).max()):.1g}, of the 0.01 that the
scene allows.
"""
