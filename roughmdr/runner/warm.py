"""Compiles the functions that scenes need before they are run, by short runs in several processes."""

import time
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from roughmdr.batch.plan import make_plan
from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.cache import USED, VARIABLE, compiles, folders
from roughmdr.runner.backend import Backend
from roughmdr.runner.local import over_processes
from roughmdr.runner.progress import progress
from roughmdr.runner.run import execute
from roughmdr.runner.small_scenes import small_scenes
from roughmdr.scene import Scene, read

_STEPS = 8
"""Largest number of steps of a path, enough for contacts to be made and lost on the way."""
_Used = dict[str, Path | None]


class Warmed(NamedTuple):
    """Numbers of functions compiled, and found in each folder, and the time [s] it took."""

    compiled: int
    found: dict[Path, int]
    written: Path
    seconds: float


def warm(scenes: Sequence[Scene], workers: int, *, quiet: bool = True) -> Warmed:
    """Compile the functions that the scenes need; without any, those of each shape under each adhesion model.

    Of a scene each cell of a sweep is run, one realisation of it along few steps. StoreError where no folder can be
    written, RoughmdrError where nothing is compiled.
    """
    started = time.perf_counter()
    if not compiles():
        raise RoughmdrError("nothing is compiled where NUMBA_DISABLE_JIT is set")
    if (written := folders().written) is None:
        raise StoreError(f"compiled code cannot be kept: no folder can be written; name one in {VARIABLE}")
    small = [short for scene in scenes for short in _shortened(scene)] or list(map(read, small_scenes()))
    used: _Used = {}
    with progress("compiling", quiet=quiet) as display:
        display.add(total=len(small))
        for _, of_scene in over_processes(_run, small, min(workers, len(small))):
            used |= {name: folder for name, folder in of_scene.items() if used.get(name, name) is not None}
            display.add(done=1)
    found = Counter(folder for folder in used.values() if folder is not None)
    return Warmed(sum(folder is None for folder in used.values()), dict(found), written, time.perf_counter() - started)


def _shortened(scene: Scene) -> Iterator[Scene]:
    """Yield a scene with one realisation and few steps, for each estimator that it may take."""
    for estimator in scene.estimators:
        yield read(scene, amend=partial(_shorten, estimator=estimator))


def _shorten(table: dict[str, Any], estimator: str) -> None:
    """Change the table of a scene."""
    table.pop("accuracy", None)
    table["batch"] = {"estimator": estimator, "realizations": 1}
    path = table["path"]
    for section in (path, *path.values()):
        if isinstance(section, dict) and isinstance(section.get("steps"), int):
            section["steps"] = min(section["steps"], _STEPS)
    if any(key.startswith("preload") for key in path):
        path["steps"] = min(path.get("steps", _STEPS), _STEPS)


def _run(scene: Scene) -> _Used:
    """Run a scene and return the functions that were used for it."""
    USED.clear()
    try:
        execute(make_plan(scene), None, Backend(workers=1))
    except RoughmdrError as error:
        raise RoughmdrError(f"{scene.title}: {error}") from None
    return dict(USED)
