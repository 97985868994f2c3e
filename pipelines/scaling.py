"""What the sum costs: time a visited asperity and step, beside NumPy and SciPy; two workers; a million.

    python pipelines/scaling.py -o results/studies

All figures come from one run, since ratios hold where times drift. Writes scaling.nc and scaling.png.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import numpy as np
import xarray as xr
from scipy.optimize import brentq

import roughmdr as rm
from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.staircase import no_memory, staircase
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.laws import choose
from roughmdr.labelled import Labelled
from roughmdr.plan import make_plan
from roughmdr.runner import execute
from roughmdr.scene import read
from roughmdr.shapes import SHAPES as KINDS
from roughmdr.shapes import Shape
from roughmdr.store import replacing, write

MODULUS, WORK = 4e6, 0.05
ROWS = frozenset({totals.FORCE, totals.AREA, totals.COUNT, totals.STIFFNESS, totals.ERROR})
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
SECTION: dict[str, Any] = {
    "source": "random",
    "shape": "paraboloid",
    "patch": "1 mm",
    "height": {"distribution": "normal", "std": "1 um"},
    "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
}
PATH = {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 200}, "unload": True}


def ensemble_of(count: int) -> Ensemble:
    """The asperities that every figure here is measured on."""
    return Ensemble.from_dataset(rm.generate({**SECTION, "count": count}, seed=1))


def per_visit(action: Callable[[], int], repeats: int) -> float:
    """The shortest wall time of ``action`` over the visits that it returns [ns]."""
    times, visits = [], 1
    for _ in range(repeats):
        started = time.perf_counter()
        visits = action()
        times.append(time.perf_counter() - started)
    return min(times) / visits * 1e9


def by_the_sum(ensemble: Ensemble, path: np.ndarray, work: float, repeats: int, rows: frozenset[int] = ROWS) -> float:
    """Nanoseconds per visit of the package's sum, all included."""
    columns = ensemble.columns()
    law = choose(ensemble.shape, work, columns[2])
    memory = staircase(path) if work else no_memory(path)

    def action() -> int:
        _, _, visits = loop.add_asperities(law, ensemble.height, columns, MODULUS, work, path, memory, set(rows))
        return visits

    action()
    return per_visit(action, repeats)


def by_numpy(ensemble: Ensemble, path: np.ndarray, work: float) -> float:
    """The same with vectors, as most would write it: loading only, JKR by six Newton steps on t^4 - t = delta/d0."""
    height, radius = ensemble.height, ensemble.parameters["radius"]

    def action() -> int:
        visits = 0
        for h in path:
            touching = height > h
            delta, R = height[touching] - h, radius[touching]
            visits += delta.size
            if work:
                a0 = np.cbrt(2.0 * np.pi * work * R * R / MODULUS)
                d0 = a0 * a0 / R
                t = 1.0 + np.sqrt(np.sqrt(delta / d0))
                for _ in range(6):
                    t -= (t**4 - t - delta / d0) / (4.0 * t**3 - 1.0)
                a = a0 * t * t
                force = 2.0 * MODULUS * a0 * d0 * (2.0 / 3.0 * t**6 - t**3)
                stiffness = 2.0 * MODULUS * a * (4.0 * t**3 - 3.0) / (4.0 * t**3 - 1.0)
            else:
                a = np.sqrt(R * delta)
                force, stiffness = 4.0 / 3.0 * MODULUS * a * delta, 2.0 * MODULUS * a
            np.array([force.sum(), np.pi * (a * a).sum(), delta.size, stiffness.sum()])
        return visits

    return per_visit(action, 1)


def by_brentq(ensemble: Ensemble, path: np.ndarray, work: float) -> float:
    """The same with a root finder for each contact: loading only, a few hundred asperities."""
    height, radius = ensemble.height[:300], ensemble.parameters["radius"][:300]

    def indentation(a: float, R: float, delta: float) -> float:
        return float(a * a / R - np.sqrt(2.0 * np.pi * a * work / MODULUS) - delta)

    def action() -> int:
        visits, force = 0, 0.0
        for h in path:
            for z, R in zip(height[height > h], radius[height > h], strict=True):
                fold = np.cbrt(np.pi * work * R * R / (8.0 * MODULUS))
                a = brentq(indentation, fold, fold + 2.0 * np.sqrt(R * (z - h)) + 8.0 * fold, args=(R, z - h))
                force += 4.0 * MODULUS * a**3 / (3.0 * R) - np.sqrt(8.0 * np.pi * work * MODULUS * a**3)
                visits += 1
        return visits

    return per_visit(action, 1)


def by_shape(count: int, repeats: int) -> xr.Dataset:
    """Nanoseconds per delta -> (P, a, k) with JKR, in and out, 200 steps each way; set-up; and brentq for the same."""
    kept = {name: value for name, value in SECTION.items() if name != "radius"}
    way_in = np.linspace(4e-6, -0.5e-6, 200)
    both = np.concatenate([way_in, way_in[::-1]])
    columns: dict[str, list[float]] = {"ours": [], "brentq": [], "set_up": []}
    for shape, parameters in SHAPES.items():
        section = {**kept, "count": count, "shape": shape, **parameters}
        ensemble = Ensemble.from_dataset(rm.generate(section, seed=1))
        started = time.perf_counter()
        ensemble.columns()  # for a table: its pieces
        columns["set_up"].append(time.perf_counter() - started)
        columns["ours"].append(by_the_sum(ensemble, both, WORK, repeats, STATE))
        columns["brentq"].append(by_brentq_on(ensemble))
    ns = {"units": "ns", "long_name": "time per asperity and step"}
    return xr.Dataset(
        {
            "state_time": ("shape", columns["ours"], ns),
            "state_time_brentq": ("shape", columns["brentq"], ns),
            "set_up_time": ("shape", columns["set_up"], {"units": "s", "long_name": "time of the set-up of a profile"}),
        },
        coords={"shape": list(SHAPES)},
    )


def by_brentq_on(ensemble: Ensemble) -> float:
    """A root finder on delta = g(a) - dl(a), for a few hundred contacts of the first asperity."""
    first = {name: float(column[0]) for name, column in ensemble.parameters.items()}
    shape: Shape = ensemble.fixed or KINDS[ensemble.shape](**first)
    fold = float(rm.pull_off(shape, modulus=MODULUS, work=WORK).contact_radius)
    g = shape.g

    def indentation(a: float, delta: float) -> float:
        return float(g(a) - np.sqrt(2.0 * np.pi * a * WORK / MODULUS) - delta)

    top = 0.999999 * shape.end if shape.name == "sphere" else 1e3 * fold

    def action() -> int:
        deltas = np.linspace(1e-8, 1e-6, 200)
        for delta in deltas:
            brentq(indentation, fold, top, args=(delta,), xtol=1e-15 * fold)
        return int(deltas.size)

    return per_visit(action, 1)


def over_workers(count: int, realizations: int, repeats: int) -> dict[int, float]:
    """Seconds of a batch for one and two workers, taken in turn; the median of the repeats."""
    scene = read(
        {
            "material": {"effective_modulus": MODULUS},
            "adhesion": {"model": "jkr", "work": WORK},
            "asperities": {**SECTION, "count": count},
            "path": PATH,
            "batch": {"realizations": realizations},
        }
    )
    plan = make_plan(scene)
    execute(plan, None, workers=1, quiet=True)
    times: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(repeats):
        for workers, seconds in times.items():
            started = time.perf_counter()
            execute(plan, None, workers=workers, quiet=True)
            seconds.append(time.perf_counter() - started)
    return {workers: float(np.median(seconds)) for workers, seconds in times.items()}


_MILLION = """
import sys, time
import numpy as np, xarray as xr, roughmdr as rm

def resident(key):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith(key))

with xr.open_dataset(sys.argv[1]) as file:
    ensemble = file.load()
path = np.linspace(4e-6, -0.5e-6, 200)
law = dict(separation=path, modulus=float(sys.argv[2]), work=float(sys.argv[3]), unload=True)
rm.load_separation(ensemble.isel(asperity=slice(0, 1000)), **law)
with open("/proc/self/clear_refs", "w") as reset:
    reset.write("5")
before = resident("VmRSS")
started = time.perf_counter()
rm.load_separation(ensemble, **law)
print(time.perf_counter() - started, resident("VmHWM") - before)
"""


def million(count: int) -> tuple[float, float]:
    """Seconds and bytes above the ensemble of rm.load_separation for ``count`` asperities, in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "ensemble.nc"
        rm.generate({**SECTION, "count": count}, seed=1).to_netcdf(file)
        command = [sys.executable, "-c", _MILLION, str(file), str(MODULUS), str(WORK)]
        seconds, size = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return float(seconds), float(size)


def study(quick: bool) -> xr.Dataset:
    """All figures; ``quick`` on small ensembles, for a look that takes seconds."""
    count, repeats = (20_000, 1) if quick else (1_000_000, 3)
    ensemble = ensemble_of(count)
    way_in = np.linspace(4e-6, -0.5e-6, 200)
    both = np.concatenate([way_in, way_in[::-1]])
    small = ensemble_of(count // 10)
    cost = np.array(
        [
            [by_the_sum(ensemble, both, work, repeats), by_numpy(small, way_in, work), by_brentq(small, way_in, work)]
            for work in (0.0, WORK)
        ]
    )
    workers = over_workers(count // 10, 16, repeats)
    seconds, size = million(count)
    ns = {"units": "ns", "long_name": "time per visited asperity and step"}
    return (
        by_shape(count // 50, repeats)
        .assign(
            {
                "cost": (("contact", "method"), cost, ns),
                "batch_time": ("workers", list(workers.values()), {"units": "s", "long_name": "time of a batch"}),
                "large_time": ((), seconds, {"units": "s", "long_name": "one ensemble, 200 steps in and out, JKR"}),
                "large_memory": ((), size, {"units": "byte", "long_name": "peak memory above the ensemble"}),
                "contact": ["Hertz", "JKR"],
                "method": ["roughmdr", "numpy", "brentq"],
                "workers": list(workers),
            }
        )
        .assign_attrs(title="What the sum costs", asperities=count)
    )


def draw(result: xr.Dataset, path: Path) -> None:
    """Bars of time per visit, on a logarithmic axis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3.6), layout="constrained")
    ax = figure.subplots()
    for row, contact in enumerate(result["contact"].to_numpy()):
        values = result["cost"].sel(contact=contact).to_numpy()
        bars = ax.bar(np.arange(3) + 0.4 * row, values, 0.38, label=contact)
        ax.bar_label(bars, [f"{value:.3g}" for value in values], fontsize=8)
    ax.set(yscale="log", ylabel="ns per asperity and step", title="Sum over asperities, one core")
    ax.set_xticks(np.arange(3) + 0.2, ["roughmdr\n(in and out)", "NumPy\n(in only)", "scipy brentq\n(in only)"])
    ax.legend(frameon=False)
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=160, format="png")


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Small ensembles: seconds, and rough figures.")
def main(output: Path, quick: bool) -> None:
    """Measure, print, write scaling.nc and scaling.png."""
    output.mkdir(parents=True, exist_ok=True)
    result = study(quick)
    write(Labelled.of(result), output / "scaling.nc")
    draw(result, output / "scaling.png")
    click.echo(result["cost"].to_pandas().round(2).to_string())
    names = ["state_time", "state_time_brentq", "set_up_time"]
    click.echo(result[names].to_dataframe()[names].round(3).to_string())
    one, two = result["batch_time"].to_numpy()
    click.echo(f"a batch: {one:.2f} s with one worker, {two:.2f} s with two: {one / two:.2f} times")
    size = float(result["large_memory"]) / 2**20
    count, seconds = result.attrs["asperities"], float(result["large_time"])
    click.echo(f"{count} asperities, in and out: {seconds:.2f} s, {size:.0f} MB above them")


if __name__ == "__main__":
    main()
