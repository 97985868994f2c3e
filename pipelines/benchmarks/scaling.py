"""The costs of the sum: time a visited asperity and step, against NumPy and SciPy; a million asperities.

All figures come from one run, since ratios hold where times drift.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from oracles.plain_sums import with_numpy
from scipy.optimize import brentq
from studies.study import Study, named, timed

import roughmdr as rm
from benchmarks.batch import tables
from benchmarks.child import HEIGHT, in_new_process, load_separation
from roughmdr.aggregate import loop, totals
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading.staircase import no_memory, staircase
from roughmdr.numerics.jit import compiled
from roughmdr.shapes import SHAPES as SHAPE_OF, ProfileShape, Shape
from roughmdr.shapes.kappa import kappa

MODULUS, WORK = 4e6, 0.05
RADIUS = {"distribution": "lognormal", "mean": "50 um", "std": "5 um"}
TOTALS = {totals.FORCE, totals.AREA, totals.COUNT, totals.STIFFNESS, totals.ERROR}
_R = np.linspace(0.0, 1e-5, 100)
SLOPE = {"distribution": "uniform", "loc": 0.08, "scale": 0.04}
SHAPES: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": RADIUS},
    "cone": {"slope": SLOPE},
    "flat_punch": {"radius": {"distribution": "uniform", "loc": 1e-6, "scale": 2e-6}},
    "power_law": {"exponent": {"distribution": "uniform", "loc": 1.2, "scale": 3.0}, "width": "10 um", "rise": "1 um"},
    "sphere": {"radius": RADIUS},
    "truncated_cone": {"slope": SLOPE, "flat_radius": "2 um"},
    "truncated_paraboloid": {"radius": RADIUS, "flat_radius": "2 um"},
    "rounded_cone": {"slope": SLOPE, "blend_radius": "5 um"},
    "capped_paraboloid": {"radius": "50 um", "cap_radius": "90 um", "blend_radius": "5 um"},
    "rounded_punch": {"flat_radius": "2 um", "edge_radius": RADIUS},
    "tabulated": {"r": _R.tolist(), "f": (1e-4 * _R + _R**2 / 1e-4).tolist()},
}
LOADING = np.linspace(4e-6, -0.5e-6, 200)  # separations [m]
_SLOW = {("tabulated", "dugdale"): 0.001}
"""Share of the asperities that is measured; of all others with a range of adhesion a twentieth."""
ASPERITIES = {False: 1_000_000, True: 20_000}
_BRENTQ = 200  # contacts that a root finder is given


def section(count: int, shape: str = "paraboloid", **parameters: Any) -> dict[str, Any]:
    """Return the asperities of a scene."""
    given = {"source": "random", "shape": shape, "count": count, "patch": "1 m", "height": HEIGHT}
    return {**given, **(parameters or {"radius": RADIUS})}


def ensemble_of(*args: Any, **parameters: Any) -> Ensemble:
    """Return the asperities of a ``section``."""
    return Ensemble.from_dataset(rm.generate(section(*args, **parameters), seed=1))


def each(cost: tuple[int, float]) -> float:
    """Return the time of a visit [ns] from the visits of an action and its time [s]."""
    return 1e9 * cost[1] / cost[0]


def by_the_sum(ensemble: Ensemble, adhesion: Adhesion, repeats: int) -> float:
    """Return the time of a visit [ns] in the package's sum there and back, all included."""
    columns, path = ensemble.columns, np.concatenate([LOADING, LOADING[::-1]])
    kernels = choose(ensemble.shape, adhesion, columns[2])
    memory = staircase(path) if adhesion.work else no_memory(path)

    def visits() -> int:
        return loop.sum_over_asperities(kernels, ensemble.height, columns, MODULUS, adhesion, path, memory, TOTALS)[2]

    visits()
    return each(timed(visits, repeats))


def scalar_g(shape: Shape) -> Callable[[float], float]:
    """Return g(a) of one shape as a function of floats, the fastest for a root finder."""
    width, rise, params = shape.nondimensional()
    if not isinstance(shape, ProfileShape):
        factor, n = kappa(params) * rise, params
        return lambda a: factor * (a / width) ** n
    mdr_profile, t_of_radius = compiled(shape.profile.mdr_profile), compiled(shape.profile.t_of_radius)
    numbers = np.atleast_1d(np.asarray(params, dtype=np.float64))
    return lambda a: rise * mdr_profile(t_of_radius(a, width, numbers), numbers)[2]


def by_brentq(ensemble: Ensemble) -> float:
    """Return the time [ns] of a root finder on delta = g(a) - dl(a) of the first asperity."""
    first = {name: float(column[0]) for name, column in ensemble.parameters.items()}
    shape: Shape = ensemble.shared_profile or SHAPE_OF[ensemble.shape](**first)
    off = rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control="displacement")
    fold, g = float(off.contact_radius), scalar_g(shape)
    g(fold)  # compiled before the clock runs
    top = 0.999999 * shape.end if shape.name == "sphere" else 1e3 * fold
    depths = np.linspace(1e-8, 1e-6, _BRENTQ)

    def indentation(a: float, delta: float) -> float:
        return g(a) - math.sqrt(2.0 * math.pi * a * WORK / MODULUS) - delta

    def visits() -> int:
        for delta in depths:
            brentq(indentation, fold, top, args=(delta,), xtol=1e-15 * fold)
        return depths.size

    return each(timed(visits))


def by_method(count: int, repeats: int) -> xr.Dataset:
    """Measure paraboloids: by the package there and back, by NumPy in loading; and a million."""
    large, small = ensemble_of(count), ensemble_of(count // 10)

    def visits(work: float) -> int:
        return with_numpy(small.height, small.parameters["radius"], LOADING, MODULUS, work).visits

    works = 0.0, WORK
    cost = [[by_the_sum(large, Adhesion(work), repeats), each(timed(partial(visits, work)))] for work in works]
    arguments = {"effective_modulus": MODULUS, "work": WORK, "unload": True}
    seconds, size = in_new_process(load_separation, section(count), LOADING.tolist(), arguments)
    variables = {
        "cost": (("contact", "method"), cost, named("time per visited asperity and step", "ns")),
        "large_time": ((), seconds, named("one ensemble, 200 steps each way, JKR", "s")),
        "large_memory": ((), size, named("peak memory above the ensemble", "byte")),
    }
    coords = {"contact": ["Hertz", "JKR"], "method": ["roughmdr", "numpy"]}
    return xr.Dataset(variables, coords, {"asperities": count})


def by_law(count: int, repeats: int) -> xr.Dataset:
    """Measure every shape with every law, and a root finder; the Tabor number of a paraboloid of 50 um is 1."""
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    laws = {"none": Adhesion(), "jkr": Adhesion(WORK), "dugdale": Adhesion(WORK, "dugdale", 1.0 / one)}
    found, by_root = np.full((len(SHAPES), len(laws)), np.nan), np.full(len(SHAPES), np.nan)
    for i, (shape, parameters) in enumerate(SHAPES.items()):
        for j, (law, adhesion) in enumerate(laws.items()):
            share = _SLOW.get((shape, law), 0.05 if law == "dugdale" and shape != "paraboloid" else 1.0)
            ensemble = ensemble_of(max(20, int(share * count)), shape, **parameters)
            found[i, j] = by_the_sum(ensemble, adhesion, repeats)
        if shape != "flat_punch":  # its radius is known
            by_root[i] = by_brentq(ensemble)
    variables = {
        "law_time": (("law_shape", "law"), found, named("time per contact and step", "ns")),
        "law_brentq": ("law_shape", by_root, named("time of scipy's brentq for a contact, JKR", "ns")),
    }
    return xr.Dataset(variables, {"law_shape": list(SHAPES), "law": list(laws)})


def measure(quick: bool) -> xr.Dataset:
    """Return all figures; ``quick`` of small ensembles."""
    count, repeats = ASPERITIES[quick], 1 if quick else 3
    parts = [by_method(count, repeats), by_law(count // 50 if quick else count // 10, repeats)]
    return xr.merge(parts, combine_attrs="no_conflicts")


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    return f"Measured on the sum over {result.attrs['asperities']} paraboloids.\n\n{tables(result)}"


STUDY = Study(
    "scaling", "What the sum costs", measure, {}, report,
    f"up to {ASPERITIES[True]} of {ASPERITIES[False]} asperities, each timed once",
)  # fmt: skip
