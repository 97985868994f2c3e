"""What ``batch_measured.py`` measures in processes of their own: memory, and overheads that begin from nothing.

    python pipelines/batch_child.py cells|statistics|ensemble COUNT FOLDER

Prints one line of JSON. It loads no more than a run loads, since its memory is what is measured.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

from studies.peak import peak

from roughmdr.batch.compile import prepare_all
from roughmdr.batch.plan import Plan, make_plan, simulate_realization
from roughmdr.batch.resume.keys import keys_of
from roughmdr.batch.rounds import Rounds
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from roughmdr.storage.labelled import Labelled

ASPERITIES = 10
WORKS = 100
"""Values of the first swept key; the second one has as many as make the number of cells."""


def tiny(*, count: int = ASPERITIES, steps: int = 20, unload: bool = True, **sections: dict[str, Any]) -> Scene:
    """A scene of few asperities, or of more; other sections as they are given."""
    return read(
        {
            "title": "tiny",
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


def swept(cells: int) -> Scene:
    """So many tiny cells, by two keys."""
    works = min(WORKS, cells // 2)
    sweep = {
        "adhesion.work": {"linspace": [0.01, 0.1], "num": works},
        "asperities.radius": {"linspace": [1e-5, 1e-4], "num": cells // works},
    }
    return tiny(sweep=sweep)


def run_time(result: Labelled) -> float:
    """Seconds in the realisations of a result."""
    return float(result.variables["run_time"].values.sum())


def carried_out(plan: Plan, target: Path | None, workers: int) -> tuple[float, float]:
    """Seconds of a plan over threads, and those of them in its realisations."""
    started = time.perf_counter()
    result = execute(plan, target, workers=workers, quiet=True)
    return time.perf_counter() - started, run_time(result)


def cells(count: int, folder: Path) -> dict[str, float]:
    """Seconds of overhead of a sweep of so many tiny cells with one worker, by what they are spent on."""
    few = make_plan(swept(4), chunk=1)
    prepare_all(few, Rounds(few).begin())
    wall, inside = carried_out(few, folder / "few.nc", 1)
    loading = wall - inside
    started = time.perf_counter()
    scene = swept(count)
    was_read = time.perf_counter()
    plan = make_plan(scene)
    planned = time.perf_counter()
    keys_of(plan, "sampled")
    keys = time.perf_counter() - planned
    nowhere, inside = carried_out(plan, None, 1)
    to_file, inside_to_file = carried_out(plan, folder / "cells.nc", 1)
    return {
        "loading": loading,
        "reading": was_read - started,
        "planning": planned - was_read,
        "keys": keys,
        "tasks": nowhere - inside - keys,
        "file": (to_file - inside_to_file) - (nowhere - inside),
        "realisations": inside_to_file,
        "runs": len(plan.cells),
        "size": (folder / "cells.nc").stat().st_size,
    }


def statistics(count: int, folder: Path) -> dict[str, float]:
    """Seconds and peak bytes of so many tiny realisations of which statistics are kept."""
    scene = tiny(unload=False, output={"keep": "statistics"}, batch={"realizations": count})
    plan = make_plan(scene)
    prepare_all(plan, Rounds(plan).begin())
    before = peak()
    wall, inside = carried_out(plan, folder / "statistics.nc", 1)
    return {"seconds": wall, "realisations": inside, "before": before, "peak": peak()}


def ensemble(count: int, _: Path) -> dict[str, float]:
    """Seconds of making and of visiting one ensemble, 200 steps in and out, and the bytes that they take."""
    plan = make_plan(tiny(count=count, steps=200))
    (scene, route), names = plan.cells[0], list(plan.scene.output.variables)
    simulate_realization(make_plan(tiny()).cells[0].scene, route, 0, names, "sampled")
    before = peak()
    started = time.perf_counter()
    scene.asperities.ensemble(scene.seed, 0)
    made = time.perf_counter()
    simulate_realization(scene, route, 0, names, "sampled")
    both = time.perf_counter() - made
    making = made - started
    return {"making": making, "visiting": both - making, "size": peak() - before}


if __name__ == "__main__":
    what, number, place = sys.argv[1:]
    print(json.dumps({"cells": cells, "statistics": statistics, "ensemble": ensemble}[what](int(number), Path(place))))
