"""Measurements in processes of their own: memory, and overheads from a cold start.

It imports no more than a run does, since its memory is what is measured.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.realization import simulate_realization
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import prepare_all
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from roughmdr.storage.memory import peak_memory

WORKS = 100  # values of the first swept key; the second one has as many as make the number of cells
_CODE = "import json, sys; from {0} import {1}; print(); print(json.dumps({1}(*json.loads(sys.argv[1]))))"
HEIGHT = {"distribution": "normal", "std": "1 um"}


def in_new_process(function: Callable[..., Any], *arguments: Any, **environment: str) -> Any:
    """Call a function of a module in a process that loads nothing else; arguments and result pass as JSON."""
    code = _CODE.format(function.__module__, function.__name__)
    command, settings = [sys.executable, "-c", code, json.dumps(arguments)], os.environ | environment
    folder = Path(__file__).parents[1]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=settings)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])


def small_scene(*, count: int = 10, steps: int = 20, unload: bool = True, **sections: dict[str, Any]) -> Scene:
    """Return a scene of few asperities; other sections as they are given."""
    random = {"source": "random", "shape": "paraboloid", "count": count, "patch": "1 m"}
    scene = {
        "title": "small",
        "seed": 1,
        "material": {"effective_modulus": 1e6},
        "adhesion": {"model": "jkr", "work": 0.05},
        "asperities": {**random, "height": HEIGHT, "radius": "50 um"},
        "path": {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": steps}, "unload": unload},
    }
    return read({**scene, **sections})


def sweep_of(cells: int) -> Scene:
    """Return a sweep of small cells over two keys."""
    works = min(WORKS, cells // 2)
    radii = {"linspace": [1e-5, 1e-4], "num": cells // works}
    return small_scene(sweep={"adhesion.work": {"linspace": [0.01, 0.1], "num": works}, "asperities.radius": radii})


def compiled_plan(scene: Scene) -> Plan:
    """Return the plan of a scene whose kernels are compiled."""
    plan = make_plan(scene)
    prepare_all(plan, Rounds(plan).begin())
    return plan


def _timed(plan: Plan) -> tuple[float, float]:
    """Return the seconds of a plan on one thread, and how many of them are spent in its realisations."""
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        result = execute(plan, Path(folder, "result.nc"), Backend(workers=1), quiet=True)
        return time.perf_counter() - started, float(result.variables["run_time"].values.sum())


def _cost_of(action: Callable[[], object]) -> tuple[float, float]:
    """Return the time [s] of an action, and the most memory [byte] that it takes above what is taken before."""
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before, started = peak_memory(), time.perf_counter()
    action()
    return time.perf_counter() - started, peak_memory() - before


def cells(count: int) -> dict[str, float]:
    """Measure the time [s] of a sweep of small cells with one worker, by what it is spent on."""
    started = time.perf_counter()
    scene = sweep_of(count)
    read_at = time.perf_counter()
    plan = make_plan(scene)
    planned_at = time.perf_counter()
    total, inside = _timed(plan)
    times = {"reading": read_at - started, "planning": planned_at - read_at, "running": total - inside}
    return {**times, "realisations": inside, "runs": len(plan.cells)}


def statistics(count: int) -> dict[str, float]:
    """Measure the time [s] and the peak memory [byte] of small realisations of which statistics are kept."""
    plan = compiled_plan(small_scene(unload=False, output={"keep": "statistics"}, batch={"realizations": count}))
    before = peak_memory()
    seconds, _ = _timed(plan)
    return {"statistics_time": seconds, "memory_before": before, "peak_memory": peak_memory()}


def ensemble(count: int) -> dict[str, float]:
    """Measure the time [s] to draw and to visit an asperity, 200 steps each way, and the memory [byte] it takes."""
    scene, path, *_ = make_plan(small_scene(count=count, steps=200)).cells[0]
    names = list(scene.output.variables)
    simulate_realization(small_scene(), path, 0, names, "sampled")
    whole, memory = _cost_of(lambda: simulate_realization(scene, path, 0, names, "sampled"))
    drawing, _ = _cost_of(lambda: scene.asperities.ensemble(scene.seed, 0))
    return {"drawing_time": drawing / count, "visiting_time": (whole - drawing) / count,
            "asperity_memory": memory / count}  # fmt: skip


def load_separation(section: dict[str, Any], path: list[float], arguments: dict[str, Any]) -> tuple[float, float]:
    """Measure the time [s] of rm.load_separation, and its memory [byte] above that of the ensemble."""
    import roughmdr as rm

    asperities = rm.generate(section, seed=1)
    rm.load_separation(asperities.isel(asperity=slice(0, 1000)), separation=path, **arguments)
    return _cost_of(lambda: rm.load_separation(asperities, separation=path, **arguments))


def run_command(arguments: list[str]) -> float:
    """Run a command of roughmdr and return its peak memory [byte]."""
    from roughmdr.cli import main

    main(arguments, standalone_mode=False)
    return peak_memory()
