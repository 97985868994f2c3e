"""Compiles the functions that scenes need before they are run, by short runs in several processes.

Without scenes small ones together compile all that runs need: each shape under each adhesion model, and each section.
"""

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
from roughmdr.scene import Scene, read
from roughmdr.shapes import SCENE_SHAPES
from roughmdr.stages import STAGES

_STEPS = 6
"""Number of steps of a path, enough for contacts to be made and lost on the way."""
_PARAMETERS = {
    "radius": "50 um",
    "cap_radius": "90 um",
    "edge_radius": "20 um",
    "flat_radius": "2 um",
    "blend_radius": "2 um",
    "slope": 0.1,
    "exponent": 3,
    "width": "10 um",
    "rise": "1 um",
    "terms": {"2": 1e4, "4": 1e14},
    "r": [0, "5 um", "20 um"],
    "f": [0, "0.2 um", "3 um"],
}
"""Parameters of shapes of some 10 um."""
_OTHER_KEYS = {"power_law": ("exponent", "width", "rise"), "power_series": ("terms",), "tabulated": ("r", "f")}
_ADHESION: dict[str, dict[str, Any]] = {
    "none": {},
    "jkr": {"adhesion": {"model": "jkr", "work": "10 mJ/m^2"}},
    "dugdale": {"adhesion": {"model": "dugdale", "work": "10 mJ/m^2", "range": "20 nm"}},
}
_HILLS = {"source": "spectrum", "patch": "60 um", "hurst": 0.8, "long_wave": "30 um", "short_wave": "10 um"}
_SEPARATION = {"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": _STEPS}}
_PAIRS = {"model": "pairwise", "boundary": "periodic"}
_SECTIONS: dict[str, dict[str, Any]] = {
    "pairs, periodic": {"interaction": _PAIRS},
    "pairs, free": {"interaction": {**_PAIRS, "boundary": "free"}},
    "adhesive pairs": {"interaction": _PAIRS, **_ADHESION["jkr"]},
    "mean field": {"interaction": {"model": "mean_field"}},
    **{stage.key: dict(stage.small_scene) for stage in STAGES},
    "summits": {"asperities": {"source": "nayak", "patch": "1 mm", "m0": "1 um^2", "m2": 1e-2, "m4": "2e8 m^-2"}},
    "hills": {"asperities": {**_HILLS, "rms_slope": 0.05}},
}
"""Sections of scenes that compile more than shapes and adhesion do."""
_MOST_STEPS = 8
"""Largest number of steps of a path, enough for contacts to be made and lost on the way."""
_Used = dict[str, Path | None]


def small_scenes() -> Iterator[dict[str, Any]]:
    """Yield the scenes; those that share most code follow each other."""
    for model, section in _ADHESION.items():
        for shape in SCENE_SHAPES:
            yield from _along_paths(f"{shape}, {model}", {**section, "asperities": _asperities(shape)})
        table = {**_HILLS, "rms_slope": 0.05, "shape": "mdr_table"}
        yield from _along_paths(f"mdr_table, {model}", {**section, "asperities": table})
    for name, sections in _SECTIONS.items():
        yield _scene(name, sections)
    metal, yielding = {"modulus": "1 GPa", "poisson": 0.3}, _SECTIONS["plasticity"]
    for shape in ("cone", "flat_punch"):
        yield _scene(f"plasticity, {shape}", {**yielding, "material": metal, "asperities": _asperities(shape)})


def _along_paths(title: str, sections: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield scenes of a shape and an adhesion model along separations and under machines, and its expected law."""
    separation = {**_SEPARATION, "unload": True}
    output = {"variables": ["force", "contact_area", "contact_count", "stiffness", "energy"]}
    yield _scene(title, {**sections, "path": separation, "output": output})
    yield _scene(f"{title}, force", {**sections, "path": {"force": {"stop": "1 uN", "steps": _STEPS}, "unload": True}})
    remote = {"start": "2 sigma", "stop": "1 sigma", "steps": _STEPS}
    spring = {"remote": remote, "machine_stiffness": "1 kN/m", "unload": True}
    yield _scene(f"{title}, spring", {**sections, "path": spring})
    if sections["asperities"]["source"] == "random":
        yield _scene(f"{title}, expected", {**sections, "path": separation, "batch": {"estimator": "expected"}})


def _asperities(shape: str) -> dict[str, Any]:
    keys = _OTHER_KEYS.get(shape) or tuple(SCENE_SHAPES[shape].units)
    height = {"distribution": "normal", "std": "1 um"}
    table = {"source": "random", "shape": shape, "count": 20, "patch": "1 mm", "height": height}
    return table | {key: _PARAMETERS[key] for key in keys}


def _scene(title: str, sections: dict[str, Any]) -> dict[str, Any]:
    usual = {"material": {"effective_modulus": "1 GPa"}, "asperities": _asperities("paraboloid"), "path": _SEPARATION}
    return {"title": title, "seed": 1, **usual, **sections}


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
            section["steps"] = min(section["steps"], _MOST_STEPS)
    if any(key.startswith("preload") for key in path):
        path["steps"] = min(path.get("steps", _MOST_STEPS), _MOST_STEPS)


def _run(scene: Scene) -> _Used:
    """Run a scene and return the functions that were used for it."""
    USED.clear()
    try:
        execute(make_plan(scene), None, Backend(workers=1))
    except RoughmdrError as error:
        raise RoughmdrError(f"{scene.title}: {error}") from None
    return dict(USED)
