"""The cycles of all surfaces with both models, and how far the pull-off depends on the number of steps."""

import numpy as np
import xarray as xr

from studies.coupled_pull_off.surfaces import MODELS, Cycle, Surface, cycle
from studies.study import named

STEPS = 30
USUAL = {False: (100, 10.0), True: (36, 10.0)}
"""Number of asperities where the distance varies, and distance where the number does."""
SPREADS = {False: (0.3, 1.0, 3.0), True: (0.3, 1.0)}
DISTANCES = {False: (5.0, 7.0, 10.0, 14.0, 20.0), True: (7.0, 20.0)}
COUNTS = {False: (25, 50, 200, 400), True: (16,)}
_COUNTED_SPREADS = (0.3, 1.0)
REALIZATIONS = {False: 3, True: 2}
UNITS = {"pull_off_force": "N", "dissipated_energy": "J"}


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
    asked = surfaces(quick)
    found = np.array([
        [[cycle(ensemble, interaction, STEPS) for ensemble in realizations] for interaction in MODELS.values()]
        for realizations in ([surface.generate(r) for r in range(REALIZATIONS[quick])] for surface in asked)
    ])  # fmt: skip
    over = ("surface", "model", "realization")
    spread, asperities, distance = (list(each) for each in zip(*asked, strict=True))
    result = xr.Dataset(
        {
            name: (over, found[..., i], named(name.replace("_", " "), UNITS.get(name, "1")))
            for i, name in enumerate(Cycle._fields)
        },
        {
            "model": list(MODELS),
            "spread": ("surface", spread, named("standard deviation of the heights over the pull-off length")),
            "asperities": ("surface", asperities, named("number of asperities")),
            "distance": ("surface", distance, named("mean distance over the jump-on radius")),
        },
    )
    result["refinement"] = ((), _refinement(quick), named("change of the pull-off force with twice as many steps"))
    return result


def _refinement(quick: bool) -> float:
    """Return the largest relative change of the pull-off force with twice as many steps, over spreads and models."""
    count, distance = USUAL[quick]
    changes = []
    for spread in _COUNTED_SPREADS:
        ensemble = Surface(spread, count, distance).generate(0)
        for interaction in MODELS.values():
            coarse, fine = (cycle(ensemble, interaction, steps).pull_off_force for steps in (STEPS, 2 * STEPS))
            changes.append(abs(coarse / fine - 1.0))
    return max(changes)


def change(result: xr.Dataset, name: str) -> xr.DataArray:
    """Return by how much a number is larger in magnitude with coupling, relative, for each surface and realisation."""
    return result[name].sel(model="coupled") / result[name].sel(model="independent") - 1.0


def beyond_pairs(result: xr.Dataset) -> xr.DataArray:
    """Return for which surfaces a coupling in pairs does not hold along the whole path."""
    return (result["marked"].sel(model="coupled") > 0).any("realization")
