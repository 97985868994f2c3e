"""The error that is stated of area, stiffness and gap at given pressure, put to the proof on surfaces drawn at random.

Asperities on a plane, adhesive ones, and periodic and cut Gaussian maps with their summits and hills, stand beside
boundary elements.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.comparison import HELD, INTERACTIONS, groups_of, held, law_of, of_rows, percent
from studies.hills.maps import SIDE, MapCase, hills_of, where_reached
from studies.study import Study, in_two_processes, table, without_limits
from studies.versus_adhesive_bem import FLATTER, PRESSED, STATED, Case as Adhering, by_elements, flat_law
from studies.versus_bem.ensembles import SIZE, Case, separations as of_asperities

SEED = 2027  # seed of the surfaces; those of seed 7 have set the constants
FRACTIONS = np.array([0.003, 0.006, 0.012, 0.025, 0.05, 0.1, 0.15])
"""Contact fractions at which surfaces are pressed, about."""
SURFACES = {False: 45, True: 3}  # number of surfaces in full and in reduced form
_LOADS = {"pressed": (0.25, np.inf), "no load": (-0.25, 0.25), "tension": (-np.inf, -0.25)}
"""Least and largest load over the largest tension."""
_POINTS = {False: 384, True: 96}
_CONTROLS = ("separation", "pressure", "contact_fraction")
QUANTITIES = ("pressure", "contact_fraction", "stiffness", "conductance_radius", "contact_radius_sum", "separation")
ASKED = [(quantity, control) for control in _CONTROLS for quantity in QUANTITIES if quantity != control]
_COARSER = 4  # points of the grid for one of that on which separations are looked for
_LEAST_POINTS = 3.0  # least points of the grid a mean contact radius
_STEPS = 30  # steps of the law from one solution of boundary elements to the next
_SHAPES = ("paraboloid", "paraboloid", "lognormal", "cone", "quartic")
_PLACEMENTS = ("random", "random", "hard_core 0.5", "hard_core 0.7", "hexagonal", "square")
WORDS = {
    "error": ("error of a quantity, of the separation over that of force over stiffness", "1"),
    "stated": ("error that is stated of it", "1"),
    "unknown": ("error of boundary elements", "1"),
}


class Surface(NamedTuple):
    """A surface, and the asperities that stand for it by their group."""

    ensembles: dict[str, xr.Dataset]
    height: Floats  # [side], on the grid of boundary elements
    side: float  # [m]
    periodic: bool

    def elements(self, coarser: int = 1) -> BoundaryElements:
        """Return boundary elements of unit side, on one of ``coarser`` points along a side."""
        return BoundaryElements(self.height[::coarser, ::coarser], np.ones(2), periodic=self.periodic)

    def separations(self, fractions: Floats, searched: int, left: float | None = None) -> Floats:
        """Return the separations [side] of contact fractions by coarse elements, of lower ones ``left``; NaN beyond."""
        coarse = self.elements(_COARSER)
        top, mean = float(coarse.height.max()), float(coarse.height.mean())
        tried = top - (top - mean) * np.linspace(0.03, 0.97, searched) ** 1.5
        return where_reached(coarse, tried, fractions, left=left, right=np.nan)


def surface_of(case: Case | MapCase, periodic: bool = True) -> Surface:
    """Return the surface of a case; not ``periodic``, 0.7 of the side is cut out of a map."""
    if isinstance(case, Case):
        ensemble, height, _ = case.build()
        return Surface({"asperities": ensemble}, height / SIZE, SIZE, True)
    height, side = case.height(16 if case.bandwidth <= 16 else 12), SIDE
    if not periodic:
        kept = int(0.7 * height.shape[0]) // 4 * 4
        height, side = height[:kept, :kept], SIDE * kept / height.shape[0]
    surface = HeightMap(height, side / height.shape[0], side / height.shape[1], periodic)
    found = {"summits": find_summits(surface), "hills": hills_of(surface)}
    return Surface({name: each.labelled().to_xarray() for name, each in found.items()}, height / side, side, periodic)


def draw_case(seed: int, number: int, points: int) -> tuple[Case | MapCase, bool]:
    """Return a surface at random, and whether it repeats: of three one is a map, of these every second one is cut."""
    chance = np.random.default_rng([seed, number])
    if number % 3 == 2:
        hurst, bandwidth = float(chance.choice([0.3, 0.5, 0.8])), int(chance.choice([8, 12, 16, 24]))
        return MapCase(hurst, bandwidth, int(chance.integers(1000))), bool(number % 2)
    placement, shape = str(chance.choice(_PLACEMENTS)), str(chance.choice(_SHAPES))
    count = 64 if placement == "hexagonal" else round(math.exp(chance.uniform(math.log(25), math.log(300))))
    if placement == "square":
        count = math.isqrt(count) ** 2
    roughness = math.exp(chance.uniform(math.log(0.03), 0.0))
    return Case(placement, shape, count, roughness, points, int(chance.integers(1000))), True


def separations_of(surface: Surface) -> Floats:
    """Return separations [m] at which the contact fractions of a surface are about ``FRACTIONS``."""
    if "asperities" in surface.ensembles:
        along = of_asperities(surface.ensembles["asperities"], FRACTIONS)
    else:
        along = surface.side * surface.separations(FRACTIONS, 24, np.nan)
    return along[np.isfinite(along)]


def truth_of(surface: Surface, separation: Floats) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return quantities by boundary elements for E* = 1 Pa, and their errors, where the grid resolves contacts."""
    grid, rows = surface.elements(), []
    for h in (separation / surface.side).tolist():
        force, patches = grid.press(h), grid.patches()
        rows.append((force, patches.area, grid.stiffness(h), patches.radius_sum, patches.contacts))
    force, area, stiffness, radius_sum, contacts = np.array(rows).T
    found = {
        "pressure": force, "contact_fraction": area, "stiffness": surface.side * stiffness,
        "conductance_radius": 0.5 * surface.side * stiffness, "contact_radius_sum": surface.side * radius_sum,
        "separation": separation,
    }  # fmt: skip
    points = np.sqrt(area / (math.pi * np.maximum(contacts, 1.0))) * surface.height.shape[0]
    resolved = (points >= _LEAST_POINTS) & (force > 0.0)
    truth = {name: values[resolved] for name, values in found.items()}
    return truth, unknown_errors(contacts[resolved], points[resolved])


def unknown_errors(contacts: Floats, points: Floats) -> dict[str, Floats]:
    """Return about the error of boundary elements, by the points of a contact radius, and as cells touch."""
    of_force, of_area = 2e-4 + 0.01 / points**2, 0.06 / points
    of_stiffness = 3.0 * of_force + 0.02 / np.sqrt(np.maximum(contacts, 1.0))
    return {
        "pressure": of_force, "separation": of_force, "contact_fraction": of_area, "contact_radius_sum": of_area,
        "stiffness": of_stiffness, "conductance_radius": of_stiffness,
    }  # fmt: skip


def path_of(separation: Floats) -> Floats:
    """Return a path from above the first of the separations to below the last, through all of them."""
    span = separation[0] - separation[-1]
    corners = [separation[0] + span, *separation, separation[-1] - 0.3 * span]
    number = np.arange(len(corners))
    return np.asarray(np.interp(np.linspace(0, number[-1], 1 + _STEPS * number[-1]), number, corners))


def law_to_the_end(ensemble: xr.Dataset, separation: Floats, interaction: Any) -> xr.Dataset | None:
    """Return the law along as much of a path as it has one; None where that is little."""
    while separation.size > 2 * _STEPS:
        try:
            return law_of(ensemble, separation=separation, effective_modulus=1.0, interaction=interaction,
                          variables=[name for name in QUANTITIES if name != "separation"])  # fmt: skip
        except rm.RoughmdrError:
            separation = separation[: int(0.93 * separation.size)]
    return None


def compare(task: tuple[int, int, int]) -> list[dict[str, Any]]:
    """Return the errors of all models of a surface, by seed, number and points: of each the row of ``WORDS``."""
    with without_limits():
        surface = surface_of(*draw_case(*task))
    separation, rows = separations_of(surface), []
    truth, unknown = truth_of(surface, separation)
    for group, ensemble in surface.ensembles.items():
        for model, interaction in INTERACTIONS.items():
            alone = interaction in (None, "mean_field")
            if (group == "hills" and model != "order 2") or (alone and not surface.periodic):
                continue
            asked = {**interaction, "boundary": "free"} if not surface.periodic else interaction
            if law := law_to_the_end(ensemble, path_of(separation), asked):
                cut = "" if surface.periodic else "cut "
                labels = {"group": f"{cut}{group}", "model": model, "surface": task[1]}
                rows.append(labels | row_of(law, truth, unknown, surface.side))
    return rows


@np.errstate(divide="ignore", invalid="ignore")  # at the turning point, and where none is in contact
def compare_adhering(case: Adhering) -> list[dict[str, Any]]:
    """Return the errors of adhesive asperities, where a load is first reached on loading and on unloading."""
    ensemble = case.generate()
    h = case.separations(ensemble)
    area, turn, steps = case.size**2, int(np.argmin(h)), np.arange(h.size)
    fine, coarse = (by_elements(case, ensemble, h, points) for points in (case.points, case.coarse))
    tension = -float(fine["force"][turn:].min())
    stiffness, other = (-np.gradient(each["force"], steps) / np.gradient(h, steps) for each in (fine, coarse))
    truth = {
        "pressure": fine["force"] / area / FLATTER, "contact_fraction": fine["closed"] / area, "stiffness": stiffness,
        "separation": h / FLATTER, "load": np.maximum(np.abs(fine["force"]), tension) / area / FLATTER,
    } | dict.fromkeys(("conductance_radius", "contact_radius_sum"), np.nan * h)  # fmt: skip
    by_grid = np.abs(coarse["force"] - fine["force"]) / np.maximum(np.abs(fine["force"]), tension)
    unknown = dict.fromkeys(truth, by_grid) | {"stiffness": np.abs(other / stiffness - 1.0)}
    unknown["contact_fraction"] = np.abs(coarse["closed"] / fine["closed"] - 1.0)
    steady = (fine["count"] > 0) & (np.roll(fine["count"], 1) == fine["count"]) & (steps != turn)
    steady &= (np.roll(fine["count"], -1) == fine["count"]) & (truth["contact_fraction"] < FRACTIONS[-1])
    rows = []
    for model, own in STATED.items():
        if case.asperities == 1 and "interaction" not in own:
            continue  # its images, which it does not feel, are no part of the comparison
        law = flat_law(case, ensemble, h, [name for name in QUANTITIES if name != "separation"], **own)
        pulled, off = law.roughmdr.pull_off(), np.full((3, len(ASKED), 1), np.nan)
        parts = pulled["force"] * FLATTER + tension, pulled["force_model_error"] * FLATTER, 0.0
        off[:, ASKED.index(("pressure", "separation")), 0] = np.array(parts) / tension
        labels = {"group": "adhesive asperities", "surface": -case.seed}
        rows.append(labels | {"model": f"{model}, pull-off"} | dict(zip(WORDS, off, strict=True)))
        for branch, sign, side in (("loading", 1.0, steps <= turn), ("unloading", -1.0, steps >= turn)):
            force = np.where(side, sign * fine["force"], 0.0 if sign > 0.0 else -np.inf)
            first = steady & side & (force > np.maximum.accumulate(np.append(force.min(), force))[:-1])
            for load, (least, most) in _LOADS.items():
                there = first & (fine["force"] >= least * tension) & (fine["force"] < most * tension)
                true, floor = ({name: each[there] for name, each in numbers.items()} for numbers in (truth, unknown))
                if there.any():
                    found = row_of(law, true, floor, case.size, branch)
                    rows.append(labels | {"model": f"{model}, {branch}, {load}"} | found)
    return rows


def row_of(
    law: xr.Dataset, truth: dict[str, Floats], unknown: dict[str, Floats], side: float, branch: str = "loading"
) -> dict[str, Floats]:
    """Return errors, stated ones and those of boundary elements, [what is asked, step]; NaN where there is no truth.

    Errors of the pressure are over the ``load``, if there is one, of the separation over that over the stiffness.
    """
    error, stated, floor = [], [], []
    load = truth.get("load", truth["pressure"])
    scales = truth | {"pressure": load, "separation": load * side**2 / np.abs(truth["stiffness"])}
    for control in _CONTROLS:
        values = truth[control]
        found = getattr(law.roughmdr, f"at_{control}")(values, branch=branch)
        for quantity in (each for each, given in ASKED if given == control):
            error.append((found[quantity].to_numpy() - truth[quantity]) / scales[quantity])
            stated.append(found[f"{quantity}_model_error"].to_numpy() / scales[quantity])
            floor.append(unknown[quantity] + unknown[control])
    return {"error": np.array(error), "stated": np.array(stated), "unknown": np.array(floor)}


def measure(quick: bool) -> xr.Dataset:
    """Compare all surfaces, or a few of them on coarse grids."""
    tasks = [(SEED, number, _POINTS[quick]) for number in range(SURFACES[quick])]
    adhering = in_two_processes(compare_adhering, PRESSED[:1] if quick else PRESSED)
    rows = [row for part in (*in_two_processes(compare, tasks), *adhering) for row in part]
    return dataset_of(rows)


def dataset_of(rows: list[dict[str, Any]]) -> xr.Dataset:
    """Return the errors of all cases."""
    asked = [f"{quantity} at given {control}" for quantity, control in ASKED]
    return of_rows(WORDS, rows, "case", "asked", "step").assign_coords(asked=asked)


def report(result: xr.Dataset) -> str:
    """Return by method and by what is asked how large errors are, and how the stated ones do."""
    rows = []
    for (group, model), own in groups_of(result, "group", "model"):
        for name in result["asked"].values:
            one = own.sel(asked=name)
            error, stated, unknown = (one[each].to_numpy() for each in ("error", "stated", "unknown"))
            known = np.isfinite(error) & np.isfinite(stated)
            if known.any():
                off = np.abs(error[known])
                sizes = [f"{100.0 * each:.2g} %" for each in np.quantile(off, [0.5, 0.9])]
                sign = percent(float(np.mean(error[known] > 0.0)), 0)
                rows.append([f"{group}, {model}", str(name), *sizes, sign, *held(off, stated[known], unknown[known])])
    surfaces = np.unique(result["surface"].values).size
    head = ["method", "asked", "median", "90 % below", "too high", *HELD]
    return f"""Errors on {surfaces} surfaces, f from 0.3 to 15 %; errors below those of boundary elements count as held:

{table(head, rows)}
"""


STUDY = Study(
    "at_pressure", "Area, stiffness and gap at given pressure: stated errors and true ones", measure, {}, report,
    f"{SURFACES[True]} of {SURFACES[False]} surfaces, on coarser grids",
)  # fmt: skip
