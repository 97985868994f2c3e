"""What the sum costs: time a visited asperity and step, beside NumPy and SciPy; two workers; a million; a cell.

    python pipelines/scaling.py -o results/studies

All figures come from one run, since ratios hold where times drift. Writes scaling.nc and scaling.png.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import click
import numpy as np
import xarray as xr
from batch import by_cell
from oracles.plain_sums import Cost, by_brentq, by_brentq_on, by_numpy, cost_of

import roughmdr as rm
from roughmdr.aggregate import loop, totals
from roughmdr.batch.plan import make_plan
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading.staircase import no_memory, staircase
from roughmdr.runner.run import execute
from roughmdr.scene import read
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.store import replacing, write

MODULUS, WORK = 4e6, 0.05
TABOR = (0.1, 1.0, 10.0, 100.0)
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


def by_the_sum(
    ensemble: Ensemble, path: np.ndarray, adhesion: Adhesion, repeats: int, rows: frozenset[int] = ROWS
) -> Cost:
    """What the package's sum costs, all included."""
    columns = ensemble.columns()
    law = choose(ensemble.shape, adhesion, columns[2])
    memory = staircase(path) if adhesion.work else no_memory(path)

    def action() -> int:
        _, _, visits = loop.add_asperities(law, ensemble.height, columns, MODULUS, adhesion, path, memory, set(rows))
        return visits

    action()
    return cost_of(action, repeats)


def told_apart(ensemble: Ensemble, adhesion: Adhesion, repeats: int) -> tuple[float, float, Cost]:
    """Seconds of delta -> (P, a, k), seconds of what is found out about each asperity before, and all on 200 steps.

    In and out; the first two are told apart by paths of few steps and of many.
    """
    short, long = (
        by_the_sum(ensemble, np.concatenate([way_in, way_in[::-1]]), adhesion, repeats, STATE)
        for way_in in (np.linspace(4e-6, -0.5e-6, steps) for steps in (200, 2000))
    )
    each = (long.seconds - short.seconds) / (long.visits - short.visits)
    return each, (short.seconds - each * short.visits) / ensemble.height.size, short


def by_range(count: int, repeats: int) -> xr.Dataset:
    """What paraboloids cost under adhesion of finite range, by their Tabor number."""
    ensemble = ensemble_of(count)
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    told = [told_apart(ensemble, Adhesion(WORK, "dugdale", tabor / one), repeats) for tabor in TABOR]
    return xr.Dataset(
        {
            "dugdale_state_time": ("tabor", [1e9 * each for each, _, _ in told], ns("time per asperity and step")),
            "dugdale_asperity_time": ("tabor", [1e9 * before for _, before, _ in told], ns("time per asperity, once")),
            "dugdale_time": ("tabor", [path.seconds for _, _, path in told], {"units": "s", "long_name": "all of it"}),
        },
        coords={"tabor": ("tabor", list(TABOR), {"long_name": "Tabor number"})},
        attrs={"dugdale_asperities": count},
    )


def by_shape(count: int, repeats: int) -> xr.Dataset:
    """What delta -> (P, a, k) costs with JKR, in and out, and what is found out about each asperity before."""
    kept = {name: value for name, value in SECTION.items() if name != "radius"}
    rows = []
    for shape, parameters in SHAPES.items():
        section = {**kept, "count": count, "shape": shape, **parameters}
        ensemble = Ensemble.from_dataset(rm.generate(section, seed=1))
        started = time.perf_counter()
        ensemble.columns()  # for a table: its pieces
        profile = time.perf_counter() - started
        each, before, short = told_apart(ensemble, Adhesion(WORK), repeats)
        rows.append((each * 1e9, before * 1e9, short.each, profile, by_brentq_on(ensemble, MODULUS, WORK).each))
    each_ns, before_ns, path_ns, profile_s, brentq_ns = np.array(rows).T
    return xr.Dataset(
        {
            "state_time": ("shape", each_ns, ns("time per asperity and step")),
            "asperity_time": ("shape", before_ns, ns("time per asperity, once")),
            "path_time": ("shape", path_ns, ns("time per asperity and step over 200 steps in and out, all included")),
            "state_time_brentq": ("shape", brentq_ns, ns("time per asperity and step")),
            "profile_time": ("shape", profile_s, {"units": "s", "long_name": "time to set up the profiles"}),
        },
        coords={"shape": list(SHAPES)},
    )


def ns(name: str) -> dict[str, str]:
    """The attributes of a time in nanoseconds."""
    return {"units": "ns", "long_name": name}


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
            [
                by_the_sum(ensemble, both, Adhesion(work), repeats).each,
                by_numpy(small, way_in, MODULUS, work).each,
                by_brentq(small, way_in, MODULUS, work).each,
            ]
            for work in (0.0, WORK)
        ]
    )
    workers = over_workers(count // 10, 16, repeats)
    cells = by_cell(200 if quick else 10_000, repeats)
    seconds, size = million(count)
    return (
        xr.merge([by_shape(count // 50, repeats), by_range(count // 10, repeats), cells], combine_attrs="no_conflicts")
        .assign(
            {
                "cost": (("contact", "method"), cost, ns("time per visited asperity and step")),
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
    """Bars of time per visit, on logarithmic axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.8])
    for row, contact in enumerate(result["contact"].to_numpy()):
        values = result["cost"].sel(contact=contact).to_numpy()
        bars = left.bar(np.arange(3) + 0.4 * row, values, 0.38, label=contact)
        left.bar_label(bars, [f"{value:.3g}" for value in values], fontsize=8)
    left.set(yscale="log", ylabel="ns per asperity and step", title="Paraboloids: the sum, one core")
    left.set_xticks(np.arange(3) + 0.2, ["roughmdr\n(in and out)", "NumPy\n(in only)", "scipy brentq\n(in only)"])
    left.legend(frameon=False)
    places = np.arange(result.sizes["shape"])
    for row, (name, label) in enumerate(
        [
            ("state_time", "one more step"),
            ("path_time", "200 steps in and out, set-up included"),
            ("state_time_brentq", "scipy brentq"),
        ]
    ):
        values = result[name].to_numpy()
        bars = right.bar(places + 0.28 * row, values, 0.26, label=label)
        right.bar_label(bars, [f"{value:.3g}" for value in values], fontsize=7)
    right.set(yscale="log", title="Other shapes with JKR: force, radius and stiffness")
    right.set_xticks(places + 0.28, [str(shape).replace("_", "\n") for shape in result["shape"].to_numpy()])
    right.set_ylim(top=50.0 * float(result["state_time_brentq"].max()))
    right.legend(frameon=False, ncols=3, loc="upper left")
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
    names = ["state_time", "asperity_time", "path_time", "state_time_brentq", "profile_time"]
    click.echo(result[names].to_dataframe()[names].round(3).to_string())
    names = ["dugdale_state_time", "dugdale_asperity_time", "dugdale_time"]
    click.echo(f"{result.attrs['dugdale_asperities']} paraboloids under adhesion of finite range, 200 steps in and out")
    click.echo(result[names].to_dataframe()[names].round(2).to_string())
    one, two = result["batch_time"].to_numpy()
    click.echo(f"a batch: {one:.2f} s with one worker, {two:.2f} s with two: {one / two:.2f} times")
    cells, overhead = result.attrs["cells"], 1e3 * float(result["cell_overhead"].sum())
    click.echo(f"a sweep of {cells} tiny cells: {overhead:.2f} ms a cell beside its realisation")
    size = float(result["large_memory"]) / 2**20
    count, seconds = result.attrs["asperities"], float(result["large_time"])
    click.echo(f"{count} asperities, in and out: {seconds:.2f} s, {size:.0f} MB above them")


if __name__ == "__main__":
    main()
