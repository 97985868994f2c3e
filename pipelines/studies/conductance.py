"""Conductance radii of asperities and of boundary elements, at given separation and under given load.

Surfaces are asperities on a plane, and maps with their hills and summits.
"""

import contextlib
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.numerics.arguments import Floats
from studies.at_pressure import surface_of
from studies.comparison import INTERACTIONS, cases_of, in_cases, median_and_largest, percent
from studies.hills.maps import MapCase
from studies.study import Study, in_two_processes, table, without_limits
from studies.versus_bem.ensembles import Case

FRACTIONS = np.array([0.001, 0.003, 0.01, 0.03, 0.06, 0.1])  # contact fractions by boundary elements, about
_SEARCHED = 16  # separations among which those of the contact fractions are looked for
_DIFFERENCE = 0.02  # change of the separation, over the depth of the flat below the highest summit
_ELEMENTS = {
    "conductance_bem": ("conductance radius over the side, by boundary elements", "1"),
    "conductance_coarse": ("conductance radius with half as many points a side", "1"),
    "contact_fraction_bem": ("contact fraction by boundary elements", "1"),
}
_MODELS = {
    "conductance": ("conductance radius over the side, at the separation", "1"),
    "stated": ("stated error of the conductance there", "1"),
    "conductance_under_load": ("conductance radius over the side, under the load of the boundary elements", "1"),
}
GROUPS = ("random", "separated", "hills", "summits")
_GRID, _UNKNOWN = 0.5, 5e-3
"""Error of boundary elements over what every other point of their grid changes, of the first to the second order; at
least that of a stiffness by differences, as cells touch one by one.
"""

CASES: list[Case | MapCase] = [
    *(Case(where, "paraboloid", 64, roughness, 512, seed)
      for seed, roughness in ((1, 0.05), (2, 0.2), (3, 1.0))
      for where in ("random", "hard_core 0.5", "hard_core 0.7")),
    *(Case(where, shape, 64, 0.2, 512, 4)
      for shape in ("lognormal", "quartic") for where in ("random", "hard_core 0.7")),
    Case("random", "paraboloid", 200, 0.2, 512, 5),
    *(MapCase(hurst, bandwidth, seed) for hurst in (0.3, 0.8) for bandwidth, seed in ((8, 11), (8, 12), (16, 11))),
]  # fmt: skip
QUICK: list[Case | MapCase] = [
    Case("random", "paraboloid", 25, 0.2, 128, 1),
    Case("hard_core 0.7", "paraboloid", 25, 0.05, 128, 1),
    MapCase(0.8, 8, 11),
]


def press(elements: BoundaryElements, separation: float) -> tuple[float, float, float]:
    """Return force, conductance radius -dF/dh / 2 by differences of the fourth order, and contact fraction; E* is 1."""
    step = _DIFFERENCE * (float(elements.height.max()) - separation)
    force = {k: elements.press(separation - k * step) for k in (-2, -1, 1, 2, 0)}
    stiffness = (8.0 * (force[1] - force[-1]) - (force[2] - force[-2])) / (12.0 * step)
    return force[0], 0.5 * stiffness, elements.patches().area


def law_at(ensemble: xr.Dataset, side: float, interaction: Any, control: str, values: Floats) -> Floats:
    """Return the conductance radius over the side and its stated error, at given separations or forces; NaN of none."""
    found, scale = np.full((2, values.size), np.nan), {"separation": side, "force": side**2}[control]
    asked: dict[str, Any] = {"interaction": interaction, "variables": ("force", "conductance_radius")}
    for i in np.flatnonzero(np.isfinite(values)):
        with contextlib.suppress(rm.RoughmdrError):
            law = rm.load_separation(ensemble, effective_modulus=1.0, **asked | {control: [float(values[i]) * scale]})
            found[:, i] = law["conductance_radius"].item() / side, law["conductance_error"].item()
    return found


@without_limits()
def compare(case: Case | MapCase) -> list[dict[str, Any]]:
    """Return the numbers of the asperities of a case; hills and summits are of one map."""
    surface = surface_of(case)
    along = surface.separations(FRACTIONS, _SEARCHED)
    grids = [surface.elements(coarser) for coarser in (1, 2)]
    fine, coarse = np.array([[press(grid, h) for h in along.tolist()] for grid in grids])
    elements = {"conductance_bem": fine[:, 1], "conductance_coarse": coarse[:, 1], "contact_fraction_bem": fine[:, 2]}
    rows = []
    for name, ensemble in surface.ensembles.items():
        laws = np.full((len(_MODELS), len(INTERACTIONS), FRACTIONS.size), np.nan)
        for number, (model, interaction) in enumerate(INTERACTIONS.items()):
            if name != "hills" or model.startswith("order"):  # hills need pairs
                laws[:2, number] = law_at(ensemble, surface.side, interaction, "separation", along)
                laws[2, number] = law_at(ensemble, surface.side, interaction, "force", fine[:, 0])[0]
        placed = name if isinstance(case, MapCase) else "random" if case.placement == "random" else "separated"
        rows.append({"group": placed, **elements, **dict(zip(_MODELS, laws, strict=True))})
    return rows


def measure(quick: bool) -> xr.Dataset:
    """Compare all surfaces, or a few of them on coarse grids."""
    found = [each for part in in_two_processes(compare, QUICK if quick else CASES) for each in part]
    numbers = in_cases(_ELEMENTS, found, "case", "step") | in_cases(_MODELS, found, "case", "model", "step")
    return xr.Dataset(numbers, {"model": list(INTERACTIONS), "group": ("case", [each["group"] for each in found])})


def errors(result: xr.Dataset, name: str = "conductance") -> xr.DataArray:
    """Return the relative error of a conductance, over cases, models and steps."""
    return result[name] / result["conductance_bem"] - 1.0


def grid_errors(result: xr.Dataset) -> xr.DataArray:
    """Return about the error of boundary elements, over cases and steps."""
    off = _GRID * abs(result["conductance_coarse"] / result["conductance_bem"] - 1.0)
    return off.where(~(off < _UNKNOWN), _UNKNOWN)


def bounded(result: xr.Dataset) -> xr.DataArray:
    """Return whether the stated error holds, to the error of the grid, over cases, models and steps; NaN of none."""
    error, stated = abs(errors(result)), result["stated"]
    return (error <= stated + grid_errors(result)).where(np.isfinite(error) & np.isfinite(stated))


def report(result: xr.Dataset) -> str:
    """Return the errors by group and model, and how often the stated error holds."""
    rows, held = [], []
    for group, model in product(GROUPS, INTERACTIONS):
        one = cases_of(result, group=group).sel(model=model)
        if not np.isfinite(one["conductance"]).any():
            continue
        for name, where in (("conductance", "separation"), ("conductance_under_load", "load")):
            rows.append([group, model, where, *map(median_and_largest, errors(one, name).to_numpy().T)])
        held.append([group, model, percent(float(bounded(one).mean()), 0)])
    head = ["surfaces", "model", "at given", *(f"{100.0 * each:g} %" for each in FRACTIONS)]
    grid = median_and_largest(grid_errors(result).to_numpy())
    return f"""Errors of the conductance by contact fraction, median of the magnitude (largest):

{table(head, rows)}

The stated error of the conductance holds, with that of the grid:

{table(["surfaces", "model", "at given separation"], held)}

The grids of boundary elements are right to about {grid}.
"""


STUDY = Study(
    "conductance", "Conductance against boundary elements", measure, {}, report,
    f"{len(QUICK)} cases, mostly smaller ones on coarser grids, in place of {len(CASES)}",
)  # fmt: skip
