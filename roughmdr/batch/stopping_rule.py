"""When realisations are enough for an error that is asked for, and how many to look at next where they are not.

A sample tells nothing of what it has not met: where a few asperities carry most of the spread, that of the draws is too
small until they are met. But the distributions they are drawn from are known. Each quantity whose distribution reaches
far is followed to its ends, by normal scores, and the force of single asperities is computed there.
"""

import math
from dataclasses import replace

import numpy as np

from roughmdr.batch.moments import Moments
from roughmdr.batch.plan import Cell
from roughmdr.batch.realization import simulate_ensemble
from roughmdr.ensemble import Ensemble
from roughmdr.errors import RoughmdrError
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats

FIRST = 16  # realisations at least, before a standard error is believed at all
FEWEST = 4  # realisations of what costs more: its standard error is enough where it is 6 times too small
_SCORE_99 = 2.326  # normal score of 99 %, the fraction of cases in which the true standard error is to be met
_ADDED_FRACTION = 0.7  # share of the realisations that seem to be missing, run before the next look
_MIN_GROWTH, _MAX_GROWTH = 0.02, 4  # from one look to the next: realisations added over present; after over before
_MAX_RATIO = 1e3  # error over the error asked for, above which more than _MAX_GROWTH is missing in any case
_SCORES = np.arange(-8.0, 9.0)  # draws reach 8.2
_FINE_SCORES = np.linspace(-8.0, 8.0, 1025)
_WEIGHTS = np.exp(-0.5 * _FINE_SCORES**2) * ((_FINE_SCORES[1] - _FINE_SCORES[0]) / math.sqrt(2.0 * math.pi))
_PER_SCORE = 8  # asperities at a score, whose other quantities are evenly spread
_EXPECTED_IF_MET = -math.log(0.01)  # where so many asperities are expected, at least one is met in 99 % of cases


def relative_error(moments: Moments, unmet: Floats | float = 0.0, *, over_range: bool = False) -> float:
    """Return the largest standard error of the mean force [step] over its largest magnitude; inf without any force.

    ``unmet`` is the spread that asperities that were not met would add to that of a realisation [N], [step]. A
    separation, which has no natural zero, is taken ``over_range``: over the range of its mean. Steps where some
    realisations have none do not count.
    """
    known = ~np.isnan(moments.mean)
    if not known.any():
        return math.inf
    mean = moments.mean[known]
    largest = float(np.ptp(mean)) if over_range else float(np.max(np.abs(mean)))
    error = float(np.max(np.hypot(moments.standard_error, unmet / math.sqrt(moments.size))[known]))
    return error / largest if largest > 0.0 else math.inf


def error_at(moments: Moments, step: int, unmet: Floats | float = 0.0, *, absolute: bool) -> float:
    """Return the standard error of a mean at a step, over its magnitude unless it is ``absolute``; inf without any.

    ``unmet`` is as in ``relative_error``.
    """
    mean = float(moments.mean[step])
    error = float(np.hypot(moments.standard_error, unmet / math.sqrt(moments.size))[step])
    scale = 1.0 if absolute else abs(mean)
    return error / scale if scale > 0.0 and not math.isnan(mean) else math.inf


def bound(count: int) -> float:
    """Return the factor by which the true standard error may exceed that of ``count`` normal realisations.

    It is exceeded in 1 % of cases: chi-squared distribution (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17
    (1931) 684).
    """
    a = 2.0 / (9.0 * (count - 1))
    root = 1.0 - a - _SCORE_99 * math.sqrt(a)
    return root**-1.5 if root > 0.0 else math.inf


def is_enough(count: int, error: float, asked: float) -> bool:
    """Return whether ``count`` realisations with this ``error`` meet the error ``asked`` for."""
    return error * bound(count) <= asked


def missing_count(count: int, error: float, asked: float) -> float:
    """Estimate how many more realisations are needed, where ``count`` with this ``error`` are not enough."""
    ratio = min(error / asked, _MAX_RATIO)
    needed = float(max(count, FIRST))  # of fewer the bound can be infinite
    for _ in range(4):  # the bound comes down as the count goes up
        needed = max(count * (ratio * bound(math.ceil(needed))) ** 2, count + 1.0)
    return needed - count


def next_count(count: int, error: float, asked: float, most: int) -> int:
    """Return how many realisations of ``most`` to look at next, where ``count`` have this ``error``.

    It is ``count`` for no more.
    """
    if count >= most or is_enough(count, error, asked):
        return count
    added = max(_ADDED_FRACTION * missing_count(count, error, asked), _MIN_GROWTH * count, 1.0)
    return min(count + math.ceil(added), _MAX_GROWTH * count, most)


class RareAsperities:
    """Forces of single asperities of a cell, by how rare they are."""

    def __init__(self, cell: Cell) -> None:
        section = cell.scene.asperities
        self._count, self._steps = section.expected_count, cell.steps
        self._per_force = _per_force(cell)
        try:
            self._squares = [_squares(cell, stream) for stream in section.heavy_tailed_streams]
        except (ArithmeticError, RuntimeError, ValueError):  # inverses of scipy fail so far out:
            self._squares = []  # a run that meets such an asperity fails, and says so

    def spread(self, realizations: int) -> Floats:
        """Return the spread, [step], from asperities that so many realisations may not have met.

        It is that of the force [N], on a lateral path the tangential one, or, under a dead load, of the separation [m].
        """
        from scipy.special import ndtri

        level = min(_EXPECTED_IF_MET / (realizations * self._count), 0.5)
        unmet = np.abs(_FINE_SCORES) >= -float(ndtri(level))
        spread = np.zeros(self._steps)
        for largest, squares in self._squares:
            spread = np.hypot(spread, largest * np.sqrt(self._count * (_WEIGHTS[unmet] @ squares[unmet])))
        return spread * self._per_force


def _per_force(cell: Cell) -> float | Floats:
    """Return what a force [N] at given separation changes, over that force: under a dead load the separation, by 1/k.

    Behind a spring of stiffness k_m the force itself changes by 1/(1 + k/k_m).
    """
    if not isinstance(cell.controlled, MachinePath):
        return 1.0
    ensemble = cell.scene.asperities.evenly_drawn(cell.scene.seed)
    independent = cell.scene.model_copy(update={"interaction": None})
    stiffness = simulate_ensemble(independent, cell.path, ensemble, ["stiffness"]).variables["stiffness"]
    machine = cell.controlled.machine
    total = np.abs(machine.slope(stiffness))
    per_force = machine.compliance if machine.is_dead_load else 1.0
    return np.where(total > 0.0, per_force / np.where(total > 0.0, total, 1.0), 0.0)


def _squares(cell: Cell, stream: int) -> tuple[float, Floats]:
    """Return the largest force [N] and, over its square, the squared distance of forces from their mean, where one
    quantity is at a score: [fine score, step].
    """
    from scipy.special import ndtr

    cell = cell._replace(scene=cell.scene.model_copy(update={"interaction": None}))  # they are alone
    ensembles = cell.scene.asperities.ensembles_at_levels(stream, ndtr(_SCORES), _PER_SCORE)
    force = np.array([[_force(cell, ensemble, number) for number in range(_PER_SCORE)] for ensemble in ensembles])
    largest = float(np.abs(force).max())
    force = force / (largest or 1.0)  # so that no square leaves the range of a float
    mean = _WEIGHTS @ _interpolate(force.mean(axis=1))
    with np.errstate(under="ignore"):
        return largest, np.exp(_interpolate(np.log(np.mean((force - mean) ** 2, axis=1) + np.finfo(float).tiny)))


def _interpolate(values: Floats) -> Floats:
    """Interpolate from the scores to the fine ones: [score, step] to [fine score, step]."""
    return np.array([np.interp(_FINE_SCORES, _SCORES, column) for column in values.T]).T


def _force(cell: Cell, ensemble: Ensemble, number: int) -> Floats:
    """Return the force of one asperity [N], [step]; 0 where no float holds it: a run that meets it says so."""
    one = slice(number, number + 1)
    parameters = {name: column[one] for name, column in ensemble.parameters.items()}
    alone = replace(ensemble, height=ensemble.height[one], parameters=parameters)
    path = cell.controlled.over(cell.path)  # the flat stands where usual asperities decide
    try:
        return simulate_ensemble(cell.scene, path, alone, [path.watched]).variables[path.watched]
    except RoughmdrError:
        return np.zeros(cell.steps)
