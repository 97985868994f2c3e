"""The costs of the sum: time a visited asperity and step, against NumPy and SciPy; two workers; a million; a cell.

All figures come from one run, since ratios hold where times drift.
"""

import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from oracles.plain_sums import Cost, by_brentq, by_brentq_on, by_numpy, cost_of
from studies.study import named, table

import roughmdr as rm
from benchmarks.batch import by_cell, by_workers
from benchmarks.child import load_separation
from benchmarks.process import in_new_process
from roughmdr.aggregate import loop, totals
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading.staircase import no_memory, staircase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODULUS, WORK = 4e6, 0.05
TABOR = (0.1, 1.0, 10.0, 100.0)
TOTALS = frozenset({totals.FORCE, totals.AREA, totals.COUNT, totals.STIFFNESS, totals.ERROR})
STATE = frozenset({totals.FORCE, totals.RADIUS, totals.STIFFNESS})
SHAPES: dict[str, dict[str, Any]] = {
    "power_law": {
        "exponent": {"distribution": "uniform", "loc": 1.2, "scale": 3.0},
        "width": "10 um",
        "rise": "1 um",
    },
    "sphere": {"radius": "50 um"},
    "truncated_cone": {"slope": 0.1, "flat_radius": "2 um"},
    "truncated_paraboloid": {"radius": "50 um", "flat_radius": "2 um"},
    "rounded_cone": {"slope": 0.1, "blend_radius": "5 um"},
    "capped_paraboloid": {"radius": "50 um", "cap_radius": "90 um", "blend_radius": "5 um"},
    "rounded_punch": {"flat_radius": "2 um", "edge_radius": "50 um"},
    "tabulated": {
        "r": (np.linspace(0.0, 1e-5, 100)).tolist(),
        "f": (1e-4 * np.linspace(0.0, 1e-5, 100) + np.linspace(0.0, 1e-5, 100) ** 2 / 1e-4).tolist(),
    },
}
RADIUS = {"distribution": "lognormal", "mean": "50 um", "std": "5 um"}
_BARS = {
    "state_time": "one more step",
    "path_time": "200 steps each way, set-up included",
    "state_time_brentq": "scipy brentq",
}


def section(count: int, shape: str = "paraboloid", **parameters: Any) -> dict[str, Any]:
    """Return the asperities of a scene."""
    height = {"distribution": "normal", "std": "1 um"}
    given = {"source": "random", "shape": shape, "count": count, "patch": "1 mm", "height": height}
    return {**given, **(parameters or {"radius": RADIUS})}


def ensemble_of(count: int, shape: str = "paraboloid", **parameters: Any) -> Ensemble:
    """Return the asperities that are visited."""
    return Ensemble.from_dataset(rm.generate(section(count, shape, **parameters), seed=1))


def there_and_back(steps: int) -> np.ndarray:
    """Return the separations [m] of loading and unloading."""
    loading = np.linspace(4e-6, -0.5e-6, steps)
    return np.concatenate([loading, loading[::-1]])


def by_the_sum(
    ensemble: Ensemble, path: np.ndarray, adhesion: Adhesion, repeats: int, rows: frozenset[int] = TOTALS
) -> Cost:
    """Measure the package's sum, all included."""
    columns = ensemble.nondimensional()
    kernels = choose(ensemble.shape, adhesion, columns[2])
    memory = staircase(path) if adhesion.work else no_memory(path)

    def action() -> int:
        _, _, visits = loop.sum_over_asperities(
            kernels, ensemble.height, columns, MODULUS, adhesion, path, memory, set(rows)
        )
        return visits

    action()
    return cost_of(action, repeats)


def split_cost(ensemble: Ensemble, adhesion: Adhesion, repeats: int) -> tuple[float, float, Cost]:
    """Measure the seconds of delta -> (P, a, k), the seconds of preparing an asperity, and all of 200 steps each way.

    The first two are told apart by paths of few steps and of many.
    """
    short, long = (by_the_sum(ensemble, there_and_back(steps), adhesion, repeats, STATE) for steps in (200, 2000))
    each = (long.seconds - short.seconds) / (long.visits - short.visits)
    return each, (short.seconds - each * short.visits) / ensemble.height.size, short


def by_range(count: int, repeats: int) -> xr.Dataset:
    """Measure paraboloids under adhesion of finite range, by their Tabor number."""
    ensemble = ensemble_of(count)
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    found = [split_cost(ensemble, Adhesion(WORK, "dugdale", tabor / one), repeats) for tabor in TABOR]
    each, before, path = zip(*found, strict=True)
    return xr.Dataset(
        {
            "dugdale_state_time": ("tabor", 1e9 * np.array(each), named("time per asperity and step", "ns")),
            "dugdale_asperity_time": ("tabor", 1e9 * np.array(before), named("time per asperity, once", "ns")),
            "dugdale_time": ("tabor", [cost.seconds for cost in path], named("200 steps each way", "s")),
        },
        coords={"tabor": ("tabor", list(TABOR), named("Tabor number"))},
        attrs={"dugdale_asperities": count},
    )


def by_shape(count: int, repeats: int) -> xr.Dataset:
    """Measure every other shape with JKR, and a root finder on it."""
    rows = []
    for shape, parameters in SHAPES.items():
        ensemble = ensemble_of(count, shape, **parameters)
        started = time.perf_counter()
        ensemble.nondimensional()  # for a table: its pieces
        profile = time.perf_counter() - started
        each, before, short = split_cost(ensemble, Adhesion(WORK), repeats)
        rows.append((1e9 * each, 1e9 * before, short.each, by_brentq_on(ensemble, MODULUS, WORK).each, profile))
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
    count, repeats = (20_000, 1) if quick else (1_000_000, 3)
    large, small = ensemble_of(count), ensemble_of(count // 10)
    loading = there_and_back(200)[:200]
    cost = [
        [
            by_the_sum(large, there_and_back(200), Adhesion(work), repeats).each,
            by_numpy(small, loading, MODULUS, work).each,
            by_brentq(small, loading, MODULUS, work).each,
        ]
        for work in (0.0, WORK)
    ]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "ensemble.nc"
        rm.generate(section(count), seed=1).to_netcdf(file)
        seconds, size = in_new_process(load_separation, str(file), MODULUS, WORK)
    own = xr.Dataset(
        {
            "cost": (("contact", "method"), cost, named("time per visited asperity and step", "ns")),
            "large_time": ((), seconds, named("one ensemble, 200 steps each way, JKR", "s")),
            "large_memory": ((), size, named("peak memory above the ensemble", "byte")),
        },
        {"contact": ["Hertz", "JKR"], "method": ["roughmdr", "numpy", "brentq"]},
        {"asperities": count},
    )
    parts = [own, by_shape(count // 50, repeats), by_range(count // 10, repeats)]
    parts += [by_cell(200 if quick else 10_000, repeats), by_workers(count // 10, 24, repeats)]
    return xr.merge(parts, combine_attrs="no_conflicts")


def draw(result: xr.Dataset) -> "Figure":
    """Draw bars of time per visit, on logarithmic axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.8])
    for number, contact in enumerate(result["contact"].to_numpy()):
        values = result["cost"].sel(contact=contact).to_numpy()
        bars = left.bar(np.arange(3) + 0.4 * number, values, 0.38, label=contact)
        left.bar_label(bars, [f"{value:.3g}" for value in values], fontsize=8)
    left.set(yscale="log", ylabel="ns per asperity and step", title="Paraboloids: the sum, one core")
    left.set_xticks(np.arange(3) + 0.2, ["roughmdr\n(both ways)", "NumPy\n(loading)", "scipy brentq\n(loading)"])
    left.legend(frameon=False)
    x = np.arange(result.sizes["shape"])
    for number, (name, label) in enumerate(_BARS.items()):
        values = result[name].to_numpy()
        bars = right.bar(x + 0.28 * number, values, 0.26, label=label)
        right.bar_label(bars, [f"{value:.3g}" for value in values], fontsize=7)
    right.set(yscale="log", title="Other shapes with JKR: force, radius and stiffness")
    right.set_xticks(x + 0.28, [str(shape).replace("_", "\n") for shape in result["shape"].to_numpy()])
    right.set_ylim(top=50.0 * float(result["state_time_brentq"].max()))
    right.legend(frameon=False, ncols=3, loc="upper left")
    return figure


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""

    def rows(over: str, names: list[str]) -> str:
        head = [over, *(f"{name} [{result[name].attrs['units']}]" for name in names)]
        columns = [result[over].to_numpy(), *(result[name].to_numpy() for name in names)]
        return table(head, [[f"{key}", *(f"{each:.4g}" for each in row)] for key, *row in zip(*columns, strict=True)])

    ups = zip(result.pool.to_numpy(), result.speed_up.median("repeat").to_numpy(), strict=True)
    costs = [[f"{each:.3g}" for each in row] for row in result.cost.to_numpy()]
    names = zip(result.contact.to_numpy(), costs, strict=True)
    return "\n\n".join(
        [
            table(["cost [ns]", *result.method.to_numpy()], [[str(name), *row] for name, row in names]),
            rows("shape", ["state_time", "asperity_time", "path_time", "state_time_brentq", "profile_time"]),
            rows("tabor", ["dugdale_state_time", "dugdale_asperity_time", "dugdale_time"])
            + f"\n\nThese are {result.attrs['dugdale_asperities']} paraboloids, 200 steps each way.",
            f"Two workers are {', '.join(f'{each:.2f} times as fast on {pool}' for pool, each in ups)}. A sweep of "
            f"{result.attrs['cells']} small cells takes {1e3 * float(result.cell_overhead.sum()):.2f} ms a cell beside "
            f"its realisation. {result.attrs['asperities']} asperities take {float(result.large_time):.2f} s and "
            f"{float(result.large_memory) / 2**20:.0f} MB above them.",
        ]
    )
