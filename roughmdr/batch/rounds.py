"""Which runs come next: all of them at once or, with [accuracy], as many as it takes, cell by cell."""

import math
from functools import cache
from typing import NamedTuple

from roughmdr.batch.choice import Choice
from roughmdr.batch.collect import Collector
from roughmdr.batch.costs import seconds
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.keys import keys_of
from roughmdr.batch.stopping_rule import (
    FEWEST,
    FIRST,
    RareAsperities,
    error_at,
    is_enough,
    missing_count,
    next_count,
    relative_error,
)
from roughmdr.batch.tasks import RunRange
from roughmdr.scene.sections import Accuracy
from roughmdr.variables import DONE


class CellMethod(NamedTuple):
    """How a cell is computed."""

    key: str
    estimator: str
    realizations: int
    error: float = math.nan
    """Error of the mean force over its largest value, of draws the standard error, or the whole one of a quantity that
    is asked for; NaN where not known."""
    drawn_error: float = math.nan  # standard error of the draws alone, without asperities that they may not have met
    model_error: float = math.nan  # error by the model in a quantity that is asked for, from the first realisations


class CellHistory(NamedTuple):
    """The method of a cell, and those tried before it."""

    method: CellMethod
    draws: CellMethod | None = None  # draws that the expected law replaced
    expected: CellMethod | None = None  # the expected law, where its error is too large


class Rounds:
    """The runs of a plan, round after round."""

    def __init__(self, plan: Plan) -> None:
        self._plan, self._accuracy = plan, plan.scene.accuracy
        estimators = {estimator for cell in plan.cells for estimator in cell.scene.estimators}
        self._keys = {estimator: keys_of(plan, estimator) for estimator in sorted(estimators)}
        self._histories = [CellHistory(self._first_method(cell)) for cell in range(len(plan.cells))]
        first_with: dict[str, int] = {}
        self._computed_as = [first_with.setdefault(each.method.key, cell) for cell, each in enumerate(self._histories)]
        self._open = list(first_with.values())
        self._requested: dict[str, int] = {}
        self._rare = cache(lambda cell: RareAsperities(plan.cells[cell]))

    @property
    def methods(self) -> list[CellMethod]:
        """How each cell is computed, as far as that is known; equal cells are computed once."""
        return [self._histories[cell].method for cell in self._computed_as]

    @property
    def keys(self) -> list[set[str]]:
        """The keys that each cell may have, one for each estimator."""
        return [set(keys) for keys in zip(*self._keys.values(), strict=True)]

    def begin(self) -> list[RunRange]:
        """Return the runs of the first round."""
        return [self._missing_runs(cell) for cell in self._open]

    def next(self, collector: Collector) -> list[RunRange]:
        """Return the runs of the next round, given the results of those before; none where there are enough."""
        if self._accuracy is None:
            return []
        for cell in self._open:
            self._histories[cell] = self._judge(cell, self._histories[cell], collector, self._accuracy)
        methods = [(cell, self._histories[cell].method) for cell in self._open]
        self._open = [cell for cell, method in methods if method.realizations > self._requested.get(method.key, 0)]
        return [self._missing_runs(cell) for cell in self._open]

    def _missing_runs(self, cell: int) -> RunRange:
        """Return the runs that the method of a cell needs beyond those that were requested."""
        key, estimator, count, *_ = self._histories[cell].method
        first, self._requested[key] = self._requested.get(key, 0), count
        return RunRange(key, self._plan.cells[cell], estimator, first, count)

    def _first_method(self, cell: int) -> CellMethod:
        estimator, *other = self._plan.cells[cell].scene.estimators
        if self._accuracy is None:
            return self._method(cell, estimator, self._plan.cells[cell].scene.batch.realizations)
        count = self._first_count(self._accuracy)
        if estimator == "expected" or (other and self._is_dearer(cell, count)):
            return self._method(cell, "expected", 1)
        return self._method(cell, estimator, count)

    def _method(self, cell: int, estimator: str, count: int) -> CellMethod:
        return CellMethod(self._keys[estimator][cell], estimator, count)

    def _first_count(self, accuracy: Accuracy) -> int:
        """Return how many realisations to begin with."""
        if not self._plan.scene.asperities.is_random:
            return 1
        fewest = FIRST if self._plan.choice is None else FEWEST
        return min(max(self._plan.scene.batch.realizations, fewest), accuracy.max_realizations)

    def _is_dearer(self, cell: int, realizations: float) -> bool:
        """Return whether so many realisations cost more than the expected law."""
        drawn, expected = (seconds(self._plan.cells[cell], name) for name in self._plan.cells[cell].scene.estimators)
        return realizations * drawn > expected

    def _judge(self, cell: int, history: CellHistory, collector: Collector, accuracy: Accuracy) -> CellHistory:
        """Accept the cell with its error, extend it, or switch its method."""
        if self._plan.choice is not None:
            return self._judge_quantity(cell, history, collector, self._plan.choice, accuracy.max_realizations)
        asked = accuracy.share
        if history.method.estimator != "expected":
            return self._judge_draws(cell, history, collector, accuracy)
        diagnostics = collector.diagnostics(history.method.key)
        expected = history.method._replace(error=float(diagnostics["numerical_error"]))
        met = diagnostics["status"] == DONE and expected.error <= asked
        if accuracy.method == "expected" or met:
            return history._replace(method=expected)
        if history.draws is None:
            draws = self._method(cell, self._plan.cells[cell].scene.estimators[0], self._first_count(accuracy))
            return history._replace(method=draws, expected=expected)
        return self._judge_draws(cell, history._replace(method=history.draws, expected=expected), collector, accuracy)

    def _judge_draws(self, cell: int, history: CellHistory, collector: Collector, accuracy: Accuracy) -> CellHistory:
        draws, asked = history.method, accuracy.share
        moments = collector.watched(draws.key, draws.realizations)
        if moments is None:  # some failed
            return history
        over_range = self._plan.watched == "separation"
        unmet = self._rare(cell).spread(draws.realizations)
        error = relative_error(moments, unmet, over_range=over_range)
        drawn_error = relative_error(moments, over_range=over_range)
        known = draws._replace(error=error, drawn_error=drawn_error) if error < math.inf else draws
        if is_enough(draws.realizations, error, asked):
            return history._replace(method=known)
        if further := self._further(cell, history, error, asked, accuracy.max_realizations):
            return further
        if history.expected is not None and history.expected.error < error:
            return history._replace(method=history.expected)
        return history._replace(method=known)

    def _further(self, cell: int, history: CellHistory, error: float, asked: float, most: int) -> CellHistory | None:
        """Return the method with more realisations, or the expected law where that takes less; None where neither can
        be.
        """
        draws = history.method
        count = next_count(draws.realizations, error, asked, most)
        untried = history.expected is None and "expected" in self._plan.cells[cell].scene.estimators
        exhausted = count == draws.realizations
        if untried and (exhausted or self._is_dearer(cell, missing_count(draws.realizations, error, asked))):
            return history._replace(method=self._method(cell, "expected", 1), draws=draws)
        return None if exhausted else history._replace(method=draws._replace(realizations=count))

    def _judge_quantity(
        self, cell: int, history: CellHistory, collector: Collector, choice: Choice, most: int
    ) -> CellHistory:
        """Accept the cell with the whole error of the quantity that is asked for, or extend it."""
        key, estimator, count, *_ = method = history.method
        told, moments = collector.diagnostics(key), collector.watched(key, count)
        if moments is None:  # some failed
            return history
        planned = self._plan.cells[cell]
        law = {**collector.means(key, count), self._plan.control: planned.values}
        if math.isnan(method.model_error):
            method = method._replace(model_error=choice.model_error(told, law))
        if estimator == "expected" or not planned.scene.asperities.is_random:
            numerical = choice.numerical(told, law) if estimator == "expected" else 0.0
            return history._replace(method=method._replace(error=method.model_error + numerical))
        of_it = choice.variable == planned.controlled.watched  # what rare ones would add to others is not known
        error = error_at(
            moments, choice.step, self._rare(cell).spread(count) if of_it else 0.0, absolute=choice.of.absolute
        )
        whole, asked = method.model_error + choice.drawn(error, count), choice.standard_error(method.model_error)
        method = method._replace(error=whole if whole < math.inf else math.nan)
        history = history._replace(method=method)
        if math.isnan(method.model_error) or is_enough(count, error, asked):
            return history
        return self._further(cell, history, error, asked, most) or history
