"""Count what a scene calls and keeps with a part that it does not need left out, and with that part forced on.

Calls are counted where nothing is compiled, in a process with NUMBA_DISABLE_JIT=1, so that each of them is seen.
"""

import sys
from types import FrameType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from benchmarks.process import in_new_process
from studies.study import named

from roughmdr.aggregate import LoadingPath, compute
from roughmdr.aggregate.contacts import update_contact
from roughmdr.aggregate.totals import jumps, jumps_between_branches
from roughmdr.batch.plan import make_plan
from roughmdr.ensemble.streams import uniforms
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.staircase import staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from roughmdr.variables import CURVE_VARIABLES, DEFAULT_VARIABLES

SCENES: dict[str, dict[str, Any]] = {
    "loading": {"unload": False},
    "loading and unloading": {"unload": True},
    "loading and unloading, JKR": {"unload": True, "adhesive": True},
}
_SLIGHT = 1e-26  # [J/m2], so little that JKR is Hertz to the digits that are stated
_MEMORY = {
    getattr(each, "py_func", each).__code__ for each in (update_contact, jumps, jumps_between_branches, staircase)
}
"""What only adhesive contacts need: they depend on the path."""
CALLS, ADHESIVE, RANDOM, VISITS, KEPT = (
    "kernel calls a visit",
    "calls for adhesion alone, a visit",
    "random numbers an asperity",
    "visits",
    "numbers kept",
)
COUNTED = {
    "adhesion": ADHESIVE,
    "range of adhesion": CALLS,
    "positions": RANDOM,
    "asperities out of contact": VISITS,
    "the other default variables": CALLS,
    "all other variables": CALLS,
    "curves of the realisations": KEPT,
}
"""What is counted of each part."""
PARTS = tuple(COUNTED)


def scene_of(asperities: int, *, unload: bool, adhesive: bool = False, runs: int = 1, **output: object) -> Scene:
    """Return a scene of paraboloids of which only the force is asked; with adhesion, JKR is right and chosen."""
    return read(
        {
            "title": "What a scene does without",
            "seed": 3,
            "material": {"effective_modulus": "4 MPa"},
            **({"adhesion": {"model": "auto", "work": 0.05, "strength": "100 MPa"}} if adhesive else {}),
            "asperities": {
                "source": "random",
                "shape": "paraboloid",
                "count": asperities,
                "patch": "10 mm",
                "height": {"distribution": "normal", "std": "1 um"},
                "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
            },
            "path": {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 20}, "unload": unload},
            "output": {"variables": ["force"], **output},
            "batch": {"realizations": runs},
        }
    )


class Counts(NamedTuple):
    """The calls of one realisation of a scene, and its force."""

    counted: dict[str, float]
    force: list[float]
    error: float
    """``numerical_error`` of the force."""


def count(scene: Scene, path: LoadingPath | None = None, positions: bool = False, **changes: object) -> Counts:
    """Compute a scene as a run does, but for ``changes`` of the arguments, and count its calls."""
    arguments: dict[str, Any] = {
        "effective_modulus": scene.effective_modulus,
        "adhesion": scene.adhesion_model,
        "variables": tuple(scene.output.variables),
        **changes,
    }
    seen = dict.fromkeys((CALLS, ADHESIVE, RANDOM), 0)

    def see(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            module, code = frame.f_globals["__name__"], frame.f_code
            kernel = module.startswith("roughmdr.kernels.")
            seen[CALLS] += kernel
            seen[ADHESIVE] += code in _MEMORY or (kernel and ("jkr" in module or "dugdale" in module))
            seen[RANDOM] += frame.f_locals["count"] if code is uniforms.__code__ else 0

    sys.setprofile(see)
    try:
        ensemble = scene.asperities.ensemble(scene.seed, 0, with_positions=positions)
        found = compute(ensemble, path or make_plan(scene).cells[0].path, **arguments)
    finally:
        sys.setprofile(None)
    asperities = float(scene.asperities.expected_count)
    over = {CALLS: found.visits, ADHESIVE: found.visits, RANDOM: asperities}
    counted = {name: number / over[name] for name, number in seen.items()} | {VISITS: found.visits}
    return Counts(counted, found.variables["force"].tolist(), found.numerical_error)


Case = tuple[str, str, list[float], float, float]
"""Part, scene, what is counted left out and forced on, difference of the forces and that which their errors allow."""


def count_calls(asperities: int) -> list[Case]:
    """Count each part of each scene; to be called where nothing is compiled."""
    cases: list[Case] = []
    for name, options in SCENES.items():
        scene = scene_of(asperities, **options)
        separation = scene.path.separations(scene.asperities.sigma)
        path = LoadingPath.along(separation, unload=scene.path.unload, adhesive=True)
        forced: dict[str, dict[str, Any]] = {
            "adhesion": {"adhesion": Adhesion(_SLIGHT), "path": path},
            "range of adhesion": {"adhesion": scene.adhesion_model._replace(model="dugdale")},
            "positions": {"positions": True},
            "the other default variables": {"variables": DEFAULT_VARIABLES},
            "all other variables": {"variables": tuple(CURVE_VARIABLES)},
        }
        del forced["adhesion" if scene.work else "range of adhesion"]
        count(scene)  # loads what it needs
        plain = count(scene)
        for part, changes in forced.items():
            on = count(scene, **changes)
            off = float(np.abs(np.subtract(plain.force, on.force)).max() / np.abs(plain.force).max())
            both = [each.counted[COUNTED[part]] for each in (plain, on)]
            cases.append((part, name, both, off, plain.error + on.error))
        pairs = float(asperities * len(plain.force))  # of an asperity and a step
        cases.append(("asperities out of contact", name, [plain.counted[VISITS], pairs], 0.0, 0.0))
    return cases


def count_kept(asperities: int, runs: int) -> Case:
    """Count the numbers of a batch of which statistics are kept, or curves."""
    results = []
    for keep in ("statistics", "curves"):
        scene = scene_of(asperities, unload=False, runs=runs, keep=keep, variables=list(DEFAULT_VARIABLES))
        results.append(execute(make_plan(scene), None, Backend(workers=1), quiet=True).variables)
    counts = [sum(v.values.size for name, v in each.items() if name.startswith(DEFAULT_VARIABLES)) for each in results]
    means: list[Floats] = [results[0]["force_mean"].values, results[1]["force"].values.mean(axis=0)]
    stated = sum(float(each["numerical_error"].values.max()) for each in results)
    off = float(np.abs(means[1] - means[0]).max() / np.abs(means[0]).max())
    return "curves of the realisations", f"{runs} realisations", [float(each) for each in counts], off, stated


def measure(quick: bool) -> xr.Dataset:
    """Return all counts, a case for each scene and part."""
    cases = in_new_process(count_calls, 60 if quick else 400, NUMBA_DISABLE_JIT="1")
    cases.append(count_kept(20, 300 if quick else 3000))
    parts, scenes, counted, differences, stated = zip(
        *sorted(cases, key=lambda case: PARTS.index(case[0])), strict=True
    )
    return xr.Dataset(
        {
            "counted": (("case", "of"), np.array(counted), named("what is counted")),
            "difference": ("case", list(differences), named("difference of the forces over the largest")),
            "stated": ("case", list(stated), named("difference that the stated errors allow")),
        },
        {
            "of": ["left out", "forced on"],
            "part": ("case", list(parts)),
            "scene": ("case", list(scenes)),
            "unit": ("case", [COUNTED[part] for part in parts]),
        },
    )
