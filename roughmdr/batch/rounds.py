"""Which runs come next: all of them at once or, with [accuracy], as many as it takes, cell by cell."""

import math
from typing import NamedTuple

from roughmdr.batch.collect import Collector
from roughmdr.batch.costs import seconds
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.keys import keys_of
from roughmdr.batch.stopping_rule import FIRST, enough, next_count, relative_error, still_missing
from roughmdr.batch.tasks import RunRange
from roughmdr.batch.unmet import Rare
from roughmdr.scene.sections import Accuracy
from roughmdr.variables import DONE


class CellMethod(NamedTuple):
    """How a cell is computed."""

    key: str
    estimator: str
    realizations: int
    error: float = math.nan
    """Of the mean force over its largest value: standard error, or that of an expected law; NaN where not known."""
    met: float = math.nan
    """The standard error by the draws alone, without what asperities may add that they have not met."""


class _Way(NamedTuple):
    """How a cell came to its choice."""

    choice: CellMethod
    draws: CellMethod | None = None
    """Those before its expected law."""
    law: CellMethod | None = None
    """Its expected law, where that is not right enough."""


class Rounds:
    """The runs of a plan, round after round."""

    def __init__(self, plan: Plan) -> None:
        self._plan, self._accuracy = plan, plan.scene.accuracy
        estimators = {estimator for cell in plan.cells for estimator in cell.scene.estimators}
        self._keys = {estimator: keys_of(plan, estimator) for estimator in sorted(estimators)}
        self._ways = [_Way(self._first_choice(cell)) for cell in range(len(plan.cells))]
        alike: dict[str, int] = {}
        self._leader = [alike.setdefault(way.choice.key, cell) for cell, way in enumerate(self._ways)]
        self._open = list(alike.values())
        self._made: dict[str, int] = {}
        self._rare: dict[int, Rare] = {}

    @property
    def choices(self) -> list[CellMethod]:
        """How each cell is computed, as far as that is known; cells that are the same are computed once."""
        return [self._ways[leader].choice for leader in self._leader]

    @property
    def keys(self) -> list[set[str]]:
        """Of each cell the keys that it may come to have."""
        return [set(keys) for keys in zip(*self._keys.values(), strict=True)]

    def key(self, stretch: RunRange) -> str:
        """Of the cell of a stretch."""
        return self._keys[stretch.estimator][stretch.cell]

    def begin(self) -> list[RunRange]:
        """The runs of the first round."""
        return [self._stretch(cell) for cell in self._open]

    def next(self, gathered: Collector) -> list[RunRange]:
        """The runs of the next round, given what was gathered in those before; none where there are enough."""
        if self._accuracy is None:
            return []
        for cell in self._open:
            self._ways[cell] = self._after(cell, self._ways[cell], gathered, self._accuracy)
        wanting = [(cell, self._ways[cell].choice) for cell in self._open]
        self._open = [cell for cell, choice in wanting if choice.realizations > self._made.get(choice.key, 0)]
        return [self._stretch(cell) for cell in self._open]

    def _stretch(self, cell: int) -> RunRange:
        """What the choice of a cell needs beyond what was made."""
        key, estimator, count, *_ = self._ways[cell].choice
        first, self._made[key] = self._made.get(key, 0), count
        return RunRange(cell, first, count, estimator)

    def _first_choice(self, cell: int) -> CellMethod:
        accuracy = self._accuracy
        estimator, *other = self._plan.cells[cell].scene.estimators
        if accuracy is None:
            return self._choice(cell, estimator, self._plan.cells[cell].scene.batch.realizations)
        if estimator == "expected" or (other and self._dearer(cell, self._few(accuracy))):
            return self._choice(cell, "expected", 1)
        return self._choice(cell, estimator, self._few(accuracy))

    def _choice(self, cell: int, estimator: str, count: int) -> CellMethod:
        return CellMethod(self._keys[estimator][cell], estimator, count)

    def _few(self, accuracy: Accuracy) -> int:
        """How many realisations to begin with."""
        return min(max(self._plan.scene.batch.realizations, FIRST), accuracy.max_realizations)

    def _dearer(self, cell: int, draws: float) -> bool:
        """Whether so many draws cost more than the expected law."""
        own = self._plan.cells[cell]
        drawn, law = (seconds(own, estimator) for estimator in own.scene.estimators)
        return draws * drawn > law

    def _after(self, cell: int, way: _Way, gathered: Collector, accuracy: Accuracy) -> _Way:
        """The same choice with its error where that is small enough or nothing is better; else a better one."""
        if way.choice.estimator != "expected":
            return self._after_draws(cell, way, gathered, accuracy)
        row = gathered.diagnostics(way.choice.key)
        law = way.choice._replace(error=float(row["numerical_error"]))
        if accuracy.method == "expected" or (row["status"] == DONE and law.error <= accuracy.relative):
            return way._replace(choice=law)
        if way.draws is None:
            draws = self._choice(cell, self._plan.cells[cell].scene.estimators[0], self._few(accuracy))
            return way._replace(choice=draws, law=law)
        return self._after_draws(cell, way._replace(choice=way.draws, law=law), gathered, accuracy)

    def _after_draws(self, cell: int, way: _Way, gathered: Collector, accuracy: Accuracy) -> _Way:
        draws = way.choice
        tally = gathered.watched(draws.key, draws.realizations)
        if tally is None:  # some failed
            return way
        if cell not in self._rare:
            self._rare[cell] = Rare(self._plan.cells[cell])
        error = relative_error(tally, self._rare[cell].spread(draws.realizations))
        choice = draws._replace(error=error, met=relative_error(tally)) if error < math.inf else draws
        known = way._replace(choice=choice)
        if enough(draws.realizations, error, accuracy):
            return known
        count = next_count(draws.realizations, error, accuracy)
        at_its_end = count == draws.realizations
        untried = way.law is None and "expected" in self._plan.cells[cell].scene.estimators
        if untried and (at_its_end or self._dearer(cell, still_missing(draws.realizations, error, accuracy))):
            return way._replace(choice=self._choice(cell, "expected", 1), draws=draws)
        if not at_its_end:
            return way._replace(choice=draws._replace(realizations=count))
        return way._replace(choice=way.law) if way.law is not None and way.law.error < error else known
