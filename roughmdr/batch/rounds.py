"""Which runs come next: all of them at once or, with [accuracy], as many as it takes, cell by cell."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.batch.gathered import Gathered
from roughmdr.batch.identity import keys_of
from roughmdr.batch.shard import DONE
from roughmdr.batch.tally import Tally
from roughmdr.batch.tasks import Stretch
from roughmdr.plan import Plan
from roughmdr.scene.sections import Accuracy

FIRST = 16
"""Realisations at least, before a standard error is believed at all."""
_AFTER_ALL = "sampled"  # with accuracy.method "auto", where the expected law is not right enough
_SCORE = 2.326  # of 99 %: the share of cases in which the true standard error is to be met
_CARE = 0.7  # of the realisations that seem to be missing, how many are added before the next look
_LEAST = 0.02  # of those that there are, how many are added at least
_GROWTH = 4  # times as many at most from one look to the next
_FAR = 1e3  # times too large, an error asks for more than _GROWTH whatever it is


class Choice(NamedTuple):
    """How a cell is computed."""

    key: str
    estimator: str
    realizations: int
    error: float = math.nan
    """Of the mean force over its largest value: standard error, or that of an expected law; NaN where not known."""


class Rounds:
    """The runs of a plan, round after round."""

    def __init__(self, plan: Plan) -> None:
        self._plan, self._accuracy = plan, plan.scene.accuracy
        estimators = {cell.scene.estimator for cell in plan.cells}
        if self._accuracy is not None and self._accuracy.method == "auto":
            estimators.add(_AFTER_ALL)
        self._keys = {estimator: keys_of(plan, estimator) for estimator in sorted(estimators)}
        self._choices = [self._first_choice(cell) for cell in range(len(plan.cells))]
        alike: dict[str, int] = {}
        self._leader = [alike.setdefault(choice.key, cell) for cell, choice in enumerate(self._choices)]
        self._open = list(alike.values())

    @property
    def choices(self) -> list[Choice]:
        """How each cell is computed, as far as that is known; cells that are the same are computed once."""
        return [self._choices[leader] for leader in self._leader]

    @property
    def keys(self) -> list[set[str]]:
        """Of each cell the keys that it may come to have."""
        return [set(keys) for keys in zip(*self._keys.values(), strict=True)]

    def key(self, stretch: Stretch) -> str:
        """Of the cell of a stretch."""
        return self._keys[stretch.estimator][stretch.cell]

    def begin(self) -> list[Stretch]:
        """The runs of the first round."""
        return [self._stretch(cell, 0) for cell in self._open]

    def next(self, gathered: Gathered) -> list[Stretch]:
        """The runs of the next round, given what was gathered in those before; none where there are enough."""
        if self._accuracy is None:
            return []
        stretches, still_open = [], []
        for cell in self._open:
            before = self._choices[cell]
            now = self._judged(cell, before, gathered, self._accuracy)
            self._choices[cell] = now
            if (now.key, now.realizations) != (before.key, before.realizations):
                still_open.append(cell)
                stretches.append(self._stretch(cell, before.realizations if now.key == before.key else 0))
        self._open = still_open
        return stretches

    def _stretch(self, cell: int, first: int) -> Stretch:
        return Stretch(cell, first, self._choices[cell].realizations, self._choices[cell].estimator)

    def _choice(self, cell: int, estimator: str, count: int) -> Choice:
        return Choice(self._keys[estimator][cell], estimator, count)

    def _first_choice(self, cell: int) -> Choice:
        scene = self._plan.cells[cell].scene
        if self._accuracy is None:
            return self._choice(cell, scene.estimator, scene.batch.realizations)
        return self._choice(cell, scene.estimator, 1 if scene.estimator == "expected" else self._few(self._accuracy))

    def _few(self, accuracy: Accuracy) -> int:
        """How many realisations to begin with."""
        return min(max(self._plan.scene.batch.realizations, FIRST), accuracy.max_realizations)

    def _judged(self, cell: int, choice: Choice, gathered: Gathered, accuracy: Accuracy) -> Choice:
        """The choice with its error where it is good enough or nothing can be done, else a better one."""
        if choice.estimator == "expected":
            row = gathered.beside(choice.key)
            if accuracy.method == "auto" and not (row.status == DONE and row.numerical_error <= accuracy.relative):
                return self._choice(cell, _AFTER_ALL, self._few(accuracy))
            return choice._replace(error=row.numerical_error)
        tally = gathered.watched(choice.key, choice.realizations)
        if tally is None:  # some failed
            return choice
        error = relative_error(tally)
        count = next_count(choice.realizations, error, accuracy)
        error = error if error < math.inf else math.nan
        return choice._replace(error=error) if count == choice.realizations else choice._replace(realizations=count)


def relative_error(tally: Tally) -> float:
    """The largest standard error of the mean force [step] over its largest magnitude; inf without any force."""
    largest = float(np.max(np.abs(tally.mean)))
    return float(np.max(tally.standard_error)) / largest if largest > 0.0 else math.inf


def bound(count: int) -> float:
    """By how much the true standard error may exceed that of ``count`` normal realisations, in 99 % of cases.

    From the chi-squared distribution (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684).
    """
    a = 2.0 / (9.0 * (count - 1))
    share = 1.0 - a - _SCORE * math.sqrt(a)
    return share**-1.5 if share > 0.0 else math.inf


def next_count(count: int, error: float, accuracy: Accuracy) -> int:
    """How many realisations to look at next, where ``count`` have this ``error``; ``count`` where they are enough."""
    if count >= accuracy.max_realizations or error * bound(count) <= accuracy.relative:
        return count
    ratio = min(error / accuracy.relative, _FAR)
    needed = float(count)
    for _ in range(4):  # the bound comes down as the count goes up
        needed = max(count * (ratio * bound(math.ceil(needed))) ** 2, count + 1.0)
    added = max(_CARE * (needed - count), _LEAST * count, 1.0)
    return min(count + math.ceil(added), _GROWTH * count, accuracy.max_realizations)
