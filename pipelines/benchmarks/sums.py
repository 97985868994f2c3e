"""Ensembles of any shape, and the time that the package's sum over them takes, for each shape and law."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from studies.study import named

import roughmdr as rm
from benchmarks.child import HEIGHT
from roughmdr.aggregate import loop, totals
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading.staircase import no_memory, staircase
from roughmdr.numerics.arguments import Floats

MODULUS, WORK = 4e6, 0.05
RADIUS = {"distribution": "lognormal", "mean": "50 um", "std": "5 um"}
TOTALS = {totals.FORCE, totals.AREA, totals.COUNT, totals.STIFFNESS, totals.ERROR}
STATE = {totals.FORCE, totals.RADIUS, totals.STIFFNESS}
_R = np.linspace(0.0, 1e-5, 100)
SHAPES: dict[str, dict[str, Any]] = {
    "power_law": {"exponent": {"distribution": "uniform", "loc": 1.2, "scale": 3.0}, "width": "10 um", "rise": "1 um"},
    "sphere": {"radius": "50 um"},
    "truncated_cone": {"slope": 0.1, "flat_radius": "2 um"},
    "truncated_paraboloid": {"radius": "50 um", "flat_radius": "2 um"},
    "rounded_cone": {"slope": 0.1, "blend_radius": "5 um"},
    "capped_paraboloid": {"radius": "50 um", "cap_radius": "90 um", "blend_radius": "5 um"},
    "rounded_punch": {"flat_radius": "2 um", "edge_radius": "50 um"},
    "tabulated": {"r": _R.tolist(), "f": (1e-4 * _R + _R**2 / 1e-4).tolist()},
}
SLOPE = {"distribution": "uniform", "loc": 0.08, "scale": 0.04}
ALL: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": RADIUS},
    "cone": {"slope": SLOPE},
    "flat_punch": {"radius": {"distribution": "uniform", "loc": 1e-6, "scale": 2e-6}},
    **SHAPES,
    "sphere": {"radius": RADIUS},
    "truncated_cone": {"slope": SLOPE, "flat_radius": "2 um"},
    "truncated_paraboloid": {"radius": RADIUS, "flat_radius": "2 um"},
    "rounded_cone": {"slope": SLOPE, "blend_radius": "5 um"},
    "rounded_punch": {"flat_radius": "2 um", "edge_radius": RADIUS},
}
LAWS = ("none", "jkr", "dugdale")
_SLOW = {("tabulated", "dugdale"): 0.001}
"""Share of the asperities that is measured; of all others with a range of adhesion a twentieth."""


def section(count: int, shape: str = "paraboloid", **parameters: Any) -> dict[str, Any]:
    """Return the asperities of a scene."""
    given = {"source": "random", "shape": shape, "count": count, "patch": "1 m", "height": HEIGHT}
    return {**given, **(parameters or {"radius": RADIUS})}


def ensemble_of(*args: Any, **parameters: Any) -> Ensemble:
    """Return the asperities of a ``section``."""
    return Ensemble.from_dataset(rm.generate(section(*args, **parameters), seed=1))


def loading(steps: int = 200) -> Floats:
    """Return separations [m]."""
    return np.linspace(4e-6, -0.5e-6, steps)


def cost_of(action: Callable[[], int], repeats: int = 1) -> tuple[float, int]:
    """Return the shortest wall time [s] of an action, and its visits, which it returns."""
    times, visits = [], 1
    for _ in range(repeats):
        started = time.perf_counter()
        visits = action()
        times.append(time.perf_counter() - started)
    return min(times), visits


def each(cost: tuple[float, int]) -> float:
    """Return the time of a visit [ns]."""
    return 1e9 * cost[0] / cost[1]


def by_the_sum(ensemble: Ensemble, adhesion: Adhesion, repeats: int, rows: set[int], steps: int) -> tuple[float, int]:
    """Return time [s] and visits of the package's sum there and back, all included."""
    columns, path = ensemble.columns, np.concatenate([loading(steps), loading(steps)[::-1]])
    kernels = choose(ensemble.shape, adhesion, columns[2])
    memory = staircase(path) if adhesion.work else no_memory(path)

    def visits() -> int:
        return loop.sum_over_asperities(kernels, ensemble.height, columns, MODULUS, adhesion, path, memory, rows)[2]

    visits()
    return cost_of(visits, repeats)


def split_cost(ensemble: Ensemble, adhesion: Adhesion, repeats: int) -> tuple[float, float, tuple[float, int]]:
    """Return the times [ns] of delta -> (P, a, k) and of preparing an asperity, and the cost of 200 steps each way.

    The first two are told apart by paths of few steps and of many.
    """
    short, long = (by_the_sum(ensemble, adhesion, repeats, STATE, steps) for steps in (200, 2000))
    state = (long[0] - short[0]) / (long[1] - short[1])
    return 1e9 * state, 1e9 * (short[0] - state * short[1]) / ensemble.height.size, short


def by_law(count: int, repeats: int) -> xr.Dataset:
    """Measure every shape with every law, and the JKR paraboloid in the same run; Tabor number 1 of 50 um."""
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    laws = {"none": Adhesion(), "jkr": Adhesion(WORK), "dugdale": Adhesion(WORK, "dugdale", 1.0 / one)}
    found = np.full((len(ALL), len(LAWS)), np.nan)
    reference = each(by_the_sum(ensemble_of(count), laws["jkr"], repeats, TOTALS, 200))
    for i, (shape, parameters) in enumerate(ALL.items()):
        for j, law in enumerate(LAWS):
            share = _SLOW.get((shape, law), 0.05 if law == "dugdale" and shape != "paraboloid" else 1.0)
            ensemble = ensemble_of(max(20, int(share * count)), shape, **parameters)
            found[i, j] = each(by_the_sum(ensemble, laws[law], repeats, TOTALS, 200))
    over = ("law_shape", "law")
    variables = {
        "law_time": (over, found, named("time per contact and step", "ns")),
        "law_ratio": (over, found / reference, named("time over that of the JKR paraboloid")),
    }
    return xr.Dataset(variables, {"law_shape": list(ALL), "law": list(LAWS)})
