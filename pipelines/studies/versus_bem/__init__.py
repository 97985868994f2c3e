"""Asperities against boundary elements at the same separations: forces and areas.

Asperities are independent, displaced by the mean pressure, or coupled in pairs to first and second order.
"""

import itertools
import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from oracles.boundary_elements import HeightMap, by_perimeter, of_half_ellipsoids

import roughmdr as rm
from roughmdr.model_error.interaction import ASPERITIES, SUMMITS, interaction_error
from roughmdr.numerics.arguments import Floats
from studies.comparison import (
    HELD,
    INTERACTIONS,
    each_of,
    held,
    in_cases,
    law_or_nan,
    median_and_largest,
)
from studies.study import Study, in_two_processes, table, without_limits
from studies.versus_bem.ensembles import (
    CASES,
    FINE,
    MODULUS,
    QUICK,
    SIZE,
    Case,
    MapCase,
    contact_radii,
    distances,
    separations,
)

FRACTIONS = np.array([0.001, 0.003, 0.01, 0.03, 0.05, 0.1, 0.2, 0.3])
_FINE_FRACTION = 0.1  # the largest contact fraction on the finest grids
GROUPS = ("few contacts", "random", "separated", "square", "nayak", "map", "crowd")
FEW_CONTACTS = 4.0
"""Up to so many, contacts of the patch and of its periodic images are a lattice, wherever they are placed."""
_MIN_POINTS = 2.5  # least points of the grid a contact radius: with fewer, elements are off by a per cent and more
_FINE_SEED = 11  # and above, of the cases on the finest grids
_BINS = ((0.0, 0.004), (0.004, 0.03), (0.03, 0.15), (0.15, 1.0))
_FINER_BINS = tuple(itertools.pairwise((0.0, 0.004, 0.03, 0.06, 0.15, 1.0)))
_LAW = {
    "force": ("force, by each model", "N"),
    "contact_fraction": ("summed contact area over the nominal area, by each model", "1"),
    "contact_count": ("contacts, by each model", "1"),
    "model_error_curve": ("model error that each model states", "1"),
}
_ELEMENTS = {
    "force_bem": ("force of boundary elements, infinite in full contact", "N"),
    "contact_fraction_bem": ("contact fraction of boundary elements", "1"),
    "force_coarse": ("force of boundary elements with half as many points a side", "N"),
    "radius_points": ("root mean square of the contact radii over the spacing of the grid", "1"),
}


def press(surface: HeightMap, separation: float, separated_paraboloids: bool) -> tuple[float, float]:
    """Return force and contact fraction of boundary elements at a separation [m].

    Areas of separated paraboloids are those by their pressure. NaN where elements do not converge, as next to full
    contact.
    """
    try:
        force = surface.press(separation).force
    except rm.OutOfRange:
        return math.nan, math.nan
    area = of_half_ellipsoids if separated_paraboloids else by_perimeter
    return force, area(surface.pressure) if math.isfinite(force) else 1.0


def law_by(ensemble: xr.Dataset, separation: Floats, interaction: Any) -> list[Floats]:
    """Return ``_LAW`` at separations [m], in falling order; NaN from where it has more contact than the patch."""
    for steps in range(separation.size, 0, -1):
        found = law_or_nan(ensemble, separation[:steps], *_LAW, effective_modulus=MODULUS, interaction=interaction)
        if np.isfinite(found[0]).any():
            break
    return [np.pad(each, (0, separation.size - each.size), constant_values=np.nan) for each in found]


def touch(radius: Floats, distance: Floats) -> bool:
    """Return whether the circle of a contact meets another."""
    reach = radius[:, None] + radius[None, :]
    return bool(np.any(distance < np.where((radius[:, None] > 0.0) & (radius[None, :] > 0.0), reach, 0.0)))


def compare(case: Case | MapCase) -> dict[str, Any]:
    """Return ``_LAW`` by each model, and ``_ELEMENTS``, at each contact fraction that the ensemble reaches."""
    with without_limits():
        ensemble, *maps = case.build()
    along = separations(ensemble, FRACTIONS[FRACTIONS <= _FINE_FRACTION] if case.points >= FINE else FRACTIONS)
    along = along[np.isfinite(along)]
    laws = [law_by(ensemble, along, interaction) for interaction in INTERACTIONS.values()]
    fine, coarse = (HeightMap(height, SIZE, MODULUS) for height in maps)
    radii, distance = [contact_radii(ensemble, h) for h in along.tolist()], distances(ensemble)
    apart = [isinstance(case, Case) and "radius" in ensemble and not touch(each, distance) for each in radii]
    found = np.array([press(fine, *each) for each in zip(along.tolist(), apart, strict=True)]).T
    rough = [press(coarse, *each)[0] for each in zip(along.tolist(), apart, strict=True)]
    points = np.array([np.sqrt(np.mean(a[a > 0.0] ** 2)) for a in radii]) * case.points / SIZE
    numbers = zip(_ELEMENTS, (*found, rough, points), strict=True)
    return {**dict(zip(_LAW, zip(*laws, strict=True), strict=True)), **dict(numbers)}


def measure(quick: bool) -> xr.Dataset:
    """Compare all cases, or a few of them on coarse grids."""
    cases = QUICK if quick else CASES
    found = in_two_processes(compare, cases)
    return xr.Dataset(
        in_cases(_LAW, found, "case", "model", "step") | in_cases(_ELEMENTS, found, "case", "step"),
        {
            "model": list(INTERACTIONS),
            "placement": ("case", [case.placement if isinstance(case, Case) else "map" for case in cases]),
            "seed": ("case", [case.seed for case in cases]),
        },
    )


def estimates(contact_fraction: Floats, group: NDArray[np.str_]) -> Floats:
    """Return the estimate of the error: of the summits of a map, and of other asperities."""
    of_asperities, of_summits = (interaction_error(contact_fraction, kind) for kind in (ASPERITIES, SUMMITS))
    return np.where(group == "map", of_summits, of_asperities)


def errors(result: xr.Dataset, model: str = "independent", full_contact: bool = True) -> Floats:
    """Return by what share a force is too low [case, step], 1 in full contact or, not ``full_contact``, NaN there.

    NaN where the grid does not resolve the contacts, or where boundary elements have not converged.
    """
    return _too_low(result, result["force"].sel(model=model), full_contact)


def grid_errors(result: xr.Dataset) -> Floats:
    """Return how far forces on half as many points are off; NaN where the error is not known, or in full contact."""
    return np.abs(_too_low(result, result["force_coarse"]))


def _too_low(result: xr.Dataset, force: xr.DataArray, full_contact: bool = True) -> Floats:
    true = result["force_bem"]
    known = (result["radius_points"] >= _MIN_POINTS) & (true.notnull() if full_contact else np.isfinite(true))
    return np.asarray((1.0 - force / true).where(known))


def without_grid(fine: Any, coarse: Any) -> Any:
    """Return the limit of forces on a grid and on one of half as many points a side, by an error of order 2."""
    return fine + (fine - coarse) / 3.0


def groups(result: xr.Dataset) -> NDArray[np.str_]:
    """Return the group of each case and step."""
    separated = dict.fromkeys(("hexagonal", "hard_core 0.5", "hard_core 0.7"), "separated")
    placed = [separated.get(name, name.split()[0]) for name in result["placement"].to_numpy().tolist()]
    whole = np.broadcast_to(np.array(placed)[:, None], result["force_bem"].shape)
    few = result["contact_count"].sel(model="independent").to_numpy() <= FEW_CONTACTS
    return np.where(few & (whole != "map") & (whole != "crowd"), "few contacts", whole)


def report(result: xr.Dataset) -> str:
    """Return errors over sqrt(f), how the stated ones do, and errors by interaction and on the finest grids."""
    independent = result.sel(model="independent")
    fraction, error, group = independent["contact_fraction"].to_numpy(), errors(result), groups(result)
    stated = np.where(group == "crowd", independent["model_error_curve"], estimates(fraction, group))
    coefficients, estimated, by_model = [], [], []
    for name in GROUPS:
        own = np.isfinite(error) & (group == name)
        parts = [own & (fraction > low) & (fraction <= high) for low, high in _BINS]
        coefficients.append([name, *(_quantiles(error[part] / np.sqrt(fraction[part])) for part in parts)])
        if own.any():
            estimated.append([name, *held(np.abs(error[own]), stated[own])])
        for low, high in _FINER_BINS:
            part = (group == name) & (fraction > low) & (fraction <= high)
            if part.any():
                found = [median_and_largest(errors(result, model, False)[part]) for model in INTERACTIONS]
                by_model.append([name, f"{low:g} to {high:g}", *found])
    fine = result.isel(case=np.flatnonzero(result["seed"].to_numpy() >= _FINE_SEED))
    finest = [_fine(step) for step in each_of(fine, "step") if step["force_bem"].notnull().any()]
    return f"""e over sqrt(f), median (5 to 95 %), f the summed contact fraction of independent asperities:

{table(["placement", *(f"f from {low:g} to {high:g}" for low, high in _BINS)], coefficients)}

{table(["placement", *HELD], estimated)}

Forces of boundary elements on half as many points differ by {median_and_largest(grid_errors(result))}.

Errors of the force by interaction, median of the magnitude (largest):

{table(["placement", "f", *INTERACTIONS], by_model)}

Separated paraboloids of lognormal radii on the finest grid, largest errors of all seeds:

{table(["f", *INTERACTIONS, "of the grid", "area"], finest)}
"""


def _quantiles(ratio: Floats) -> str:
    return "{1:.2f} ({0:.2f} to {2:.2f})".format(*np.quantile(ratio, [0.05, 0.5, 0.95])) if ratio.size else ""


def _fine(step: xr.Dataset) -> list[str]:
    """Return a row of the largest errors at a step; force held against the limit of both grids."""
    exact = without_grid(step["force_bem"], step["force_coarse"])
    off = [abs(force / exact - 1.0) for force in (*step["force"].transpose("model", ...), step["force_bem"])]
    second = step.sel(model="order 2")
    area = abs(second["contact_fraction"] / step["contact_fraction_bem"] - 1.0)
    cells = (f"{100.0 * float(error.max()):.2g} %" for error in (*off, area))
    return [f"{float(second['contact_fraction'].median()):.2g}", *cells]


STUDY = Study(
    "versus_bem", "What independence costs: against boundary elements", measure, {}, report,
    f"{len(QUICK)} smaller cases in place of {len(CASES)}, on coarser grids",
)  # fmt: skip
