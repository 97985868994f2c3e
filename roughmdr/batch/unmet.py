"""Asperities so rare that draws may not have met any, and what they add to the spread of the force.

A sample tells nothing of what it has not met: where a few asperities carry most of the spread, that of the draws is too
small until they are met. But the distributions they are drawn from are known. Each quantity whose distribution reaches
far is followed to its ends, by normal scores, and the force of single asperities is computed there.
"""

import math
from dataclasses import replace

import numpy as np

from roughmdr.batch.plan import Cell
from roughmdr.batch.realization import simulate_ensemble
from roughmdr.ensemble import Ensemble
from roughmdr.errors import RoughmdrError
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats

_SCORES = np.arange(-8.0, 9.0)  # draws reach 8.2
_FINE_SCORES = np.linspace(-8.0, 8.0, 1025)
_WEIGHTS = np.exp(-0.5 * _FINE_SCORES**2) * ((_FINE_SCORES[1] - _FINE_SCORES[0]) / math.sqrt(2.0 * math.pi))
_PER_SCORE = 8  # asperities at a score, whose other quantities are evenly spread
_EXPECTED_IF_MET = -math.log(0.01)  # where so many asperities are expected, at least one is met in 99 % of cases


class RareAsperities:
    """Forces of single asperities of a cell, by how rare they are."""

    def __init__(self, cell: Cell) -> None:
        section = cell.scene.asperities
        self._count, self._steps = section.expected_count, cell.steps
        self._per_force = _per_force(cell)
        try:
            self._squares = [_squares(cell, stream) for stream in section.heavy_tailed_streams]
        except (ArithmeticError, RuntimeError, ValueError):  # of scipy, whose inverses fail so far out:
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
