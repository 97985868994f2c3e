"""Time and peak memory of five scenes as ``roughmdr plan`` foresees them, against those of the runs.

Each scene is run in a process of its own. Needs /proc.
"""

import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr
from studies.study import Study, named

import roughmdr
from benchmarks.batch import tables
from benchmarks.child import in_new_process, run_command
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
            rows.append([[planned.seconds, time.perf_counter() - started], [planned.memory, size]])
    seconds, memory = np.moveaxis(np.array(rows), 1, 0)
    return xr.Dataset(
        {
            "time": (("scene", "of"), seconds, named("time of a run", "s")),
            "memory": (("scene", "of"), memory, named("peak memory", "byte")),
        },
        {"scene": names, "of": ["plan", "run"]},
    )


STUDY = Study("foreseen", "What roughmdr plan foresees", measure, {}, tables, f"1 of {len(SCENES)} scenes")
