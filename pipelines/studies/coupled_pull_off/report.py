"""The study of coupled pull-off: its picture and its words."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from studies.coupled_pull_off.measure import SPREADS
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = dict(zip(SPREADS, ("#1b6ca8", "#c8553d", "#5b8c3e"), strict=True))
_FIRST_OF_NUMBER = 100  # seed


class Group(NamedTuple):
    """Samples that differ by their seed alone."""

    number: float
    spacing: float
    spread: float
    own: xr.Dataset

    @property
    def crowded(self) -> bool:
        """Whether contacts overlap as soon as they are made in one of them."""
        return bool(self.own["crowded"].any())

    @property
    def change(self) -> tuple[float, float]:
        """Change of the pull-off force by coupling [%], mean and standard error."""
        change = 100.0 * (self.own["coupled"] / self.own["independent"] - 1.0).to_numpy()
        return float(change.mean()), float(change.std(ddof=1) / change.size**0.5) if change.size > 1 else 0.0

    def mean(self, name: str) -> float:
        """Return the mean of a variable."""
        return float(self.own[name].mean())


def groups(result: xr.Dataset, *, of_number: bool) -> list[Group]:
    """Return the samples over density, or those over number."""
    part = result.isel(sample=np.flatnonzero((result["seed"].to_numpy() >= _FIRST_OF_NUMBER) == of_number))
    keys = np.column_stack([part[name].to_numpy() for name in ("asperities", "spacing", "spread")])
    return [
        Group(key[0], key[1], key[2], part.isel(sample=np.flatnonzero((keys == key).all(axis=1))))
        for key in np.unique(keys, axis=0)
    ]


def draw(result: xr.Dataset) -> "Figure":
    """Draw pull-off over density, its change over the number, and the largest avalanche."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 4.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    over_density = groups(result, of_number=False)
    for spread in SPREADS:
        own = [group for group in over_density if group.spread == spread]
        colour, spacing = _COLOURS[spread], [group.spacing for group in own]
        left.semilogx(spacing, [group.mean("independent") for group in own], "--", color=colour, lw=1.2)
        _points(left, own, [group.mean("coupled") for group in own], colour, f"height spread {spread:g}")
        _points(right, own, [100.0 * group.mean("largest") for group in own], colour, f"height spread {spread:g}")
    for group in groups(result, of_number=True):
        mean, error = group.change
        middle.errorbar(group.number, mean, error, fmt="o", color=_COLOURS[1.0], capsize=3, ms=5)
    middle.axhline(0.0, color="0.6", lw=1.0)
    left.set(xlabel="mean spacing over the jump-on radius", ylabel="pull-off force over N lone ones")
    left.set_title("coupled (dots), independent (dashed)")
    middle.set(xscale="log", xlabel="number of asperities", ylabel="change of the pull-off force by coupling [%]")
    middle.set_title("spacing 8, spread 1: mean, standard error")
    right.set(xlabel="mean spacing over the jump-on radius", ylabel="largest avalanche [% of the asperities]")
    right.set_title("circles: overlap as soon as made")
    for panel in (left, middle, right):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    left.legend(fontsize=9)
    return figure


def _points(panel: "Axes", own: list[Group], values: list[float], colour: str, label: str) -> None:
    spacing = [group.spacing for group in own]
    panel.semilogx(spacing, values, "-", color=colour, lw=1.4, label=label)
    for crowded, face in ((False, colour), (True, "white")):
        at = [i for i, group in enumerate(own) if group.crowded == crowded]
        panel.semilogx([spacing[i] for i in at], [values[i] for i in at], "o", color=colour, mfc=face, ms=5)


def report(result: xr.Dataset) -> str:
    """Return the figures over density and over number."""
    rows = [
        [f"{group.spread:g}", f"{group.spacing:g}" + (" (overlap)" if group.crowded else ""),
         f"{group.mean('independent'):.4f}", f"{group.mean('coupled'):.4f}",
         "{:+.2f} ± {:.2f} %".format(*group.change), f"{100.0 * (group.mean('dissipation') - 1.0):+.1f} %",
         f"{100.0 * group.mean('largest'):.1f} %",
         f"{100.0 * group.mean('touching'):.0f} % ({100.0 * group.mean('touching_alone'):.0f})",
         f"{100.0 * group.mean('fraction'):.2g} %"]
        for group in groups(result, of_number=False)
    ]  # fmt: skip
    head = ["height spread", "spacing", "independent", "coupled", "change", "energy lost", "largest avalanche",
            "in contact", "contact fraction"]  # fmt: skip
    over_number = [
        [f"{group.number:.0f}", str(group.own.sizes["sample"]), f"{group.mean('independent'):.4f}",
         "{:+.2f} ± {:.2f} %".format(*group.change), f"{group.mean('largest') * group.number:.1f}"]
        for group in groups(result, of_number=True)
    ]  # fmt: skip
    return f"""Paraboloids of equal radii at random, pressed and pulled off. Spacings are over the jump-on radius,
height spreads over the stretch at which one alone lets go; the flat comes to two such stretches below the mean height.
Forces are over those of all asperities alone; in brackets the share in contact of independent ones. {_marked(result)}

{table(head, rows)}

Over the number, at a spacing of 8 and a spread of 1, mean and standard error:

{table(["asperities", "samples", "independent", "change", "largest avalanche [contacts]"], over_number)}
"""


def _marked(result: xr.Dataset) -> str:
    return f"Of {result.sizes['sample']} cycles {int((result['marked'] > 0).sum())} have marked steps."
