"""Scenes drawn at random over all that a scene may ask for: each is refused in words, or physically right.

hypothesis draws the scenes, in two processes with seeds of their own; each is run in memory and judged: no NaN, no
infinite number, no exception but a refusal, force and area monotone where physics says so. A scene that fails is made
as small as it can be, and raised as TOML.
"""

import tempfile
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
import xarray as xr
from hypothesis import HealthCheck, Phase, given, seed, settings

from roughmdr.shapes import SCENE_SHAPES
from studies.comparison import of_rows
from studies.random_scenes.judge import OUTCOMES, Defect, judge
from studies.random_scenes.scenes import scenes, write_inputs
from studies.study import Study, in_two_processes, timed

SEEDS = (2026, 2027)  # one for each process
FULL, QUICK = 10_000, 300  # scenes in all
QUICK_COHESIVE = ("paraboloid", "flat_punch")  # other shapes take long to compile with adhesion of finite range
KINDS = ("shape", "adhesion", "source", "estimator")
_WORDS = {"comparisons": ("claims about numbers that held", "1"), "run_time": ("run time of a scene", "s")}


def kind_of(scene: dict[str, Any]) -> tuple[str, ...]:
    """Return the kind of a scene, as in ``KINDS``."""
    section = scene["asperities"]
    shape = Path(section["file"]).stem if section["source"] == "file" else section.get("shape", "paraboloid")
    estimator = "accuracy" if "accuracy" in scene else scene.get("batch", {}).get("estimator", "sampled")
    return shape, scene.get("adhesion", {"model": "none"})["model"], section["source"], estimator


def search(start: int, count: int, folder: Path, cohesive: tuple[str, ...]) -> list[dict[str, Any]]:
    """Judge ``count`` scenes: return kind, verdict and run time [s] of each.

    Raise Defect, with the smallest scene that shows it, where one is not right.
    """
    records = []
    phases, no_checks = (Phase.generate, Phase.shrink), list(HealthCheck)

    @seed(start)
    @settings(max_examples=count, deadline=None, database=None, phases=phases, suppress_health_check=no_checks)
    @given(scenes(folder, cohesive))
    def judged(scene: dict[str, Any]) -> None:
        try:
            verdict, seconds = timed(partial(judge, scene))
        except Defect as defect:
            defect.add_note(tomli_w.dumps(scene))
            raise
        records.append(dict(zip(KINDS, kind_of(scene), strict=True)) | verdict._asdict() | {"run_time": seconds})

    judged()
    return records


def measure(quick: bool) -> xr.Dataset:
    """Judge all scenes; return the kind of each, what became of it, and why it was refused if it was."""
    each, cohesive = (QUICK if quick else FULL) // len(SEEDS), QUICK_COHESIVE if quick else tuple(SCENE_SHAPES)
    with tempfile.TemporaryDirectory() as folder:
        write_inputs(Path(folder))
        search_part = partial(search, count=each, folder=Path(folder), cohesive=cohesive)
        return of_rows(_WORDS, [record for part in in_two_processes(search_part, SEEDS) for record in part], "scene")


def report(result: xr.Dataset) -> str:
    """Return how many scenes there were, and what became of them."""
    count, found = result.sizes["scene"], Counter(result.outcome.values)
    outcomes = ", ".join(f"{found[name]} ({100.0 * found[name] / count:.1f} %) {name}" for name in OUTCOMES)
    median, nearly_all, longest = np.quantile(result.run_time, (0.5, 0.99, 1.0))
    return f"""
{count} scenes drawn over all that a scene may ask for: {outcomes}. In none of them was there a NaN, an infinite number,
or an exception that is no refusal, and {int(result.comparisons.sum())} claims about their numbers all held.
Half of the scenes take up to {1e3 * median:.0f} ms, 99 % up to {nearly_all:.1g} s, one {longest:.1f} s.
"""


STUDY = Study(
    "random_scenes", "Scenes drawn at random", measure, {}, report,
    f"{QUICK} of {FULL} scenes; adhesion of finite range on the shapes {' and '.join(QUICK_COHESIVE)} alone",
)  # fmt: skip
