"""Which runs come next: all of them at once or, with [accuracy], as many as it takes, cell by cell."""

import math
from typing import NamedTuple

from roughmdr.batch.costs import seconds
from roughmdr.batch.enough import FIRST, enough, next_count, relative_error, still_missing
from roughmdr.batch.gathered import Gathered
from roughmdr.batch.identity import keys_of
from roughmdr.batch.shard import DONE
from roughmdr.batch.tasks import Stretch
from roughmdr.plan import Plan
from roughmdr.scene.sections import Accuracy


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
        estimators = {estimator for cell in plan.cells for estimator in cell.scene.estimators}
        self._keys = {estimator: keys_of(plan, estimator) for estimator in sorted(estimators)}
        self._choices = [self._first_choice(cell) for cell in range(len(plan.cells))]
        alike: dict[str, int] = {}
        self._leader = [alike.setdefault(choice.key, cell) for cell, choice in enumerate(self._choices)]
        self._open = list(alike.values())
        self._made: dict[str, int] = {}
        self._drawn: dict[int, Choice] = {}
        """Of cells whose expected law came, or comes, after draws."""
        self._ruled_out: set[int] = set()
        """Cells whose expected law is not right enough."""

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
        return [self._stretch(cell) for cell in self._open]

    def next(self, gathered: Gathered) -> list[Stretch]:
        """The runs of the next round, given what was gathered in those before; none where there are enough."""
        if self._accuracy is None:
            return []
        for cell in self._open:
            self._choices[cell] = self._judged(cell, self._choices[cell], gathered, self._accuracy)
        wanting = [(cell, self._choices[cell]) for cell in self._open]
        self._open = [cell for cell, choice in wanting if choice.realizations > self._made.get(choice.key, 0)]
        return [self._stretch(cell) for cell in self._open]

    def _stretch(self, cell: int) -> Stretch:
        """What the choice of a cell needs beyond what was made."""
        key, estimator, count, _ = self._choices[cell]
        first, self._made[key] = self._made.get(key, 0), count
        return Stretch(cell, first, count, estimator)

    def _choice(self, cell: int, estimator: str, count: int) -> Choice:
        return Choice(self._keys[estimator][cell], estimator, count)

    def _first_choice(self, cell: int) -> Choice:
        own, accuracy = self._plan.cells[cell], self._accuracy
        estimator, *other = own.scene.estimators
        if accuracy is None:
            return self._choice(cell, estimator, own.scene.batch.realizations)
        if estimator == "expected" or (other and self._dearer(cell, self._few(accuracy))):
            return self._choice(cell, "expected", 1)
        return self._choice(cell, estimator, self._few(accuracy))

    def _few(self, accuracy: Accuracy) -> int:
        """How many realisations to begin with."""
        return min(max(self._plan.scene.batch.realizations, FIRST), accuracy.max_realizations)

    def _dearer(self, cell: int, draws: float) -> bool:
        """Whether so many draws cost more than the expected law."""
        own = self._plan.cells[cell]
        drawn, law = (seconds(own, estimator) for estimator in own.scene.estimators)
        return draws * drawn > law

    def _judged(self, cell: int, choice: Choice, gathered: Gathered, accuracy: Accuracy) -> Choice:
        """The choice with its error where it is good enough or nothing can be done, else a better one."""
        if choice.estimator == "expected":
            return self._judged_law(cell, choice, gathered, accuracy)
        tally = gathered.watched(choice.key, choice.realizations)
        if tally is None:  # some failed
            return choice
        error = relative_error(tally)
        known = choice._replace(error=error if error < math.inf else math.nan)
        if enough(choice.realizations, error, accuracy):
            return known
        count = next_count(choice.realizations, error, accuracy)
        missing = still_missing(choice.realizations, error, accuracy)
        at_its_end = count == choice.realizations
        may_integrate = "expected" in self._plan.cells[cell].scene.estimators and cell not in self._ruled_out
        if may_integrate and (at_its_end or self._dearer(cell, missing)):
            self._drawn[cell] = choice
            return self._choice(cell, "expected", 1)
        return known if at_its_end else choice._replace(realizations=count)

    def _judged_law(self, cell: int, choice: Choice, gathered: Gathered, accuracy: Accuracy) -> Choice:
        """The same of an expected law."""
        row = gathered.beside(choice.key)
        if accuracy.method == "expected" or (row.status == DONE and row.numerical_error <= accuracy.relative):
            return choice._replace(error=row.numerical_error)
        self._ruled_out.add(cell)
        if cell in self._drawn:
            return self._judged(cell, self._drawn[cell], gathered, accuracy)
        return self._choice(cell, self._plan.cells[cell].scene.estimators[0], self._few(accuracy))
