"""Time and peak memory of five scenes as ``roughmdr plan`` foresees them, against those of the runs.

Each scene is run in a process of its own. Needs /proc.
"""

import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr
from studies.study import Figure, Study, blank, named

import roughmdr
from benchmarks.batch import tables
from benchmarks.child import run_command
from benchmarks.process import in_new_process
from roughmdr.batch.estimate import estimate
from roughmdr.batch.plan import make_plan
from roughmdr.scene import read

SCENES = {
    "16 x 1000": [],
    "256 x 2000": ["batch.realizations=256", "asperities.count=2000"],
    "sweep": ["batch.realizations=32", "asperities.count=2000", "sweep.adhesion.work=[0.01,0.02,0.05]",
              "sweep.asperities.height.std={logspace=['0.1 um','10 um'],num=5}"],
    "4 x 1e6": ["batch.realizations=4", "asperities.count=1000000", "asperities.patch='100 mm'"],
    "80000 steps": ["batch.realizations=64", "asperities.count=200", "path.separation.steps=40000"],
}  # fmt: skip
"""Changes of the starter scene."""
_STARTER = Path(roughmdr.__file__).with_name("starter.toml")


def measure(quick: bool) -> xr.Dataset:
    """Return time and memory of each scene, planned and run; ``quick`` the first alone."""
    names, rows = list(SCENES)[: 1 if quick else None], []
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            planned = estimate(make_plan(read(_STARTER, SCENES[name])), 2)
            changes = [part for change in SCENES[name] for part in ("--set", change)]
            command = ["run", str(_STARTER), "-o", f"{folder}/result.nc", "--quiet", "--fresh", *changes]
            started = time.perf_counter()
            size = in_new_process(run_command, command)
            rows.append([[planned.seconds, time.perf_counter() - started], [planned.memory, float(size)]])
    seconds, memory = np.moveaxis(np.array(rows), 1, 0)
    return xr.Dataset(
        {
            "time": (("scene", "of"), seconds, named("time of a run", "s")),
            "memory": (("scene", "of"), memory, named("peak memory", "byte")),
        },
        {"scene": names, "of": ["plan", "run"]},
    )


def draw(result: xr.Dataset) -> Figure:
    """Draw the foreseen over the measured, for time and memory; the band is a factor of two."""
    figure = blank(7, 3.6)
    panel = figure.subplots()
    x = np.arange(result.sizes["scene"])
    for shift, name in ((-0.1, "time"), (0.1, "memory")):
        panel.plot(x + shift, result[name].sel(of="plan") / result[name].sel(of="run"), "o", label=name)
    panel.axhspan(0.5, 2.0, color="0.9", zorder=0)
    panel.set(yscale="log", ylim=(0.3, 3.0), ylabel="foreseen over taken", title="roughmdr plan beside the run")
    panel.set_xticks(x, result["scene"].to_numpy())
    panel.legend(frameon=False)
    return figure


STUDY = Study("foreseen", "What roughmdr plan foresees", measure, draw, tables, f"1 of {len(SCENES)} scenes")
