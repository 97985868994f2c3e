"""Conductance radii of asperities and of boundary elements, at given separation and under given load.

Surfaces are asperities on a plane, and maps with their hills and summits.
"""

import contextlib
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.comparison import INTERACTIONS, in_cases, law_of, median_and_largest, panels
from studies.hills.maps import SIDE, MapCase, hills_of, square
from studies.study import Figure, Study, in_two_processes, table, without_limits
from studies.versus_bem.ensembles import SIZE, Case

_MAP_POINTS = 16  # points of a map a shortest wave
FRACTIONS = np.array([0.001, 0.003, 0.01, 0.03, 0.06, 0.1])
"""Contact fractions by boundary elements, about."""
_SEARCHED, _COARSER = 16, 4  # separations at which these are looked for, on a grid so much coarser
_DIFFERENCE = 0.02  # change of the separation, over the depth of the flat below the highest summit
_LAW = ("conductance_radius", "contact_fraction", "conductance_error", "overlap_fraction")
_ELEMENTS = {
    "conductance_bem": ("conductance radius over the side, by boundary elements", "1"),
    "conductance_coarse": ("conductance radius with half as many points a side", "1"),
    "contact_fraction_bem": ("contact fraction by boundary elements", "1"),
}
_MODELS = {
    "conductance": ("conductance radius over the side, at the separation", "1"),
    "contact_fraction": ("summed contact area over nominal area there", "1"),
    "stated": ("stated error of the conductance there", "1"),
    "overlap": ("share of contacts that overlap; in pairs of the force", "1"),
    "conductance_under_load": ("conductance radius over the side, under the load of the boundary elements", "1"),
    "stated_under_load": ("stated error of the conductance there", "1"),
}
GROUPS = ("random", "separated", "hills", "summits")
_COLOURS = {"independent": "0.6", "mean field": "#8a5fb0", "order 1": "#1b6ca8", "order 2": "#c8553d"}
_GRID, _UNKNOWN = 0.5, 5e-3
"""Error of boundary elements over what every other point of their grid changes, of the first to the second order; at
least that of a stiffness by differences, as cells touch one by one.
"""


class Surface(NamedTuple):
    """A surface and what stands for it."""

    group: str
    """"random", "separated", "hills" or "summits"."""
    ensemble: xr.Dataset
    height: Floats
    """[m], on the grid of boundary elements."""
    side: float
    """[m]"""

    @property
    def models(self) -> list[str]:
        """Names of the interactions of the asperities; hills need pairs."""
        return [name for name in INTERACTIONS if self.group != "hills" or name.startswith("order")]


def of_asperities(case: Case) -> list[Surface]:
    """Return asperities on a plane."""
    ensemble, fine, _ = case.build()
    return [Surface("random" if case.placement == "random" else "separated", ensemble, fine, SIZE)]


def of_map(case: MapCase) -> list[Surface]:
    """Return the hills of a map, and its summits."""
    height = case.height(_MAP_POINTS)
    surface = square(height)
    found = {"hills": hills_of(surface), "summits": find_summits(surface)}
    return [Surface(name, each.labelled().to_xarray(), height, SIDE) for name, each in found.items()]


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


def surfaces(case: Case | MapCase) -> list[Surface]:
    """Return the surfaces of a case."""
    return of_asperities(case) if isinstance(case, Case) else of_map(case)


def unit_height(surface: Surface) -> Floats:
    """Return the heights on the grid over the side."""
    return np.asarray(surface.height / surface.side)


class Elements(NamedTuple):
    """Boundary elements at one separation; E* and the side are 1."""

    force: float
    conductance: float
    """-dF/dh over 2."""
    contact_fraction: float


def press(elements: BoundaryElements, separation: float) -> Elements:
    """Return the solution at a separation; the stiffness by the central difference of the fourth order."""
    step = _DIFFERENCE * (float(elements.height.max()) - separation)
    force = {k: elements.press(separation - k * step) for k in (-2, -1, 1, 2, 0)}
    stiffness = (8.0 * (force[1] - force[-1]) - (force[2] - force[-2])) / (12.0 * step)
    return Elements(force[0], 0.5 * stiffness, elements.patches().area)


def separations(height: Floats) -> Floats:
    """Return where a surface reaches the contact fractions, by boundary elements on a coarser grid."""
    coarse = BoundaryElements(height[::_COARSER, ::_COARSER], np.ones(2))
    top, mean = float(coarse.height.max()), float(coarse.height.mean())
    tried = top - (top - mean) * np.linspace(0.03, 0.97, _SEARCHED) ** 1.5
    area = []
    for h in tried.tolist():
        area.append(coarse.patches().area if np.isfinite(coarse.press(h)) else np.nan)
    known = np.array(area) > 0.0
    found = np.interp(np.log(FRACTIONS), np.log(np.array(area)[known]), tried[known], right=np.nan)
    return np.asarray(found)


def numbers_of(surface: Surface, interaction: Any, control: str, values: Floats) -> dict[str, Floats]:
    """Return the law of the asperities over the side at given separations or forces; NaN where they have none."""
    found = {name: np.full(FRACTIONS.size, np.nan) for name in _LAW}
    scale = {"separation": surface.side, "force": surface.side**2}[control]
    for i in np.flatnonzero(np.isfinite(values)):
        given: dict[str, Any] = {control: [float(values[i]) * scale], "interaction": interaction}
        with contextlib.suppress(rm.RoughmdrError):
            law = law_of(surface.ensemble, effective_modulus=1.0, variables=("force", *_LAW[:2]), **given)
            for name in _LAW:
                found[name][i] = float(law[name].item())
    return found | {"conductance_radius": found["conductance_radius"] / surface.side}


def compare(case: Case | MapCase) -> list[dict[str, Any]]:
    """Return the numbers of the surfaces of a case; hills and summits are of one map."""
    with without_limits():
        found = surfaces(case)
    height = unit_height(found[0])
    along = separations(height)
    grids = [BoundaryElements(each, np.ones(2)) for each in (height, height[::2, ::2])]
    fine, coarse = np.array([[press(grid, h) for h in along.tolist()] for grid in grids])
    elements = {"conductance_bem": fine[:, 1], "conductance_coarse": coarse[:, 1], "contact_fraction_bem": fine[:, 2]}
    return [{"group": each.group, **elements, **_by_models(each, along, fine[:, 0])} for each in found]


def _by_models(surface: Surface, along: Floats, force: Floats) -> dict[str, list[Floats]]:
    """Return the numbers of ``_MODELS`` by each model; NaN of those that are not asked for."""
    nothing = dict.fromkeys(_LAW, np.full(FRACTIONS.size, np.nan))
    laws: dict[str, list[Floats]] = {name: [] for name in _MODELS}
    for name, interaction in INTERACTIONS.items():
        at, under = (
            numbers_of(surface, interaction, control, values) if name in surface.models else nothing
            for control, values in (("separation", along), ("force", force))
        )
        numbers = (*(at[key] for key in _LAW), under["conductance_radius"], under["conductance_error"])
        for key, values in zip(_MODELS, numbers, strict=True):
            laws[key].append(values)
    return laws


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


def bounded(result: xr.Dataset, under_load: bool = False) -> xr.DataArray:
    """Return whether the stated error holds, to the error of the grid, over cases, models and steps; NaN of none."""
    suffix = "_under_load" if under_load else ""
    error, stated = abs(errors(result, f"conductance{suffix}")), result[f"stated{suffix}"]
    return (error <= stated + grid_errors(result)).where(np.isfinite(error) & np.isfinite(stated))


def draw(result: xr.Dataset) -> Figure:
    """Draw the error at given separation and under given load over the contact fraction."""
    figure, (left, right) = panels(14, 4.8, 2)
    marks = dict(zip(GROUPS, "os^x", strict=True))
    for panel, name in ((left, "conductance"), (right, "conductance_under_load")):
        title = "At given separation" if panel is left else "Under given load"
        error = abs(errors(result, name))
        for model, colour in _COLOURS.items():
            for group, mark in marks.items():
                own = result.isel(case=np.flatnonzero(result["group"].to_numpy() == group))
                each = error.isel(case=np.flatnonzero(result["group"].to_numpy() == group)).sel(model=model)
                label = f"{model}, {group}" if name == "conductance" else None
                panel.loglog(own["contact_fraction_bem"].to_numpy().ravel(), each.to_numpy().ravel(), mark,
                             color=colour, ms=4, label=label)  # fmt: skip
        panel.set(
            xlabel="contact fraction", ylabel="error of the conductance (relative)", title=title, ylim=(1e-4, 1.0)
        )
    figure.legend(loc="outside right center", fontsize=8)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the errors by group and model, and how often the stated error holds."""
    rows, held = [], []
    groups = result["group"].to_numpy()
    for group in GROUPS:
        own = result.isel(case=np.flatnonzero(groups == group))
        if not own.sizes["case"]:
            continue
        for model in own["model"].to_numpy():
            one = own.sel(model=model)
            if not np.isfinite(one["conductance"]).any():
                continue
            for name, where in (("conductance", "separation"), ("conductance_under_load", "load")):
                cells = [median_and_largest(errors(one, name).isel(step=i).to_numpy()) for i in range(FRACTIONS.size)]
                rows.append([group, str(model), where, *cells])
            shares = [float(bounded(own, under_load).sel(model=model).mean()) for under_load in (False, True)]
            held.append([group, str(model), *(f"{100.0 * share:.0f} %" for share in shares)])
    head = ["surfaces", "model", "at given", *(f"{100.0 * each:g} %" for each in FRACTIONS)]
    grid = median_and_largest(grid_errors(result).to_numpy())
    return f"""Errors of the conductance by contact fraction, median of the magnitude (largest):

{table(head, rows)}

The stated error of the conductance holds, with that of the grid:

{table(["surfaces", "model", "at given separation", "at given load"], held)}

The grids of boundary elements are right to about {grid}.
"""


STUDY = Study(
    "conductance", "Conductance against boundary elements", measure, draw, report,
    f"{len(QUICK)} cases, mostly smaller ones on coarser grids, in place of {len(CASES)}",
)  # fmt: skip
