"""Asperities against boundary elements at the same separations: forces, areas, numbers of contacts, and run times.

Asperities are independent, displaced by the mean pressure, or coupled in pairs to first and second order.
"""

import math
import time
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from multiprocessing import get_context
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from oracles.boundary_elements import HeightMap
from oracles.contact_areas import by_perimeter, label_contacts, of_half_ellipsoids

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from studies.study import named
from studies.versus_bem.ensembles import SIZE, Case, contact_radii, distances
from studies.versus_bem.maps import MapCase

MODULUS = 1e9  # [Pa], E*
FRACTIONS = np.array([0.001, 0.003, 0.01, 0.03, 0.05, 0.1, 0.2, 0.3])
PLACEMENTS = ("random", "hard_core 0.5", "hard_core 0.7", "hexagonal", "square")
FINE, _FINE_FRACTION = 1024, 0.1
"""Grid of the cases that are to show more digits than the others, and their largest contact fraction."""
MODELS: dict[str, Any] = {
    "force": None,
    "force_mean": "mean_field",
    "force_first": {"model": "pairwise", "order": 1},
    "force_second": {"model": "pairwise", "order": 2},
}
"""Interactions, by the names of their forces."""
CASES: list[Case | MapCase] = [
    *(Case(where, "paraboloid", 64, rough, 256, seed)
      for seed, rough, where in product((1, 2), (0.02, 0.2, 1.0), PLACEMENTS)),
    *(Case(where, shape, 64, 0.2, 256, 3)
      for shape, where in product(("lognormal", "cone", "quartic"), PLACEMENTS[::2])),
    *(Case("nayak", "nayak", 250, long, 512, seed) for seed, long in ((6, 0.25), (7, 0.5), (8, 0.07))),
    *(MapCase(hurst, long, 0.0833, 256, 4) for hurst, long in product((0.3, 0.8), (0.5, 0.25, 0.0834))),
    *(Case(where, "paraboloid", count, 0.1, points, 5)
      for (count, points), where in product(((16, 128), (256, 512)), PLACEMENTS[::2])),
    *(Case(where, "paraboloid", 40, rough, 256, 9)
      for rough, where in product((0.02, 0.2), ("crowd 0.5", "crowd 0.7"))),
    *(Case("hard_core 0.7", "lognormal", count, 0.2, FINE, seed)
      for seed, count in enumerate((40, 52, 64, 80, 100), start=11)),
]  # fmt: skip
QUICK: list[Case | MapCase] = [
    Case("random", "paraboloid", 25, 0.2, 96, 1),
    Case("square", "paraboloid", 25, 0.02, 96, 1),
    MapCase(0.8, 0.25, 0.125, 128, 2),
]
_WORKERS = 2
_NAMES = {
    "contact_fraction": ("summed contact area of independent asperities over the nominal area", "1"),
    "contact_count": ("contacts of independent asperities", "1"),
    "force": ("force of independent asperities", "N"),
    "force_bem": ("force of boundary elements, infinite in full contact", "N"),
    "contact_fraction_bem": ("contact fraction of boundary elements", "1"),
    "force_coarse": ("force of boundary elements with half as many points a side", "N"),
    "force_mean": ("force of asperities displaced by the mean pressure", "N"),
    "force_first": ("force of coupled asperities, to first order", "N"),
    "force_second": ("force of coupled asperities, to second order", "N"),
    "contact_fraction_second": ("contact fraction to second order", "1"),
    "contact_count_second": ("contacts to second order", "1"),
    "contact_count_bem": ("contacts of boundary elements", "1"),
    "stated": ("stated model error to second order", "1"),
    "stated_first": ("stated model error to first order", "1"),
    "stated_alone": ("stated model error of independent asperities with positions", "1"),
    "seconds_second": ("run time of a load to second order", "s"),
    "seconds_bem": ("run time of a load by boundary elements", "s"),
    "seconds_coarse": ("run time of a load with half as many points a side", "s"),
    "overlap": ("share of contacts whose circle meets another", "1"),
    "overlap_poisson": ("the share for these radii at random places", "1"),
    "radius_points": ("root mean square of the contact radii over the spacing of the grid", "1"),
}
_VARIABLES = ("force", "contact_fraction", "contact_count", "model_error_curve")
_SEARCHED = 2000  # separations in which those of given contact fractions are found


class Step(NamedTuple):
    """Numbers at one separation, named in ``_NAMES``."""

    contact_fraction: float
    contact_count: float
    force: float
    force_bem: float
    contact_fraction_bem: float
    force_coarse: float
    force_mean: float
    force_first: float
    force_second: float
    contact_fraction_second: float
    contact_count_second: float
    contact_count_bem: float
    stated: float
    stated_first: float
    stated_alone: float
    seconds_second: float
    seconds_bem: float
    seconds_coarse: float
    overlap: float
    overlap_poisson: float
    radius_points: float


def separations(ensemble: xr.Dataset, fractions: Floats) -> Floats:
    """Return where independent asperities reach contact fractions; NaN where they do not before the lowest touches."""
    height = ensemble["height"].to_numpy()
    deep = 2.0 * float(np.ptp(height)) + 1e-7
    tried = height.max() - deep * np.linspace(0.0, 1.0, _SEARCHED)[1:] ** 3
    squares = [float(np.sum(contact_radii(ensemble, h) ** 2)) for h in tried.tolist()]
    return np.asarray(np.interp(fractions, math.pi * np.array(squares) / SIZE**2, tried, right=np.nan))


def overlaps(radius: Floats, distance: Floats) -> tuple[float, float]:
    """Return the share of contacts that meet another, and 1 - exp(-n pi <(a_i + a_j)^2>) of Poisson's points."""
    a = radius[radius > 0.0]
    if a.size < 2:
        return 0.0, 0.0
    apart = distance[np.ix_(radius > 0.0, radius > 0.0)]
    share = np.any(apart < a[:, None] + a[None, :], axis=1).mean()
    reach = (a * a)[:, None] + 2.0 * np.outer(a, a) + (a * a)[None, :]
    np.fill_diagonal(reach, 0.0)
    return float(share), float(np.mean(-np.expm1(-math.pi * reach.sum(axis=1) / SIZE**2)))


class Pressed(NamedTuple):
    """Boundary elements at one separation; NaN where they do not converge, as next to full contact."""

    force: float
    contact_fraction: float
    contact_count: float
    seconds: float


def press(surface: HeightMap, separation: float, separated_paraboloids: bool) -> Pressed:
    """Return what boundary elements find at a separation [m]; areas of separated paraboloids by their pressure."""
    started = time.perf_counter()
    try:
        force = surface.press(separation).force
    except rm.OutOfRange:
        return Pressed(math.nan, math.nan, math.nan, math.nan)
    seconds = time.perf_counter() - started
    if not math.isfinite(force):
        return Pressed(force, 1.0, 1.0, seconds)
    area = of_half_ellipsoids if separated_paraboloids else by_perimeter
    count = np.unique(label_contacts(surface.pressure)).size - 1
    return Pressed(force, area(surface.pressure), count, seconds)


def law_by(ensemble: xr.Dataset, separation: Floats, interaction: Any) -> dict[str, Floats]:
    """Return the law at separations [m], in falling order; NaN from where it has more contact than the patch."""
    for steps in range(separation.size, 0, -1):
        try:
            law = rm.load_separation(
                ensemble,
                separation=separation[:steps],
                effective_modulus=MODULUS,
                variables=_VARIABLES,
                interaction=interaction,
            )
        except rm.RoughmdrError:
            continue
        beyond = np.full(separation.size - steps, np.nan)
        return {name: np.concatenate([law[name].to_numpy(), beyond]) for name in _VARIABLES}
    return {name: np.full(separation.size, np.nan) for name in _VARIABLES}


def by_models(ensemble: xr.Dataset, separation: Floats) -> tuple[dict[str, dict[str, Floats]], float]:
    """Return the law by each of ``MODELS``, and the run time [s] of a load to second order."""
    laws = {name: law_by(ensemble, separation, interaction) for name, interaction in MODELS.items()}
    started = time.perf_counter()  # all is compiled by now
    law_by(ensemble, separation, MODELS["force_second"])
    return laws, (time.perf_counter() - started) / separation.size


def compare(case: Case | MapCase) -> list[Step]:
    """Return a step for each contact fraction that the ensemble reaches."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        ensemble, *maps = case.build()
        along = separations(ensemble, FRACTIONS[FRACTIONS <= _FINE_FRACTION] if case.points >= FINE else FRACTIONS)
        along = along[np.isfinite(along)]
        laws, seconds = by_models(ensemble, along)
    fine, coarse = (HeightMap(height, SIZE, MODULUS) for height in maps)
    distance = distances(ensemble)
    steps = []
    for i, h in enumerate(along.tolist()):
        radius = contact_radii(ensemble, h)
        share, expected_share = overlaps(radius, distance)
        whole = "radius" in ensemble and isinstance(case, Case) and share == 0.0
        found, rough = (press(surface, h, whole) for surface in (fine, coarse))
        alone, second = ({key: float(values[i]) for key, values in laws[name].items()}
                         for name in ("force", "force_second"))  # fmt: skip
        step = Step(
            contact_fraction=alone["contact_fraction"],
            contact_count=alone["contact_count"],
            **{name: float(law["force"][i]) for name, law in laws.items()},
            force_bem=found.force,
            contact_fraction_bem=found.contact_fraction,
            force_coarse=rough.force,
            contact_fraction_second=second["contact_fraction"],
            contact_count_second=second["contact_count"],
            contact_count_bem=found.contact_count,
            stated=second["model_error_curve"],
            stated_first=float(laws["force_first"]["model_error_curve"][i]),
            stated_alone=alone["model_error_curve"],
            seconds_second=seconds,
            seconds_bem=found.seconds,
            seconds_coarse=rough.seconds,
            overlap=share,
            overlap_poisson=expected_share,
            radius_points=float(np.sqrt(np.mean(radius[radius > 0.0] ** 2))) * case.points / SIZE,
        )
        steps.append(step)
    return steps


def measure(quick: bool) -> xr.Dataset:
    """Compare all cases, or a few of them on coarse grids."""
    cases = QUICK if quick else CASES
    with ProcessPoolExecutor(_WORKERS, mp_context=get_context("spawn")) as pool:
        return collect(cases, list(pool.map(compare, cases)))


def collect(cases: Sequence[Case | MapCase], compared: Sequence[list[Step]]) -> xr.Dataset:
    """Return all numbers, NaN for steps that a case does not reach."""
    numbers = np.full((len(cases), FRACTIONS.size, len(Step._fields)), np.nan)
    for row, steps in zip(numbers, compared, strict=True):
        row[: len(steps)] = np.reshape(steps, (-1, len(Step._fields)))
    placement, shape, roughness = zip(*(case.labels for case in cases), strict=True)
    return xr.Dataset(
        {
            name: (("case", "step"), numbers[..., i], named(long_name, units))
            for i, (name, (long_name, units)) in enumerate(_NAMES.items())
        },
        {
            "placement": ("case", list(placement)),
            "shape": ("case", list(shape)),
            "roughness": ("case", list(roughness), named("heights over the drop at a spacing; of maps, of the waves")),
            "seed": ("case", [case.seed for case in cases]),
        },
    )
