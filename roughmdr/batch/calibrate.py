"""The cost of one run of a cell, measured on parts of it, each larger than the one before while there is time."""

import math
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.batch.costs import along_seconds, beside, law_seconds
from roughmdr.batch.plan import Cell
from roughmdr.batch.realization import simulate_ensemble, simulate_realization
from roughmdr.ensemble import Ensemble
from roughmdr.loading.lateral import LateralPath, Path
from roughmdr.scene import Scene

_PARTS = (
    (20, 8),
    (200, 40),
    (2000, 100),
    (10_000, 500),
)  # asperities and steps of a part; time and memory grow in proportion
_RIGHT_TO = 3.0  # factor to which the costs of ``costs`` are right: small parts may be lost in the noise of the clock
_LONG = 0.5  # seconds of a first run that is not repeated for the sake of the clock
_REPEATS = 10  # number of times that the last part is measured
_MARGIN = 2.5  # runs of a part for which there must be time left: one with the memory traced


class Cost(NamedTuple):
    """Time [s] and memory [byte] of one run of a cell, and the largest part that was run to find them."""

    seconds: float
    memory: float
    asperities: int = 0
    steps: int = 0


class _Time(NamedTuple):
    """Time [s] of a part of a run: that of its thread, which others on the machine do not lengthen."""

    drawing: float
    summing: float

    @property
    def total(self) -> float:
        return self.drawing + self.summing


def measure(cell: Cell, estimator: str, variables: list[str], budget: float) -> Cost:
    """Return the cost of one run of a cell, in about ``budget`` seconds; at least a small part is run.

    An expected law that cannot be had in that time even at a few steps is not run: its cost is that of ``costs``, as is
    that of what stages compute beside a law. RoughmdrError where the cell cannot be computed.
    """
    cost = _measure_law(cell, estimator, variables, budget)  # along separations
    law = cost.seconds * law_seconds(cell, estimator) / along_seconds(cell, estimator)
    more = beside(cell)
    return cost._replace(seconds=law + more.seconds, memory=cost.memory + more.memory)


def _measure_law(cell: Cell, estimator: str, variables: list[str], budget: float) -> Cost:
    """Return the cost of the law of one run of a cell: where it needs more separations, as that without them tells."""
    if longer := [stage.key for stage in cell.scene.stages if stage.more_separations]:
        plain = cell._replace(scene=cell.scene.model_copy(update=dict.fromkeys(longer)))
        cost = _measure_law(plain, estimator, variables, budget)
        more = along_seconds(cell, estimator) / along_seconds(plain, estimator)
        return cost._replace(seconds=cost.seconds * more)
    if estimator == "expected" or cell.scene.needs_positions:
        return _in_proportion(cell, estimator, variables, budget)
    count = max(1, math.ceil(cell.scene.asperities.expected_count))
    sizes = list(dict.fromkeys((min(most, count), min(steps, cell.steps)) for most, steps in _PARTS))

    def run_part(asperities: int, steps: int) -> _Time:
        return _draw_and_sum(cell.scene, _thinned(cell, steps).usual, asperities, estimator, variables)

    def run(size: int) -> _Time:
        return run_part(*sizes[size])

    def scaled(taken: _Time, size: int, asperities: int, steps: int) -> float:
        """Return the time of so many asperities and steps: what one of each takes, and the rest in proportion."""
        more = asperities / sizes[size][0]
        drawing, summing = max(taken.drawing - least.drawing, 0.0), max(taken.summing - least.summing, 0.0)
        return least.total + more * (drawing + summing * steps / sizes[size][1])

    run_part(1, 1)  # what is loaded at its first use does not count
    least = run_part(1, 1)
    size, times, memory = _grow(run, lambda size, taken: scaled(taken, size, *sizes[size + 1]), len(sizes), budget)
    taken = _Time(*np.median(times, axis=0).tolist())
    least_known = along_seconds(cell, estimator) / _RIGHT_TO if size == 0 and len(sizes) > 1 else 0.0
    whole = max(scaled(taken, size, count, cell.steps), least_known)
    return Cost(whole, memory * count / sizes[size][0], *sizes[size])


def _in_proportion(cell: Cell, estimator: str, variables: list[str], budget: float) -> Cost:
    """Return the cost of a run that grows from a part to the whole as ``costs`` foresees: of an expected law, whose
    parts have fewer steps, or of asperities that feel each other in pairs, whose parts have fewer of them, too.
    """
    whole, drawn = cell.scene.asperities, estimator != "expected"
    total = max(1.0, whole.expected_count) if drawn else 0.0
    sizes = list(dict.fromkeys((min(most, math.ceil(total)), min(steps, cell.steps)) for most, steps in _PARTS))
    sections = [whole.limited_to(asperities) if drawn else whole for asperities, _ in sizes]
    parts = [
        _thinned(cell, steps)._replace(scene=cell.scene.model_copy(update={"asperities": section}))
        for section, (_, steps) in zip(sections, sizes, strict=True)
    ]
    foreseen = [along_seconds(part, estimator) for part in (*parts, cell)]
    if _MARGIN * foreseen[0] > budget:
        return Cost(foreseen[-1], 0.0)

    def run_drawn(part: Cell, asperities: int) -> None:
        simulate_ensemble(cell.scene, part.usual, _drawn(cell.scene, asperities, estimator), variables)

    if drawn:
        run_drawn(_thinned(cell, 1), 1)  # what is loaded at its first use does not count

    def run(size: int) -> _Time:
        started = time.thread_time()
        if drawn:
            run_drawn(parts[size], sizes[size][0])
        else:
            simulate_realization(cell.scene, parts[size].usual, 0, variables, estimator)
        return _Time(0.0, time.thread_time() - started)

    def scaled(taken: _Time, size: int, other: int) -> float:
        return taken.total * foreseen[other] / foreseen[size]

    size, times, memory = _grow(run, lambda size, taken: scaled(taken, size, size + 1), len(parts), budget)
    taken = _Time(*np.median(times, axis=0).tolist())
    more = total / sections[size].expected_count if drawn else 1.0
    return Cost(scaled(taken, size, -1), memory * more, *sizes[size])


def _grow(
    run: Callable[[int], _Time], next_seconds: Callable[[int, _Time], float], sizes: int, budget: float
) -> tuple[int, list[_Time], float]:
    """Run larger and larger parts while the next one fits into the budget.

    Return the number of the last one, the times of it, and its memory [byte].
    """
    started = time.perf_counter()

    def left() -> float:
        return budget - (time.perf_counter() - started)

    taken, memory = _traced(run, 0)
    if taken.total < _LONG:
        taken = run(0)  # without what is loaded at its first use
    size, times = 0, [taken]
    while size + 1 < sizes and _MARGIN * next_seconds(size, times[0]) < left():
        size += 1
        times = [run(size)]
    if size > 0:
        _, memory = _traced(run, size)
    while len(times) < _REPEATS and times[0].total < left():
        times.append(run(size))
    return size, times, memory


def _traced(run: Callable[[int], _Time], size: int) -> tuple[_Time, float]:
    """Run a part; return its time, longer since its memory is traced, and that memory [byte]."""
    tracemalloc.start()
    try:
        return run(size), float(tracemalloc.get_traced_memory()[1])
    finally:
        tracemalloc.stop()


def _thinned(cell: Cell, steps: int) -> Cell:
    """Return a cell with so many steps of its path, in loading: to find a pull-off takes time of its own, which does
    not grow with them.
    """
    if steps >= cell.steps:
        return Cell(cell.scene, cell.path, cell.usual)
    some = np.linspace(0, cell.steps - 1, steps).astype(int)
    separation = np.sort(cell.path.separation[some])[::-1]
    path = LoadingPath.along(separation, unload=False, adhesive=cell.scene.work > 0.0)
    usual: Path = path
    if isinstance(cell.controlled, LateralPath):
        usual = LateralPath.along(cell.controlled.held, cell.controlled.displacement[some]).over(path)
    return Cell(cell.scene, path, usual)


def _draw_and_sum(scene: Scene, path: Path, count: int, estimator: str, variables: list[str]) -> _Time:
    started = time.thread_time()
    ensemble = _drawn(scene, count, estimator)
    drawn = time.thread_time()
    some = _some_of(ensemble, count)
    began = time.thread_time()
    simulate_ensemble(scene, path, some, variables)
    return _Time(drawn - started, time.thread_time() - began)


def _drawn(scene: Scene, count: int, estimator: str) -> Ensemble:
    """Draw so many asperities, as many per area as the scene has; a few high ones of them never fill its whole area."""
    ensemble = scene.asperities.limited_to(count).ensemble(
        scene.seed, 0, stratified=estimator == "stratified", with_positions=scene.needs_positions
    )
    return replace(ensemble, nominal_area=scene.asperities.nominal_area)


def _some_of(ensemble: Ensemble, count: int) -> Ensemble:
    """Return about so many asperities of one that cannot be drawn smaller, evenly over the heights."""
    stride = max(1, ensemble.height.size // count)
    if stride == 1:
        return ensemble
    return replace(ensemble.taken(np.arange(0, ensemble.height.size, stride)), positions={})
