"""The costs of the sum: time a visited asperity and step, against NumPy and SciPy; two workers; a million; a cell.

All figures come from one run, since ratios hold where times drift.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from oracles.plain_sums import Sums, with_brentq, with_numpy
from scipy.optimize import brentq
from studies.comparison import in_cases
from studies.study import Figure, Study, blank, named, timed

import roughmdr as rm
from benchmarks.batch import by_cell, tables
from benchmarks.child import HEIGHT, load_separation
from benchmarks.process import in_new_process
from benchmarks.tasks import by_workers
from roughmdr.aggregate import loop, totals
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading.staircase import no_memory, staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.shapes import SHAPES as SHAPE_OF, PowerLaw, ProfileShape, Shape
from roughmdr.shapes.kappa import kappa

MODULUS, WORK = 4e6, 0.05
RADIUS = {"distribution": "lognormal", "mean": "50 um", "std": "5 um"}
TOTALS = {totals.FORCE, totals.AREA, totals.COUNT, totals.STIFFNESS, totals.ERROR}
STATE = {totals.FORCE, totals.RADIUS, totals.STIFFNESS}
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
LAWS = {"none": "no adhesion", "jkr": "JKR", "dugdale": "Dugdale, Tabor number 1"}
_SLOW = {("tabulated", "dugdale"): 0.001}
"""Share of the asperities that is measured; of all others with a range of adhesion a twentieth."""
ASPERITIES = {False: 1_000_000, True: 20_000}
TABOR = (0.1, 1.0, 10.0, 100.0)
_RANGE = {"dugdale_state_time": ("time per asperity and step", "ns"), "dugdale_time": ("200 steps each way", "s")}
_CLOSED = ("paraboloid", "cone", "flat_punch")  # shapes without a profile that a root finder is given
_BRENTQ = 300, 200  # asperities, or contacts of one, that a root finder is given


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


def each(cost: tuple[int, float]) -> float:
    """Return the time of a visit [ns] from the visits of an action and its time [s]."""
    return 1e9 * cost[1] / cost[0]


def by_the_sum(ensemble: Ensemble, adhesion: Adhesion, repeats: int, rows: set[int], steps: int) -> tuple[int, float]:
    """Return visits and time [s] of the package's sum there and back, all included."""
    columns, path = ensemble.columns, np.concatenate([loading(steps), loading(steps)[::-1]])
    kernels = choose(ensemble.shape, adhesion, columns[2])
    memory = staircase(path) if adhesion.work else no_memory(path)

    def visits() -> int:
        return loop.sum_over_asperities(kernels, ensemble.height, columns, MODULUS, adhesion, path, memory, rows)[2]

    visits()
    return timed(visits, repeats)


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


def by_brentq(ensemble: Ensemble) -> tuple[int, float]:
    """Return the cost of a root finder on delta = g(a) - dl(a) of the first asperity."""
    first = {name: float(column[0]) for name, column in ensemble.parameters.items()}
    shape: Shape = ensemble.shared_profile or SHAPE_OF[ensemble.shape](**first)
    off = rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control="displacement")
    fold, g = float(off.contact_radius), scalar_g(shape)
    g(fold)  # compiled before the clock runs
    top = 0.999999 * shape.end if shape.name == "sphere" else 1e3 * fold
    depths = np.linspace(1e-8, 1e-6, _BRENTQ[1])

    def indentation(a: float, delta: float) -> float:
        return g(a) - math.sqrt(2.0 * math.pi * a * WORK / MODULUS) - delta

    def visits() -> int:
        for delta in depths:
            brentq(indentation, fold, top, args=(delta,), xtol=1e-15 * fold)
        return depths.size

    return timed(visits)


def by_method(count: int, repeats: int) -> xr.Dataset:
    """Measure paraboloids: by the package there and back, by NumPy and a root finder in loading; and a million."""
    large, small = ensemble_of(count), ensemble_of(count // 10)

    def visits(sums: Callable[..., Sums], asperities: int, work: float) -> int:
        columns = small.height[:asperities], small.parameters["radius"][:asperities]
        return sums(*columns, loading(), MODULUS, work).visits

    cost = []
    for work in (0.0, WORK):
        package = by_the_sum(large, Adhesion(work), repeats, TOTALS, 200)
        plain = [timed(partial(visits, *of, work)) for of in ((with_numpy, count), (with_brentq, _BRENTQ[0]))]
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


def of_range(tabor: float) -> Adhesion:
    """Return adhesion of finite range by the Tabor number of 50 um."""
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    return Adhesion(WORK, "dugdale", tabor / one)


def by_range(count: int, repeats: int) -> xr.Dataset:
    """Measure paraboloids under adhesion of finite range, by their Tabor number: one step more, and 200 each way."""
    ensemble, found = ensemble_of(count), []
    for tabor in TABOR:
        short, long = (by_the_sum(ensemble, of_range(tabor), repeats, STATE, steps) for steps in (200, 2000))
        found.append((1e9 * (long[1] - short[1]) / (long[0] - short[0]), short[1]))
    numbers = ("tabor", list(TABOR), named("Tabor number"))
    return xr.Dataset(in_cases(_RANGE, found, "tabor"), {"tabor": numbers}, {"dugdale_count": count})


def by_law(count: int, repeats: int) -> xr.Dataset:
    """Measure every shape with every law, the JKR paraboloid in the same run, and a root finder; Tabor number 1."""
    laws = {"none": Adhesion(), "jkr": Adhesion(WORK), "dugdale": of_range(1.0)}
    found, by_root = np.full((len(SHAPES), len(LAWS)), np.nan), np.full(len(SHAPES), np.nan)
    reference = each(by_the_sum(ensemble_of(count), laws["jkr"], repeats, TOTALS, 200))
    for i, (shape, parameters) in enumerate(SHAPES.items()):
        for j, law in enumerate(LAWS):
            share = _SLOW.get((shape, law), 0.05 if law == "dugdale" and shape != "paraboloid" else 1.0)
            ensemble = ensemble_of(max(20, int(share * count)), shape, **parameters)
            found[i, j] = each(by_the_sum(ensemble, laws[law], repeats, TOTALS, 200))
        if shape not in _CLOSED:
            by_root[i] = each(by_brentq(ensemble))
    over = ("law_shape", "law")
    variables = {
        "law_time": (over, found, named("time per contact and step", "ns")),
        "law_ratio": (over, found / reference, named("time over that of the JKR paraboloid")),
        "law_brentq": ("law_shape", by_root, named("time of scipy's brentq for a contact, JKR", "ns")),
    }
    return xr.Dataset(variables, {"law_shape": list(SHAPES), "law": list(LAWS)})


def measure(quick: bool) -> xr.Dataset:
    """Return all figures; ``quick`` of small ensembles."""
    count, repeats = ASPERITIES[quick], 1 if quick else 3
    parts = [by_method(count, repeats), by_range(count // 10, repeats)]
    parts.append(by_law(count // 50 if quick else count // 10, repeats))
    parts += [by_cell(200 if quick else 10_000, repeats), by_workers(count // 10, 24, repeats)]
    return xr.merge(parts, combine_attrs="no_conflicts")


def draw(result: xr.Dataset) -> Figure:
    """Draw bars of time per visit, on logarithmic axes."""
    figure = blank(13, 4)
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.8])
    contacts = {str(name): result.cost.sel(contact=name) for name in result.contact.to_numpy()}
    others = {label: result.law_time.sel(law=law) for law, label in LAWS.items()} | {"scipy brentq": result.law_brentq}
    for ax, groups, width, title in (
        (left, contacts, 0.38, "Paraboloids: the sum, one core"),
        (right, others, 0.2, "Shapes, 200 steps each way, set-up included"),
    ):
        for number, (label, values) in enumerate(groups.items()):
            bars = ax.bar(np.arange(values.size) + 1.06 * width * number, values.to_numpy(), width, label=label)
            ax.bar_label(bars, fmt="%.3g", fontsize=7)
        ax.set(yscale="log", ylabel="ns per asperity and step", title=title)
        ax.set_ylim(top=50.0 * max(float(values.max()) for values in groups.values()))
        ax.legend(frameon=False, ncols=3, loc="upper left")
    left.set_xticks(np.arange(3) + 0.2, ["roughmdr\n(both ways)", "NumPy\n(loading)", "scipy brentq\n(loading)"])
    names = [str(shape).replace("_", "\n") for shape in result["law_shape"].to_numpy()]
    right.set_xticks(np.arange(len(names)) + 0.3, names)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    counts = "{asperities} paraboloids, {dugdale_count} of them with Dugdale adhesion; a sweep of {cells} cells"
    return f"Measured on the sum over {counts.format(**result.attrs)}.\n\n{tables(result)}"


STUDY = Study(
    "scaling", "What the sum costs", measure, draw, report,
    f"up to {ASPERITIES[True]} of {ASPERITIES[False]} asperities, each timed once",
)  # fmt: skip
