"""Asperities so rare that draws need not have met any, and what they add to the spread of the force.

A sample tells nothing of what it has not met: where a few asperities bear most of the spread, that of the draws is too
small until they are met. But the law they are drawn from is known. Each quantity that reaches far is followed to its
ends, by normal scores, and the force of single asperities is found there.
"""

import math
from dataclasses import replace

import numpy as np

from roughmdr.aggregate import compute
from roughmdr.batch.plan import Cell
from roughmdr.ensemble import Ensemble
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats

_SCORES = np.arange(-8.0, 9.0)  # draws reach 8.2
_FINE = np.linspace(-8.0, 8.0, 1025)
_WEIGHTS = np.exp(-0.5 * _FINE**2) * ((_FINE[1] - _FINE[0]) / math.sqrt(2.0 * math.pi))
_EACH = 8  # asperities at a score, whose other quantities are evenly spread
_MET = -math.log(0.01)  # of asperities of which so many are expected, at least one is met in 99 % of cases


class Rare:
    """How much single asperities of a cell bear, by how rare they are."""

    def __init__(self, cell: Cell) -> None:
        section = cell.scene.asperities
        self._count, self._steps = section.expected_count, cell.path.separation.size
        try:
            found = [_squares(cell, stream) for stream in section.heavy_tailed_streams]
        except (ArithmeticError, RuntimeError, ValueError):  # of scipy, whose inverse leads nowhere so far out:
            found = []  # a run that meets such an asperity fails, and says so
        self._squares = found

    def spread(self, realizations: int) -> Floats:
        """Of the force of a realisation [N], [step]: what those add that so many need not have met."""
        from scipy.special import ndtri

        level = min(_MET / (realizations * self._count), 0.5)
        unmet = np.abs(_FINE) >= -float(ndtri(level))
        spread = np.zeros(self._steps)
        for largest, squares in self._squares:
            spread = np.hypot(spread, largest * np.sqrt(self._count * (_WEIGHTS[unmet] @ squares[unmet])))
        return spread


def _squares(cell: Cell, stream: int) -> tuple[float, Floats]:
    """The largest force [N], and over its square that of the distance of forces from their mean, one quantity at a
    score: [fine score, step].
    """
    from scipy.special import ndtr

    made = cell.scene.asperities.ensembles_at_levels(stream, ndtr(_SCORES), _EACH)
    force = np.array([[_force(cell, ensemble, number) for number in range(_EACH)] for ensemble in made])
    largest = float(np.abs(force).max())
    force = force / (largest or 1.0)  # so that no square leaves the range of a float
    mean = _WEIGHTS @ _between(force.mean(axis=1))
    with np.errstate(under="ignore"):
        return largest, np.exp(_between(np.log(np.mean((force - mean) ** 2, axis=1) + np.finfo(float).tiny)))


def _between(values: Floats) -> Floats:
    """From values at the scores those at the fine ones: [score, step] to [fine score, step]."""
    return np.array([np.interp(_FINE, _SCORES, column) for column in values.T]).T


def _force(cell: Cell, ensemble: Ensemble, number: int) -> Floats:
    """Of one asperity [N], [step]; 0 where no float holds it: a run that meets it says so."""
    one = slice(number, number + 1)
    parameters = {name: column[one] for name, column in ensemble.parameters.items()}
    alone = replace(ensemble, height=ensemble.height[one], parameters=parameters)
    scene, path = cell
    try:
        return compute(
            alone, path, effective_modulus=scene.effective_modulus, adhesion=scene.adhesion_model, variables=["force"]
        ).variables["force"]
    except RoughmdrError:
        return np.zeros(path.separation.size)
