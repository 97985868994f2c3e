"""The study of the pull-off with and without coupling: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.coupled_pull_off.measure import beyond_pairs, change
from studies.coupled_pull_off.surfaces import JUMP_ON_RADIUS, PULL_OFF_FORCE, PULL_OFF_LENGTH, WORK
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = {0.3: "#1b6ca8", 1.0: "#c8553d", 3.0: "#3d8c5a"}


def draw(result: xr.Dataset) -> "Figure":
    """Draw the change of the pull-off over distance and number of asperities, and the largest avalanches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.5, 4.3), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    pull_off = 100.0 * change(result, "pull_off_force")
    size = result["avalanche"].sel(model="coupled")
    dense = beyond_pairs(result).to_numpy()
    at_usual_distance, at_usual_number = _series(result)
    _points(left, result["distance"], pull_off, dense, at_usual_number)
    _points(middle, result["asperities"], pull_off, dense, at_usual_distance)
    _points(right, result["asperities"], size, dense, at_usual_distance)
    ylabel = "change of the pull-off force by coupling [%]"
    left.set(xlabel="mean distance over jump-on radius", ylabel=ylabel)
    left.set_title(f"{_usual(result, at_usual_number, 'asperities')} asperities")
    distance = _usual(result, at_usual_distance, "distance")
    middle.set(xlabel="asperities", ylabel=ylabel, title=f"distance {distance} jump-on radii")
    right.set(xlabel="asperities", ylabel="contacts in the largest avalanche")
    right.set_title(f"distance {distance} jump-on radii")
    for panel in (left, middle):
        panel.axhline(0.0, color="0.6", lw=0.8)
    for panel, ticks in ((left, result["distance"]), (middle, result["asperities"]), (right, result["asperities"])):
        shown = at_usual_number if panel is left else at_usual_distance
        values = np.unique(ticks.to_numpy()[shown])
        panel.set_xscale("log")
        panel.set_xticks(values, [f"{value:g}" for value in values])
        panel.minorticks_off()
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    if dense[at_usual_number].any():
        left.plot([], [], "o", color="0.4", mfc="white", label="too dense for pairs")
    left.legend(fontsize=8, title="height spread over pull-off length", title_fontsize=8)
    return figure


def _series(result: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return which surfaces have the usual distance with several numbers of asperities, and which the usual number."""
    spread, distance, asperities = (result[name].to_numpy() for name in ("spread", "distance", "asperities"))
    usual_number = np.bincount(asperities.astype(int)).argmax()
    odd = asperities != usual_number
    return np.isin(spread, spread[odd]) & (distance == distance[odd][0]), ~odd


def _usual(result: xr.Dataset, among: np.ndarray, name: str) -> str:
    return f"{float(result[name].to_numpy()[among][0]):g}"


def _points(panel: "Axes", x: xr.DataArray, values: xr.DataArray, dense: np.ndarray, among: np.ndarray) -> None:
    """Draw mean and standard deviation over the realisations, a colour for each height spread."""
    spreads = np.unique(x["spread"].to_numpy()[among])
    for number, spread in enumerate(spreads.tolist()):
        own = np.flatnonzero(among & (x["spread"].to_numpy() == spread))
        own = own[np.argsort(x.to_numpy()[own])]
        beside = 1.025 ** (number - 0.5 * (spreads.size - 1))  # that bars do not cover each other
        at, mean = beside * x.to_numpy()[own], values.mean("realization").to_numpy()[own]
        scatter, colour = values.std("realization", ddof=1).to_numpy()[own], _COLOURS[spread]
        panel.errorbar(at, mean, scatter, color=colour, lw=1.2, capsize=2.5, label=f"{spread:g}")
        for open_ones, fill in ((False, colour), (True, "white")):
            few = dense[own] == open_ones
            panel.plot(at[few], mean[few], "o", color=colour, mfc=fill, ms=5.5, zorder=3)


def report(result: xr.Dataset) -> str:
    """Return a table of all surfaces, and how it was measured."""
    alone = result.sel(model="independent")
    coupled = result.sel(model="coupled")
    pull_off, lost = change(result, "pull_off_force"), change(result, "dissipated_energy")
    area = JUMP_ON_RADIUS**2
    dense = beyond_pairs(result)
    rows = []
    for i in range(result.sizes["surface"]):
        one, with_coupling = alone.isel(surface=i), coupled.isel(surface=i)
        count = float(one["asperities"])
        rows.append([
            f"{float(one['spread']):g}", f"{count:g}", f"{float(one['distance']):g}{' *' if dense[i] else ''}",
            f"{-float(one['pull_off_force'].mean()) / count / PULL_OFF_FORCE:.3f}",
            f"{-float(with_coupling['pull_off_force'].mean()) / count / PULL_OFF_FORCE:.3f}",
            _percent(pull_off[i]),
            f"{float(one['dissipated_energy'].mean()) / count / (WORK * area):.3f}",
            _percent(lost[i]),
            f"{float(one['contacts'].mean()):.1f}, {float(with_coupling['contacts'].mean()):.1f}",
            f"{float(with_coupling['avalanche'].mean()):.1f} ({float(with_coupling['avalanche'].mean()) / count:.1%})",
            f"{float(with_coupling['contact_fraction'].mean()):.1%}",
        ])  # fmt: skip
    length, radius = (f"{1e6 * each:.3g} µm" for each in (PULL_OFF_LENGTH, JUMP_ON_RADIUS))
    head = [
        "spread", "asperities", "distance", "pull-off", "coupled", "change", "dissipated", "change",
        "contacts, coupled", "largest avalanche", "contact fraction",
    ]  # fmt: skip
    return f"""The flat goes down to the same separation with both models, 1.5 pull-off lengths of {length} below
the mean height, and up until all contacts have parted. Separations count from the deformed mean plane. Height spreads
are in pull-off lengths, distances in jump-on radii of {radius}. Forces are per asperity over 1.5 pi w R of one
alone, energies of the cycle per asperity over w times the square of the jump-on radius. Changes are between the
models on the same surface, mean ± standard deviation over {result.sizes["realization"]} realisations. Contacts
and contact fraction are those at closest approach, the largest avalanche is of making or of parting, and *
stands where steps are marked: too dense for a coupling in pairs.

{table(head, rows)}

With twice as many steps the pull-off force changes by {float(result["refinement"]):.1g}.
"""


def _percent(values: xr.DataArray) -> str:
    return f"{100.0 * float(values.mean()):+.2f} ± {100.0 * float(values.std(ddof=1)):.2f} %"
