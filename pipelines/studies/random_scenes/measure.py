"""Scenes drawn at random over all that a scene may ask for: each is refused in words, or physically right.

hypothesis draws the scenes, in two processes with seeds of their own; each is run in memory and judged: no NaN, no
infinite number, no exception but a refusal, force and area monotone where physics says so. A scene that fails is made
as small as it can be, and raised as TOML.
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
from studies.random_scenes.inputs import Inputs
from studies.random_scenes.judge import OUTCOMES, judge
from studies.random_scenes.scenes import scenes
from studies.study import named

from roughmdr.shapes import SHAPES

SEEDS = (2026, 2027)
"""One for each process."""
FULL, QUICK = 10_000, 300
"""Scenes in all."""
QUICK_COHESIVE = ("paraboloid", "flat_punch")  # other shapes take long to compile with adhesion of finite range
KINDS = {
    "shape": tuple(SHAPES),
    "source": ("random", "nayak", "surface", "file"),
    "adhesion": ("none", "jkr", "dugdale", "auto"),
    "estimator": ("sampled", "stratified", "expected", "accuracy"),
    "outcome": OUTCOMES,
}


class Record(NamedTuple):
    """The outcome of one scene."""

    kind: tuple[str, ...]
    """As in ``KINDS``."""
    reason: str
    comparisons: int
    seconds: float


def kind_of(scene: dict[str, Any], outcome: str) -> tuple[str, ...]:
    """Return the kind of a scene, as in ``KINDS``."""
    section = scene["asperities"]
    shape = Path(section["file"]).stem if section["source"] == "file" else section.get("shape", "paraboloid")
    estimator = "accuracy" if "accuracy" in scene else scene.get("batch", {}).get("estimator", "sampled")
    return shape, section["source"], scene.get("adhesion", {"model": "none"})["model"], estimator, outcome


def search(start: int, count: int, inputs: Inputs) -> list[Record]:
    """Judge ``count`` scenes; raise Defect, with the smallest scene that shows it, where one is not right."""
    records = []

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
        records.append(Record(kind_of(scene, verdict.outcome), verdict.reason, verdict.comparisons, seconds))

    judged()
    return records


def measure(quick: bool) -> xr.Dataset:
    """Judge all scenes; return how many there were of each kind, and why those were refused that were."""
    each = (QUICK if quick else FULL) // len(SEEDS)
    with tempfile.TemporaryDirectory() as folder:
        inputs = Inputs.written(Path(folder), QUICK_COHESIVE if quick else tuple(SHAPES))
        with ProcessPoolExecutor(len(SEEDS), multiprocessing.get_context("spawn")) as pool:
            records = [one for part in pool.map(partial(search, count=each, inputs=inputs), SEEDS) for one in part]
    counts = np.zeros([len(names) for names in KINDS.values()], dtype=np.int64)
    for one in records:
        counts[tuple(names.index(name) for names, name in zip(KINDS.values(), one.kind, strict=True))] += 1
    reasons = Counter(one.reason for one in records if one.reason).most_common()
    seconds = np.quantile([one.seconds for one in records], (0.5, 0.99, 1.0))
    return xr.Dataset(
        {
            "scenes": (tuple(KINDS), counts, named("scenes drawn")),
            "reason_count": ("reason", [count for _, count in reasons], named("scenes refused for a reason")),
            "comparisons": ((), sum(one.comparisons for one in records), named("claims about numbers that held")),
            "scene_time": ("quantile", seconds, named("run time of a scene", "s")),
        },
        {
            **{name: list(names) for name, names in KINDS.items()},
            "reason": [reason for reason, _ in reasons],
            "quantile": ("quantile", [0.5, 0.99, 1.0], named("part of the scenes that take no longer")),
        },
    )
