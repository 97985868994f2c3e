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
from typing import Any, TypeAlias

import numpy as np
import xarray as xr
from hypothesis import HealthCheck, Phase, given, seed, settings
from studies.random_scenes.judge import OUTCOMES, Verdict, judge
from studies.random_scenes.scenes import scenes, write_inputs
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
QUANTILES = (0.5, 0.99, 1.0)

Record: TypeAlias = tuple[tuple[str, ...], Verdict, float]
"""The kind of a scene, as in ``KINDS``, its outcome, and its run time [s]."""


def kind_of(scene: dict[str, Any], outcome: str) -> tuple[str, ...]:
    """Return the kind of a scene, as in ``KINDS``."""
    section = scene["asperities"]
    shape = Path(section["file"]).stem if section["source"] == "file" else section.get("shape", "paraboloid")
    estimator = "accuracy" if "accuracy" in scene else scene.get("batch", {}).get("estimator", "sampled")
    return shape, section["source"], scene.get("adhesion", {"model": "none"})["model"], estimator, outcome


def search(start: int, count: int, folder: Path, cohesive: tuple[str, ...]) -> list[Record]:
    """Judge ``count`` scenes; raise Defect, with the smallest scene that shows it, where one is not right."""
    records = list[Record]()
    phases, no_checks = (Phase.generate, Phase.shrink), list(HealthCheck)

    @seed(start)
    @settings(max_examples=count, deadline=None, database=None, phases=phases, suppress_health_check=no_checks)
    @given(scenes(folder, cohesive))
    def judged(scene: dict[str, Any]) -> None:
        started = time.perf_counter()
        verdict = judge(scene)
        records.append((kind_of(scene, verdict.outcome), verdict, time.perf_counter() - started))

    judged()
    return records


def measure(quick: bool) -> xr.Dataset:
    """Judge all scenes; return how many there were of each kind, and why those were refused that were."""
    each, cohesive = (QUICK if quick else FULL) // len(SEEDS), QUICK_COHESIVE if quick else tuple(SHAPES)
    with tempfile.TemporaryDirectory() as folder:
        write_inputs(Path(folder))
        search_part = partial(search, count=each, folder=Path(folder), cohesive=cohesive)
        with ProcessPoolExecutor(len(SEEDS), multiprocessing.get_context("spawn")) as pool:
            records = [record for part in pool.map(search_part, SEEDS) for record in part]
    kinds, verdicts, seconds = zip(*records, strict=True)
    counts = np.zeros([len(names) for names in KINDS.values()], dtype=np.int64)
    for kind, count in Counter(kinds).items():
        counts[tuple(map(tuple.index, KINDS.values(), kind))] = count
    reasons = Counter(verdict.reason for verdict in verdicts if verdict.reason).most_common()
    return xr.Dataset(
        {
            "scenes": (tuple(KINDS), counts, named("scenes drawn")),
            "reason_count": ("reason", [count for _, count in reasons], named("scenes refused for a reason")),
            "comparisons": ((), sum(each.comparisons for each in verdicts), named("claims about numbers that held")),
            "scene_time": ("quantile", np.quantile(seconds, QUANTILES), named("run time of a scene", "s")),
        },
        {
            **{name: list(names) for name, names in KINDS.items()},
            "reason": [reason for reason, _ in reasons],
            "quantile": ("quantile", list(QUANTILES), named("part of the scenes that take no longer")),
        },
    )
