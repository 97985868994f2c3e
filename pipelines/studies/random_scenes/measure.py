"""Scenes drawn at random over all that a scene may ask for: each is refused in words, or physically right.

hypothesis draws the scenes, in two processes with seeds of their own; each is run in memory and judged: no NaN, no
infinite number, no exception but a refusal, force and area monotone where physics says so. A scene that fails is made
as small as it can be, and raised as TOML.
"""

import multiprocessing
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr
from hypothesis import HealthCheck, Phase, given, seed, settings

from roughmdr.shapes import SCENE_SHAPES
from studies.random_scenes.judge import judge
from studies.random_scenes.scenes import scenes, write_inputs
from studies.study import named

SEEDS = (2026, 2027)
"""One for each process."""
FULL, QUICK = 10_000, 300
"""Scenes in all."""
QUICK_COHESIVE = ("paraboloid", "flat_punch")  # other shapes take long to compile with adhesion of finite range
KINDS = ("shape", "adhesion", "source", "estimator")


def kind_of(scene: dict[str, Any]) -> tuple[str, ...]:
    """Return the kind of a scene, as in ``KINDS``."""
    section = scene["asperities"]
    shape = Path(section["file"]).stem if section["source"] == "file" else section.get("shape", "paraboloid")
    estimator = "accuracy" if "accuracy" in scene else scene.get("batch", {}).get("estimator", "sampled")
    return shape, scene.get("adhesion", {"model": "none"})["model"], section["source"], estimator


def search(start: int, count: int, folder: Path, cohesive: tuple[str, ...]) -> list[tuple[Any, ...]]:
    """Judge ``count`` scenes: return kind, verdict and run time [s] of each.

    Raise Defect, with the smallest scene that shows it, where one is not right.
    """
    records = []
    phases, no_checks = (Phase.generate, Phase.shrink), list(HealthCheck)

    @seed(start)
    @settings(max_examples=count, deadline=None, database=None, phases=phases, suppress_health_check=no_checks)
    @given(scenes(folder, cohesive))
    def judged(scene: dict[str, Any]) -> None:
        started = time.perf_counter()
        verdict = judge(scene)
        records.append((*kind_of(scene), *verdict, time.perf_counter() - started))

    judged()
    return records


def measure(quick: bool) -> xr.Dataset:
    """Judge all scenes; return the kind of each, what became of it, and why it was refused if it was."""
    each, cohesive = (QUICK if quick else FULL) // len(SEEDS), QUICK_COHESIVE if quick else tuple(SCENE_SHAPES)
    with tempfile.TemporaryDirectory() as folder:
        write_inputs(Path(folder))
        search_part = partial(search, count=each, folder=Path(folder), cohesive=cohesive)
        with ProcessPoolExecutor(len(SEEDS), multiprocessing.get_context("spawn")) as pool:
            records = [record for part in pool.map(search_part, SEEDS) for record in part]
    *words, comparisons, seconds = ([*column] for column in zip(*records, strict=True))
    return xr.Dataset(
        {
            "comparisons": ("scene", comparisons, named("claims about numbers that held")),
            "run_time": ("scene", seconds, named("run time of a scene", "s")),
        },
        {name: ("scene", column) for name, column in zip((*KINDS, "outcome", "reason"), words, strict=True)},
    )
