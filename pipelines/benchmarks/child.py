"""Measurements in processes of their own: memory, and overheads from a cold start.

It imports no more than a run does, since its memory is what is measured.
"""

import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.process import peak_memory
from roughmdr.batch.plan import Plan, make_plan, simulate_realization
from roughmdr.batch.resume.keys import keys_of
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import prepare_all
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read

WORKS = 100
"""Values of the first swept key; the second one has as many as make the number of cells."""


def small_scene(*, count: int = 10, steps: int = 20, unload: bool = True, **sections: dict[str, Any]) -> Scene:
    """Return a scene of few asperities; other sections as they are given."""
    return read(
        {
            "title": "small",
            "seed": 1,
            "material": {"effective_modulus": 1e6},
            "adhesion": {"model": "jkr", "work": 0.05},
            "asperities": {
                "source": "random",
                "shape": "paraboloid",
                "count": count,
                "patch": "1 mm",
                "height": {"distribution": "normal", "std": "1 um"},
                "radius": "50 um",
            },
            "path": {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": steps}, "unload": unload},
            **sections,
        }
    )


def sweep_of(cells: int) -> Scene:
    """Return a sweep of small cells over two keys."""
    works = min(WORKS, cells // 2)
    sweep = {
        "adhesion.work": {"linspace": [0.01, 0.1], "num": works},
        "asperities.radius": {"linspace": [1e-5, 1e-4], "num": cells // works},
    }
    return small_scene(sweep=sweep)


def compiled_plan(scene: Scene) -> Plan:
    """Return the plan of a scene whose kernels are compiled."""
    plan = make_plan(scene)
    prepare_all(plan, Rounds(plan).begin())
    return plan


def _timed(plan: Plan, target: Path | None, runs_per_task: int | None = None) -> tuple[float, float]:
    """Return the seconds of a plan on one thread, and how many of them are spent in its realisations."""
    started = time.perf_counter()
    result = execute(plan, target, Backend(workers=1, runs_per_task=runs_per_task), quiet=True)
    return time.perf_counter() - started, float(result.variables["run_time"].values.sum())


def cells(count: int) -> dict[str, float]:
    """Measure the overhead [s] of a sweep of small cells with one worker, by what it is spent on."""
    few = compiled_plan(sweep_of(4))
    with tempfile.TemporaryDirectory() as folder:
        total, inside = _timed(few, Path(folder, "few.nc"), 1)
        loading = total - inside
        started = time.perf_counter()
        scene = sweep_of(count)
        read_at = time.perf_counter()
        plan = make_plan(scene)
        planned_at = time.perf_counter()
        keys_of(plan, "sampled")
        keys = time.perf_counter() - planned_at
        total, inside = _timed(plan, None)
        total_to_file, inside_to_file = _timed(plan, Path(folder, "cells.nc"))
        size = Path(folder, "cells.nc").stat().st_size
    return {
        "loading": loading,
        "reading": read_at - started,
        "planning": planned_at - read_at,
        "keys": keys,
        "tasks": total - inside - keys,
        "file": (total_to_file - inside_to_file) - (total - inside),
        "realisations": inside_to_file,
        "runs": len(plan.cells),
        "size": size,
    }


def statistics(count: int) -> dict[str, float]:
    """Measure the time [s] and the peak memory [byte] of small realisations of which statistics are kept."""
    plan = compiled_plan(small_scene(unload=False, output={"keep": "statistics"}, batch={"realizations": count}))
    before = peak_memory()
    with tempfile.TemporaryDirectory() as folder:
        seconds, _ = _timed(plan, Path(folder, "statistics.nc"))
    return {"seconds": seconds, "before": before, "peak": peak_memory()}


def ensemble(count: int) -> dict[str, float]:
    """Measure the time [s] to draw and to visit one ensemble, 200 steps each way, and the memory [byte] it takes."""
    scene, path = make_plan(small_scene(count=count, steps=200)).cells[0]
    names = list(scene.output.variables)
    simulate_realization(small_scene(), path, 0, names, "sampled")
    before = peak_memory()
    started = time.perf_counter()
    scene.asperities.ensemble(scene.seed, 0)
    drawing = time.perf_counter() - started
    simulate_realization(scene, path, 0, names, "sampled")
    return {
        "drawing": drawing,
        "visiting": time.perf_counter() - started - 2.0 * drawing,
        "size": peak_memory() - before,
    }


def load_separation(file: str, effective_modulus: float, work: float) -> tuple[float, float]:
    """Measure the time [s] of rm.load_separation, 200 steps each way, and its memory [byte] above the ensemble's."""
    import numpy as np
    import xarray as xr

    import roughmdr as rm

    with xr.open_dataset(file) as stored:
        asperities = stored.load()
    arguments: dict[str, Any] = {
        "separation": np.linspace(4e-6, -0.5e-6, 200),
        "effective_modulus": effective_modulus,
        "work": work,
        "unload": True,
    }
    rm.load_separation(asperities.isel(asperity=slice(0, 1000)), **arguments)
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before = peak_memory()
    started = time.perf_counter()
    rm.load_separation(asperities, **arguments)
    return time.perf_counter() - started, peak_memory() - before


def run_command(arguments: list[str]) -> int:
    """Run a command of roughmdr and return its peak memory [byte]."""
    from roughmdr.cli import main

    main(arguments, standalone_mode=False)
    return peak_memory()
