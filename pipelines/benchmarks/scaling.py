"""The costs of the sum: time a visited asperity and step, against NumPy and SciPy; two workers; a million; a cell.

All figures come from one run, since ratios hold where times drift.
"""

import math
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from oracles.plain_sums import Sums, with_brentq, with_numpy
from scipy.optimize import brentq
from studies.study import Study, named

import roughmdr as rm
from benchmarks.batch import by_cell, tables
from benchmarks.child import load_separation
from benchmarks.process import in_new_process
from benchmarks.sums import (
    MODULUS,
    SHAPES,
    TOTALS,
    WORK,
    by_law,
    by_the_sum,
    cost_of,
    each,
    ensemble_of,
    loading,
    section,
    split_cost,
)
from benchmarks.tasks import by_workers
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.jit import compiled
from roughmdr.shapes import SHAPES as SHAPE_OF
from roughmdr.shapes import PowerLaw, ProfileShape, Shape
from roughmdr.shapes.kappa import kappa

ASPERITIES = {False: 1_000_000, True: 20_000}
TABOR = (0.1, 1.0, 10.0, 100.0)
_BRENTQ = 300, 200  # asperities, or contacts of one, that a root finder is given
_BARS = {
    "state_time": "one more step",
    "path_time": "200 steps each way, set-up included",
    "state_time_brentq": "scipy brentq",
}


def scalar_g(shape: Shape) -> Callable[[float], float]:
    """Return g(a) of one shape as a function of floats, the fastest for a root finder."""
    width, rise, params = shape.nondimensional()
    if isinstance(shape, PowerLaw):
        factor, n = kappa(params) * rise, params
        return lambda a: factor * (a / width) ** n
    assert isinstance(shape, ProfileShape)
    mdr_profile, t_of_radius = compiled(shape.profile.mdr_profile), compiled(shape.profile.t_of_radius)
    numbers = np.atleast_1d(np.asarray(params, dtype=np.float64))
    return lambda a: rise * mdr_profile(t_of_radius(a, width, numbers), numbers)[2]


def by_brentq(ensemble: Ensemble) -> tuple[float, int]:
    """Return the cost of a root finder on delta = g(a) - dl(a) of the first asperity."""
    first = {name: float(column[0]) for name, column in ensemble.parameters.items()}
    shape: Shape = ensemble.shared_profile or SHAPE_OF[ensemble.shape](**first)
    fold, g = (
        float(rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control="displacement").contact_radius),
        scalar_g(shape),
    )
    g(fold)  # compiled before the clock runs
    top = 0.999999 * shape.end if shape.name == "sphere" else 1e3 * fold
    depths = np.linspace(1e-8, 1e-6, _BRENTQ[1])

    def indentation(a: float, delta: float) -> float:
        return g(a) - math.sqrt(2.0 * math.pi * a * WORK / MODULUS) - delta

    def visits() -> int:
        for delta in depths:
            brentq(indentation, fold, top, args=(delta,), xtol=1e-15 * fold)
        return depths.size

    return cost_of(visits)


def by_method(count: int, repeats: int) -> xr.Dataset:
    """Measure paraboloids: by the package there and back, by NumPy and a root finder in loading; and a million."""
    large, small = ensemble_of(count), ensemble_of(count // 10)

    def visits(sums: Callable[..., Sums], asperities: int, work: float) -> int:
        columns = small.height[:asperities], small.parameters["radius"][:asperities]
        return sums(*columns, loading(), MODULUS, work).visits

    cost = []
    for work in (0.0, WORK):
        package = by_the_sum(large, Adhesion(work), repeats, TOTALS, 200)
        plain = [cost_of(partial(visits, *of, work)) for of in ((with_numpy, count), (with_brentq, _BRENTQ[0]))]
        cost.append([each(one) for one in (package, *plain)])
    arguments = {"effective_modulus": MODULUS, "work": WORK, "unload": True}
    seconds, size = in_new_process(load_separation, section(count), loading().tolist(), arguments)
    variables = {
        "cost": (("contact", "method"), cost, named("time per visited asperity and step", "ns")),
        "large_time": ((), seconds, named("one ensemble, 200 steps each way, JKR", "s")),
        "large_memory": ((), size, named("peak memory above the ensemble", "byte")),
    }
    coords = {"contact": ["Hertz", "JKR"], "method": ["roughmdr", "numpy", "brentq"]}
    return xr.Dataset(variables, coords, {"asperities": count})


def by_range(count: int, repeats: int) -> xr.Dataset:
    """Measure paraboloids under adhesion of finite range, by their Tabor number."""
    ensemble = ensemble_of(count)
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    found = [split_cost(ensemble, Adhesion(WORK, "dugdale", tabor / one), repeats) for tabor in TABOR]
    variables = {
        "dugdale_state_time": ("tabor", [state for state, *_ in found], named("time per asperity and step", "ns")),
        "dugdale_time": ("tabor", [short[0] for *_, short in found], named("200 steps each way", "s")),
    }
    return xr.Dataset(variables, {"tabor": ("tabor", list(TABOR), named("Tabor number"))}, {"dugdale_count": count})


def by_shape(count: int, repeats: int) -> xr.Dataset:
    """Measure every other shape with JKR, and a root finder on it."""
    rows = []
    for shape, parameters in SHAPES.items():
        ensemble = ensemble_of(count, shape, **parameters)
        started = time.perf_counter()
        _ = ensemble.columns  # for a table: its pieces
        profile = time.perf_counter() - started
        state, before, short = split_cost(ensemble, Adhesion(WORK), repeats)
        rows.append((state, before, each(short), each(by_brentq(ensemble)), profile))
    names = {
        "state_time": named("time per asperity and step", "ns"),
        "asperity_time": named("time per asperity, once", "ns"),
        "path_time": named("time per asperity and step over 200 steps each way, all included", "ns"),
        "state_time_brentq": named("time per asperity and step", "ns"),
        "profile_time": named("time to set up the profiles", "s"),
    }
    variables = {name: ("shape", column, names[name]) for name, column in zip(names, np.array(rows).T, strict=True)}
    return xr.Dataset(variables, {"shape": list(SHAPES)})


def measure(quick: bool) -> xr.Dataset:
    """Return all figures; ``quick`` of small ensembles."""
    count, repeats = ASPERITIES[quick], 1 if quick else 3
    parts = [by_method(count, repeats), by_shape(count // 50, repeats), by_range(count // 10, repeats)]
    parts.append(by_law(count // 50 if quick else count // 10, repeats))
    parts += [by_cell(200 if quick else 10_000, repeats), by_workers(count // 10, 24, repeats)]
    return xr.merge(parts, combine_attrs="no_conflicts")


def draw(result: xr.Dataset) -> Figure:
    """Draw bars of time per visit, on logarithmic axes."""
    figure = Figure(figsize=(13, 4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.8])
    contacts = {str(name): result.cost.sel(contact=name) for name in result.contact.to_numpy()}
    others = {label: result[name] for name, label in _BARS.items()}
    for ax, groups, width, title in (
        (left, contacts, 0.38, "Paraboloids: the sum, one core"),
        (right, others, 0.26, "Other shapes with JKR: force, radius and stiffness"),
    ):
        for number, (label, values) in enumerate(groups.items()):
            bars = ax.bar(np.arange(values.size) + 1.06 * width * number, values.to_numpy(), width, label=label)
            ax.bar_label(bars, fmt="%.3g", fontsize=7)
        ax.set(yscale="log", ylabel="ns per asperity and step", title=title)
        ax.set_ylim(top=50.0 * max(float(values.max()) for values in groups.values()))
        ax.legend(frameon=False, ncols=3, loc="upper left")
    left.set_xticks(np.arange(3) + 0.2, ["roughmdr\n(both ways)", "NumPy\n(loading)", "scipy brentq\n(loading)"])
    names = [str(shape).replace("_", "\n") for shape in result["shape"].to_numpy()]
    right.set_xticks(np.arange(len(names)) + 0.28, names)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    counts = (
        "the sum over {asperities} paraboloids, {dugdale_count} of them with Dugdale adhesion; a sweep of {cells} cells"
    )
    return f"Measured on {counts.format(**result.attrs)}.\n\n{tables(result)}"


STUDY = Study(
    "scaling", "What the sum costs", measure, draw, report,
    f"up to {ASPERITIES[True]} of {ASPERITIES[False]} asperities, each timed once",
)  # fmt: skip
