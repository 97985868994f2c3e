"""Sticky random surfaces that are loaded and unloaded, with asperities independent or coupled in pairs."""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from studies.comparison import PAIRS, each_of, law_of, of_rows, panels
from studies.study import Axes, Figure, Study, table

MODULUS = 2e6  # [Pa]
WORK = 0.05  # [J/m2]
RADIUS = 50e-6  # [m]
JUMP_ON_RADIUS = (2.0 * math.pi * WORK * RADIUS**2 / MODULUS) ** (1.0 / 3.0)  # [m], of a contact alone
PULL_OFF_LENGTH = 0.75 * 4.0 ** (-1.0 / 3.0) * JUMP_ON_RADIUS**2 / RADIUS  # [m], how far a contact alone is stretched
PULL_OFF_FORCE = 1.5 * math.pi * WORK * RADIUS  # [N], of a contact alone
_DEPTH = 1.5  # depth below the mean height at closest approach, in pull-off lengths
_CLEAR = 2.0  # height above the highest summit at both ends, in pull-off lengths
_LEAST_DISTANCE = 0.7  # least distance over the mean distance
STEPS = 30
USUAL = {False: (100, 10.0), True: (36, 10.0)}
"""Number of asperities where the distance varies, and distance where the number does."""
SPREADS = {False: (0.3, 1.0, 3.0), True: (0.3, 1.0)}
DISTANCES = {False: (5.0, 7.0, 10.0, 14.0, 20.0), True: (7.0, 20.0)}
COUNTS = {False: (25, 50, 200, 400), True: (16,)}
_COUNTED_SPREADS = (0.3, 1.0)
REALIZATIONS = {False: 3, True: 2}
_CYCLE = {
    "pull_off_force": ("pull-off force, below 0, located between the steps", "N"),
    "pull_off_contacts": ("contacts at pull-off", "1"),
    "contacts": ("contacts at closest approach", "1"),
    "dissipated_energy": ("energy lost in the cycle", "J"),
    "avalanche": ("contacts in the largest avalanche, 1 where all are independent", "1"),
    "marked": ("steps at which contacts are too near each other for a coupling in pairs", "1"),
}
_COLOURS = {0.3: "#1b6ca8", 1.0: "#c8553d", 3.0: "#3d8c5a"}
MODELS: dict[str, Any] = {"independent": None, "coupled": PAIRS[2]}


class Surface(NamedTuple):
    """Equal paraboloids of normal heights that keep a distance."""

    spread: float  # standard deviation of the heights over the pull-off length
    asperities: int
    distance: float  # the side of the area for each asperity over the jump-on radius

    def generate(self, realization: int) -> xr.Dataset:
        """Return a realisation."""
        spacing = self.distance * JUMP_ON_RADIUS
        section = {
            "source": "random", "shape": "paraboloid", "count": self.asperities, "radius": RADIUS,
            "patch": math.sqrt(self.asperities) * spacing,
            "placement": "hard_core", "min_distance": _LEAST_DISTANCE * spacing,
            "height": {"distribution": "normal", "std": self.spread * PULL_OFF_LENGTH},
        }  # fmt: skip
        return rm.generate(section, seed=2026, realization=realization)


def cycle(ensemble: xr.Dataset, interaction: Any, steps: int) -> dict[str, float]:
    """Return ``_CYCLE`` of loading in ``steps`` and of unloading in as many, until all contacts have parted."""
    top = float(ensemble["height"].max()) + _CLEAR * PULL_OFF_LENGTH
    law = along(ensemble, np.linspace(top, -_DEPTH * PULL_OFF_LENGTH, steps), interaction)
    closest, marked = law.isel(step=steps - 1), law.get("marked_steps", 0.0)
    numbers = [law["pull_off_force"], law["pull_off_contacts"], closest["contact_count"], law["dissipated_energy"][-1],
               law.get("avalanche_size_max", 1.0), marked]  # fmt: skip
    return dict(zip(_CYCLE, map(float, numbers), strict=True))


def along(ensemble: xr.Dataset, separation: np.ndarray, interaction: Any) -> xr.Dataset:
    """Return the law of falling separations [m], followed by the same that rise."""
    variables = ["force", "contact_count", "energy", "dissipated_energy"]
    sticky = {"effective_modulus": MODULUS, "work": WORK, "adhesion": "jkr", "interaction": interaction}
    return law_of(ensemble, separation=separation, unload=True, variables=variables, **sticky)


def surfaces(quick: bool) -> list[Surface]:
    """Return all surfaces."""
    count, distance = USUAL[quick]
    varied = [Surface(spread, count, each) for spread in SPREADS[quick] for each in DISTANCES[quick]]
    return varied + [
        Surface(spread, each, distance)
        for spread in _COUNTED_SPREADS
        for each in COUNTS[quick] + (() if distance in DISTANCES[quick] else (count,))
    ]


def measure(quick: bool) -> xr.Dataset:
    """Return the numbers of the cycles of all surfaces, with each model and for each realisation."""
    rows = []
    for surface in surfaces(quick):
        drawn = [surface.generate(r) for r in range(REALIZATIONS[quick])]
        cycles = [[cycle(each, interaction, STEPS) for each in drawn] for interaction in MODELS.values()]
        rows.append(surface._asdict() | {name: [[each[name] for each in row] for row in cycles] for name in _CYCLE})
    usual = dict(zip(("usual_asperities", "usual_distance"), USUAL[quick], strict=True))
    result = of_rows(_CYCLE, rows, "surface", "model", "realization")
    return result.assign_coords(model=list(MODELS)).assign_attrs(usual)


def change(result: xr.Dataset, name: str) -> xr.DataArray:
    """Return by how much a number is larger in magnitude with coupling, relative, for each surface and realisation."""
    return result[name].sel(model="coupled") / result[name].sel(model="independent") - 1.0


def beyond_pairs(result: xr.Dataset) -> xr.DataArray:
    """Return for which surfaces a coupling in pairs does not hold along the whole path."""
    return (result["marked"].sel(model="coupled") > 0).any("realization")


def draw(result: xr.Dataset) -> Figure:
    """Draw the change of the pull-off over distance and number of asperities, and the largest avalanches."""
    figure, row = panels(12.5, 4.3, 3)
    count, distance = result.attrs["usual_asperities"], result.attrs["usual_distance"]
    at_usual_number = result["asperities"] == count
    at_usual_distance = (result["distance"] == distance) & result["spread"].isin(_COUNTED_SPREADS)
    result = result.assign_coords(dense=("surface", beyond_pairs(result).to_numpy()))
    force, avalanche = 100.0 * change(result, "pull_off_force"), result["avalanche"].sel(model="coupled")
    ylabel, beside = "change of the pull-off force by coupling [%]", f"distance {distance:g} jump-on radii"
    _points(row[0], force, "distance", at_usual_number)
    row[0].set(xlabel="mean distance over jump-on radius", ylabel=ylabel, title=f"{count:g} asperities")
    _points(row[1], force, "asperities", at_usual_distance)
    row[1].set(xlabel="asperities", ylabel=ylabel, title=beside)
    _points(row[2], avalanche, "asperities", at_usual_distance)
    row[2].set(xlabel="asperities", ylabel="contacts in the largest avalanche", title=beside)
    for panel in row[:2]:
        panel.axhline(0.0, color="0.6", lw=0.8)
    row[0].legend(fontsize=8, title="height spread over pull-off length", title_fontsize=8)
    return figure


def _points(panel: Axes, values: xr.DataArray, over: str, among: xr.DataArray) -> None:
    """Draw mean and standard deviation over the realisations, a colour for each height spread; hollow where dense."""
    spreads = np.unique(values["spread"].to_numpy()[among])
    for number, spread in enumerate(spreads.tolist()):
        own = values.isel(surface=np.flatnonzero(among & (values["spread"] == spread))).sortby(over)
        at = 1.025 ** (number - 0.5 * (spreads.size - 1)) * own[over]  # that bars do not cover each other
        mean, colour = own.mean("realization"), _COLOURS[spread]
        style: dict[str, Any] = {"fmt": "o-", "color": colour, "ms": 5.5, "lw": 1.2, "capsize": 2.5}
        panel.errorbar(at, mean, own.std("realization", ddof=1), label=f"{spread:g}", **style)
        hollow = own["dense"].to_numpy()
        panel.plot(at[hollow], mean[hollow], "o", color=colour, mfc="white", ms=5.5, zorder=3)
    ticks = np.unique(values[over].to_numpy()[among])
    panel.set_xscale("log")
    panel.set_xticks(ticks, [f"{value:g}" for value in ticks])
    panel.minorticks_off()


def report(result: xr.Dataset) -> str:
    """Return a table of all surfaces, and how it was measured."""
    force, lost, dense = change(result, "pull_off_force"), change(result, "dissipated_energy"), beyond_pairs(result)
    size, rows = result["avalanche"].sel(model="coupled").mean("realization"), []
    for i, own in enumerate(each_of(result, "surface")):
        distance = f"{float(own['distance']):g}{' *' if dense[i] else ''}"
        labels = [f"{float(own['spread']):g}", f"{float(own['asperities']):g}", distance]
        rows.append([*labels, _percent(force[i]), _percent(lost[i]), f"{float(size[i]):.1f}"])
    length, radius = (f"{1e6 * each:.3g} µm" for each in (PULL_OFF_LENGTH, JUMP_ON_RADIUS))
    head = ["spread", "asperities", "distance", "pull-off force", "dissipated energy", "largest avalanche"]
    return f"""The flat goes down to the same separation with both models, 1.5 pull-off lengths of {length} below
the mean height, and up until all contacts have parted. Separations count from the deformed mean plane. Height spreads
are in pull-off lengths, distances in jump-on radii of {radius}. Changes are between the models on the same surface,
mean ± standard deviation over {result.sizes["realization"]} realisations. The largest avalanche is of making or of
parting, and * stands where steps are marked: too dense for a coupling in pairs.

{table(head, rows)}
"""


def _percent(values: xr.DataArray) -> str:
    return f"{100.0 * float(values.mean()):+.2f} ± {100.0 * float(values.std(ddof=1)):.2f} %"


STUDY = Study(
    "coupled_pull_off", "Pull-off with and without coupling", measure, draw, report,
    f"{USUAL[True][0]} in place of {USUAL[False][0]} asperities, "
    f"at most {USUAL[True][0]} in place of {max(COUNTS[False])}; "
    f"{len(DISTANCES[True])} of {len(DISTANCES[False])} distances, "
    f"{len(SPREADS[True])} of {len(SPREADS[False])} spreads of heights, "
    f"{REALIZATIONS[True]} of {REALIZATIONS[False]} realisations",
)  # fmt: skip
