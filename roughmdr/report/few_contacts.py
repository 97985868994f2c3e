"""Says where few contacts carry the load, so that one map or realisation is one sample."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.schema.toml_text import parse_toml

if TYPE_CHECKING:
    from roughmdr.batch.foresee import Prospect
    from roughmdr.batch.plan import Plan

_FEW = 10.0
"""Effective number of contacts below which the load of a sample scatters by more than a third of itself."""

_SAMPLES = {"surface": "map", "spectrum": "map", "file": "ensemble"}  # words for a sample, by source


def sample_lines(effective: list[Floats], scene: str) -> Iterator[tuple[str, str]]:
    """Yield the line "sample" where few contacts carry the load at closest approach in cells of a scene, as TOML.

    ``effective`` are the effective numbers of contacts in the runs of each cell, above 0 where they are known; their
    median counts. Nothing is said where the scene asks for so few asperities.
    """
    runs = [cell[np.isfinite(cell) & (cell > 0.0)] for cell in effective]
    known = [float(np.median(cell)) for cell in runs if cell.size]
    few = [number for number in known if number < _FEW]
    asperities = parse_toml(scene).get("asperities")
    if not few or not isinstance(asperities, dict):
        return
    count = asperities.get("count")
    if isinstance(count, int) and count < _FEW:
        return
    least = min(few)
    counted = " to ".join(dict.fromkeys(f"{number:.2g}" for number in (least, max(few))))
    share = f" in {len(few)} of {len(known)} cells" if len(known) > 1 else ""
    sample = _SAMPLES.get(str(asperities.get("source")), "realisation")
    scatter = f"{'up to ' if len(few) > 1 else ''}about {100.0 / math.sqrt(least):.2g} %"
    yield (
        "sample",
        f"about {counted} contacts carry the load at closest approach{share}: one {sample} is one sample; at the same "
        f"separation the load of another differs by {scatter}",
    )


def sample_of_result(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield the line "sample" of a result; nothing where an earlier version did not store what it takes."""
    name = "effective_contacts"
    if name in result.variables:
        runs = [np.atleast_1d(result.variables[name].values[cell]) for cell in result.cells]
        yield from sample_lines(runs, result.attrs["scene"])


def foreseen_sample(plan: "Plan", prospect: "Prospect") -> Iterator[tuple[str, str]]:
    """Yield the line "sample" of a plan, from the cells that were foreseen."""
    effective = [np.array([cell.law.effective_contacts]) for cell in prospect.foreseen]
    yield from sample_lines(effective, plan.scene.toml)
