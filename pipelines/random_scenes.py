"""Scenes drawn at random over all that a scene may ask for: each is refused in words, or right as far as physics tells.

    python pipelines/random_scenes.py -o results/studies

hypothesis draws the scenes (``random_scenes_space.py``), in two processes with seeds of their own; each is run in
memory and judged (``random_scenes_judge.py``): no NaN, no infinite number, no exception but a refusal, force and area
monotone where physics says so. What fails is made as small as it can be, and raised with the scene as TOML.
Writes random_scenes.nc and random_scenes.png.
"""

import multiprocessing
import tempfile
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from hypothesis import HealthCheck, Phase, given, seed, settings
from random_scenes_inputs import Inputs
from random_scenes_judge import OUTCOMES, judge
from random_scenes_picture import draw
from random_scenes_space import scenes
from studies.study import Study, named, table

from roughmdr.shapes import SHAPES

SEEDS = (2026, 2027)
"""One for each process."""
FULL, QUICK = 10_000, 300
"""Scenes in all."""
QUICK_COHESIVE = ("paraboloid", "flat_punch")  # other shapes take long to compile with adhesion of finite range
ADHESION = ("none", "jkr", "dugdale", "auto")
SOURCES = ("random", "nayak", "surface", "file")
ESTIMATORS = ("sampled", "stratified", "expected", "accuracy")
KINDS = {"shape": tuple(SHAPES), "source": SOURCES, "adhesion": ADHESION, "estimator": ESTIMATORS, "outcome": OUTCOMES}
_NAMED = 12  # reasons that are told of


class Found(NamedTuple):
    """What became of one scene."""

    kind: tuple[str, ...]
    """As in ``KINDS``."""
    reason: str
    comparisons: int
    seconds: float


def kind_of(scene: dict[str, Any], outcome: str) -> tuple[str, ...]:
    """What a scene is one of, as in ``KINDS``."""
    section = scene["asperities"]
    shape = Path(section["file"]).stem if section["source"] == "file" else section.get("shape", "paraboloid")
    estimator = "accuracy" if "accuracy" in scene else scene.get("batch", {}).get("estimator", "sampled")
    return shape, section["source"], scene.get("adhesion", {"model": "none"})["model"], estimator, outcome


def hunt(start: int, count: int, inputs: Inputs) -> list[Found]:
    """Judge ``count`` scenes; Defect, with the smallest scene that shows it, where one is not right."""
    found = []

    @seed(start)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        phases=[Phase.generate, Phase.shrink],
        suppress_health_check=list(HealthCheck),
    )
    @given(scenes(inputs))
    def judged(scene: dict[str, Any]) -> None:
        started = time.perf_counter()
        verdict = judge(scene)
        seconds = time.perf_counter() - started
        found.append(Found(kind_of(scene, verdict.outcome), verdict.reason, verdict.comparisons, seconds))

    judged()
    return found


def measure(quick: bool) -> xr.Dataset:
    """All scenes."""
    each = (QUICK if quick else FULL) // len(SEEDS)
    with tempfile.TemporaryDirectory() as folder:
        inputs = Inputs.written(Path(folder), QUICK_COHESIVE) if quick else Inputs.written(Path(folder))
        with ProcessPoolExecutor(len(SEEDS), multiprocessing.get_context("spawn")) as pool:
            parts = list(pool.map(partial(hunt, count=each, inputs=inputs), SEEDS))
    return as_dataset([found for part in parts for found in part])


def as_dataset(found: list[Found]) -> xr.Dataset:
    """How many scenes there were of each kind, and why those were refused that were."""
    counts = np.zeros([len(names) for names in KINDS.values()], dtype=np.int64)
    for one in found:
        counts[tuple(names.index(name) for names, name in zip(KINDS.values(), one.kind, strict=True))] += 1
    reasons = Counter(one.reason for one in found if one.reason).most_common()
    seconds = np.array([one.seconds for one in found])
    return xr.Dataset(
        {
            "scenes": (tuple(KINDS), counts, named("scenes drawn")),
            "reason_count": ("reason", [count for _, count in reasons], named("scenes refused for a reason")),
            "comparisons": ((), sum(one.comparisons for one in found), named("claims about numbers that held")),
            "scene_time": ("quantile", np.quantile(seconds, (0.5, 0.99, 1.0)), named("run time of a scene", "s")),
        },
        {
            **{name: list(names) for name, names in KINDS.items()},
            "reason": [reason for reason, _ in reasons],
            "quantile": ("quantile", [0.5, 0.99, 1.0], named("part of the scenes that take no longer")),
        },
    )


def tell(result: xr.Dataset) -> str:
    """How many there were, what became of them, and why those were refused that were."""
    count = int(result.scenes.sum())

    def share(number: xr.DataArray) -> str:
        return f"{int(number)} ({100.0 * float(number) / count:.1f} %)"

    outcomes = ", ".join(f"{share(result.scenes.sel(outcome=name).sum())} {name}" for name in OUTCOMES)
    middle, most, longest = result.scene_time.to_numpy()
    pairs = zip(result.reason_count.to_numpy(), result.reason.to_numpy(), strict=True)  # the most frequent first
    reasons = [[f"{number}", str(reason)] for number, reason in pairs]
    return f"""
{count} scenes drawn over all that a scene may ask for: {outcomes}. In none of them was there a NaN, an infinite number,
or an exception that is no refusal, and {int(result.comparisons)} claims about their numbers all held: without adhesion
force, area, count and stiffness grow as the flat comes down and have no memory, and the force lies between the lines
that the stiffness draws; with it contacts grow as the flat comes down and shrink as it rises, those that were pressed
deeper before are larger and pull more, nothing lost comes back, and more work of adhesion means larger contacts and
less force. Forces may be off by their stated error, other sums by 1e-12 of the largest; expected laws by their error.
Half of the scenes take up to {1e3 * middle:.0f} ms, 99 % up to {most:.1g} s, one {longest:.1f} s.

The most frequent of {len(reasons)} reasons to refuse a scene or a run, without their numbers:

{table(["scenes", "reason"], reasons[:_NAMED])}
"""


STUDY = Study("random_scenes", "Scenes drawn at random", measure, draw, tell)

if __name__ == "__main__":
    STUDY.command()
