"""What ``roughmdr plan`` foresees, beside what the runs then take: time and peak memory of five scenes.

    python pipelines/foreseen.py -o results/studies

Each scene is planned and run in processes of their own. Writes foreseen.nc and foreseen.png. Needs /proc.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import click
import numpy as np
import xarray as xr

from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf

_FORESEE = """
import sys
from roughmdr.batch.estimate import estimate
from roughmdr.batch.plan import make_plan
from roughmdr.scene import read
foreseen = estimate(make_plan(read(sys.argv[1], sys.argv[2:])), 2)
print(foreseen.seconds, foreseen.memory)
"""
_TAKE = """
import sys
from roughmdr.cli import main
changes = [part for change in sys.argv[2:] for part in ("--set", change)]
main(["run", sys.argv[1], "-o", sys.argv[1] + ".nc", "--quiet", "--fresh", *changes], standalone_mode=False)
with open("/proc/self/status") as status:
    print(next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmHWM")))
"""
FORESEEN = {
    "16 x 1000": [],
    "256 x 2000": ["batch.realizations=256", "asperities.count=2000"],
    "sweep": [
        *("batch.realizations=32", "asperities.count=2000", "sweep.adhesion.work=[0.01,0.02,0.05]"),
        "sweep.asperities.height.std={logspace=['0.1 um','10 um'],num=5}",
    ],
    "4 x 1e6": ["batch.realizations=4", "asperities.count=1000000"],
    "80000 steps": ["batch.realizations=64", "asperities.count=200", "path.separation.steps=40000"],
}


def _output(code: str, arguments: list[str]) -> str:
    done = subprocess.run([sys.executable, "-c", code, *arguments], check=True, capture_output=True, text=True)
    return done.stdout


def foreseen(names: list[str]) -> xr.Dataset:
    """Time and memory of a run of each scene as ``roughmdr plan`` foresees them, and as the run then takes them."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        subprocess.run([sys.executable, "-m", "roughmdr", "new", str(scene)], check=True, capture_output=True)
        for name in names:
            command = [str(scene), *FORESEEN[name]]
            plan = subprocess.run(
                [sys.executable, "-c", _FORESEE, *command], check=True, capture_output=True, text=True
            )
            started = time.perf_counter()
            run = subprocess.run([sys.executable, "-c", _TAKE, *command], check=True, capture_output=True, text=True)
            rows.append([*map(float, plan.stdout.split()), time.perf_counter() - started, float(run.stdout)])
    seconds, size, took, held = np.array(rows).T
    return xr.Dataset(
        {
            "time": (("scene", "of"), np.stack([seconds, took], axis=1), {"units": "s", "long_name": "time of a run"}),
            "memory": (("scene", "of"), np.stack([size, held], axis=1), {"units": "byte", "long_name": "peak memory"}),
        },
        coords={"scene": names, "of": ["plan", "run"]},
    )


def draw(result: xr.Dataset, path: Path) -> None:
    """Foreseen over taken, for time and memory; the band is a factor of two."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3.6), layout="constrained")
    ax = figure.subplots()
    at = np.arange(result.sizes["scene"])
    for shift, name in ((-0.1, "time"), (0.1, "memory")):
        ax.plot(at + shift, result[name].sel(of="plan") / result[name].sel(of="run"), "o", label=name)
    ax.axhspan(0.5, 2.0, color="0.9", zorder=0)
    ax.set(yscale="log", ylim=(0.3, 3.0), ylabel="foreseen over taken", title="roughmdr plan beside the run")
    ax.set_xticks(at, result["scene"].to_numpy())
    ax.legend(frameon=False)
    with replace_atomically(path) as temporary:
        figure.savefig(temporary, dpi=160, format="png")


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Only the smallest scene: seconds.")
def main(output: Path, quick: bool) -> None:
    """Measure, print, write foreseen.nc and foreseen.png."""
    output.mkdir(parents=True, exist_ok=True)
    result = foreseen(list(FORESEEN)[: 1 if quick else None])
    write_netcdf(Labelled.of(result), output / "foreseen.nc")
    draw(result, output / "foreseen.png")
    for scene in result["scene"].to_numpy():
        (planned, took), (size, held) = (result[name].sel(scene=scene).to_numpy() for name in ("time", "memory"))
        click.echo(
            f"{scene:<12} planned {planned:6.1f} s {size / 1e6:5.0f} MB, took {took:6.1f} s {held / 1e6:5.0f} MB"
        )


if __name__ == "__main__":
    main()
