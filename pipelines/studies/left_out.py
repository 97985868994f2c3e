"""Count what a scene calls and keeps with each part that it does not need left out, and with that part forced on.

Calls are counted in a process with NUMBA_DISABLE_JIT=1, where nothing is compiled, so that each of them is seen.
"""

import cProfile
from typing import Any
from unittest.mock import patch

import numpy as np
import xarray as xr
from benchmarks.child import in_new_process

from roughmdr.aggregate import LoadingPath, LoadSeparation, compute
from roughmdr.aggregate.contacts import update_contact
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.totals import jumps, jumps_between_branches
from roughmdr.batch.plan import make_plan
from roughmdr.ensemble import streams
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.staircase import staircase
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from roughmdr.variables import CURVE_VARIABLES, DEFAULT_VARIABLES
from studies.study import Study, named, table

SCENES: dict[str, dict[str, Any]] = {
    "loading": {"unload": False},
    "loading and unloading": {"unload": True},
    "loading and unloading, JKR": {"unload": True, "adhesive": True},
}
ASPERITIES, RUNS = {False: 400, True: 60}, {False: 3000, True: 300}
CALLS, ADHESIVE = "kernel calls a visit", "calls for adhesion alone, a visit"
RANDOM, VISITS = "random numbers an asperity", "visits"
PARTS = {
    "adhesion": ADHESIVE,
    "range of adhesion": CALLS,
    "positions": RANDOM,
    "asperities out of contact": VISITS,
    "the other default variables": CALLS,
    "all other variables": CALLS,
    "curves of the realisations": "numbers kept",
}
"""The parts that may be left out, and what is counted of each."""
_SLIGHT = 1e-26  # [J/m2], so little that JKR is Hertz to the digits that are stated
_MEMORY = [
    getattr(each, "py_func", each).__code__ for each in (update_contact, jumps, jumps_between_branches, staircase)
]
"""Code that only adhesive contacts need: they depend on the path."""

Case = tuple[str, str, list[float], float, float]
"""Part, scene, counts with the part left out and forced on, difference of the forces, difference their errors allow."""


def scene_of(asperities: int, *, unload: bool, adhesive: bool = False, runs: int = 1, **output: object) -> Scene:
    """Return a scene of paraboloids of which only the force is asked; with adhesion, JKR is right and chosen."""
    return read({
        "title": "What a scene does without",
        "seed": 3,
        "material": {"effective_modulus": "4 MPa"},
        **({"adhesion": {"model": "auto", "work": 0.05, "strength": "100 MPa"}} if adhesive else {}),
        "asperities": {
            "source": "random", "shape": "paraboloid", "count": asperities, "patch": "10 mm",
            "height": {"distribution": "normal", "std": "1 um"},
            "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
        },
        "path": {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 20}, "unload": unload},
        "output": {"variables": ["force"], **output},
        "batch": {"realizations": runs},
    })  # fmt: skip


def count(
    scene: Scene, path: LoadingPath | None = None, positions: bool = False, **changes: Any
) -> tuple[dict[str, float], LoadSeparation]:
    """Compute a realisation as a run does, but for ``changes`` of the arguments, and count what it calls and draws."""
    adhesion = changes.get("adhesion", scene.adhesion_model)
    variables = changes.get("variables", scene.output.variables)
    with patch.object(streams, "uniforms", wraps=streams.uniforms) as drawn, cProfile.Profile() as profile:
        ensemble = scene.asperities.ensemble(scene.seed, 0, with_positions=positions)
        problem = Problem(ensemble, scene.effective_modulus, adhesion)
        found = compute(problem, path or make_plan(scene).cells[0].path, variables)
    calls, for_adhesion = 0, 0
    for code, number, *_ in profile.getstats():
        if not isinstance(code, str):
            kernel = code.co_filename.partition("/roughmdr/kernels/")[2]
            calls += number if kernel else 0
            for_adhesion += number if code in _MEMORY or "jkr" in kernel or "dugdale" in kernel else 0
    numbers = sum(call.args[3] for call in drawn.call_args_list)
    over_visits = {CALLS: calls / found.visits, ADHESIVE: for_adhesion / found.visits}
    return {**over_visits, RANDOM: numbers / scene.asperities.expected_count, VISITS: float(found.visits)}, found


def count_calls(asperities: int) -> list[Case]:
    """Count each part of each scene; to be called where nothing is compiled."""
    cases: list[Case] = []
    for name, options in SCENES.items():
        scene = scene_of(asperities, **options)
        separation = make_plan(scene).cells[0].path.separation
        forced: dict[str, dict[str, Any]] = {
            "positions": {"positions": True},
            "the other default variables": {"variables": DEFAULT_VARIABLES},
            "all other variables": {"variables": CURVE_VARIABLES},
        }
        if scene.work:
            forced["range of adhesion"] = {"adhesion": scene.adhesion_model._replace(model="dugdale")}
        else:
            forced["adhesion"] = {"adhesion": Adhesion(_SLIGHT), "path": LoadingPath(separation, staircase(separation))}
        count(scene)  # loads what it needs
        plain, left_out = count(scene)
        for part, changes in forced.items():
            count(scene, **changes)  # loads what it needs
            counts, forced_on = count(scene, **changes)
            both = [each[PARTS[part]] for each in (plain, counts)]
            off = difference(left_out.variables["force"], forced_on.variables["force"])
            cases.append((part, name, both, off, left_out.numerical_error + forced_on.numerical_error))
        pairs = float(asperities * separation.size)  # of an asperity and a step
        cases.append(("asperities out of contact", name, [plain[VISITS], pairs], 0.0, 0.0))
    return cases


def difference(left_out: np.ndarray, forced_on: np.ndarray) -> float:
    """Return the largest difference of two forces, over the largest force."""
    return float(np.abs(forced_on - left_out).max() / np.abs(left_out).max())


def count_kept(asperities: int, runs: int) -> Case:
    """Count the numbers of a batch of which statistics are kept, or curves."""
    results = []
    for keep in ("statistics", "curves"):
        scene = scene_of(asperities, unload=False, runs=runs, keep=keep, variables=list(DEFAULT_VARIABLES))
        results.append(execute(make_plan(scene), None, Backend(workers=1), quiet=True).variables)
    counts = [sum(v.values.size for name, v in each.items() if name.startswith(DEFAULT_VARIABLES)) for each in results]
    off = difference(results[0]["force_mean"].values, results[1]["force"].values.mean(axis=0))
    stated = sum(float(each["numerical_error"].values.max()) for each in results)
    return "curves of the realisations", f"{runs} realisations", list(map(float, counts)), off, stated


def measure(quick: bool) -> xr.Dataset:
    """Return all counts, a case for each scene and part."""
    cases: list[Case] = in_new_process(count_calls, ASPERITIES[quick], NUMBA_DISABLE_JIT="1")
    cases.append(count_kept(20, RUNS[quick]))
    cases.sort(key=lambda case: list(PARTS).index(case[0]))
    parts, scenes, counted, differences, stated = map(list, zip(*cases, strict=True))
    return xr.Dataset(
        {
            "counted": (("case", "of"), counted, named("what is counted")),
            "difference": ("case", differences, named("difference of the forces over the largest")),
            "stated": ("case", stated, named("difference that the stated errors allow")),
        },
        {"of": ["left out", "forced on"], "part": ("case", parts), "scene": ("case", scenes)},
    )


def texts(result: xr.Dataset) -> list[list[str]]:
    """Return part, scene, count with the part left out, count with it forced on, and what is counted."""
    cases = zip(*(result[name].to_numpy().tolist() for name in ("part", "scene", "counted")), strict=True)
    return [
        [part, scene, *(f"{number:,.0f}" if number >= 100.0 else f"{number:.3g}" for number in counts), PARTS[part]]
        for part, scene, counts in cases
    ]


def report(result: xr.Dataset) -> str:
    """Return the table, and how far the forces are apart."""
    ranged = result.part == "range of adhesion"
    return f"""{table(["part", "scene", "left out", "forced on", "of"], texts(result))}

Forced on or left out, the forces are the same to {float(result.difference.where(~ranged).max()):.1g} of the largest.
JKR in place of adhesion with a range is off by {float(result.difference.where(ranged).max()):.1g}, of the 0.01 that the
scene allows.
"""


STUDY = Study(
    "left_out", "What leaving out saves", measure, {}, report,
    f"{ASPERITIES[True]} of {ASPERITIES[False]} asperities, {RUNS[True]} of {RUNS[False]} realisations",
)  # fmt: skip
