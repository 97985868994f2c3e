"""How a quantity that is asked for is computed: by which method, and how far its mean may be off."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from roughmdr.model_error.at_given import FORCES, NUMBERS, STATED, errors_at
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.asked import Asked
from roughmdr.stages.reference import OF_AREA
from roughmdr.variables import WITH_MODEL_ERROR

_SCORE, _BELOW = 2.0, 0.97725
"""Standard errors [1] that a mean lies within of the true one in 95 % of cases, and the share of cases below."""


class Choice(NamedTuple):
    """The method by which a quantity is computed that a scene asks for."""

    of: Asked
    variable: str
    """The variable of the result that answers."""
    step: int
    """Step of the path at which it does."""
    lines: tuple[str, ...]
    """The choice in words."""

    def standard_error(self, model_error: float) -> float:
        """Return the standard error of the mean that is left beside an error by the model; as large, where none is."""
        left = self.of.tolerance - model_error
        return (left if left > 0.0 else max(model_error, self.of.tolerance)) / _SCORE

    def drawn(self, standard_error: float, realizations: float) -> float:
        """Return the error of a mean by its draws, which few of them tell less well: by Student's distribution."""
        from scipy.special import stdtrit

        return float(stdtrit(realizations - 1.0, _BELOW)) * standard_error

    def numerical(self, told: Mapping[str, Any], law: Mapping[str, Floats]) -> float:
        """Return the numerical error of an expected law in the quantity: relative [1], of a separation [m]."""
        force, stiffness = law["force"][self.step], law["stiffness"][self.step]
        of_force = float(told["numerical_error"]) * float(np.nanmax(np.abs(law["force"])))
        scale = float(stiffness) if self.of.absolute else abs(float(force))
        return of_force / scale if scale > 0.0 else math.nan

    def model_error(self, told: Mapping[str, Any], law: Mapping[str, Floats]) -> float:
        """Return the error by the model: relative [1], of a separation [m]; NaN where it is not known.

        ``told`` are diagnostics of runs by name, ``law`` their variables [step]. Boundary elements have the error of
        their grid, and take slopes for small as asperities do.
        """
        if self.variable == self.of.quantity:
            return _of_asperities(told, law, self.step, self.of)
        here = {name: values[self.step] for name, values in law.items()}
        of_grid, of_slopes = here["reference_error"], float(told["slope_error"])
        if self.of.absolute:
            return float(of_grid + of_slopes) * length(here["reference_force"], here["reference_stiffness"])
        of_area = OF_AREA[self.variable] * here["reference_area_error"]
        return float(of_area + of_slopes + (0.0 if self.of.given in FORCES else of_grid))


def length(force: float, stiffness: float) -> float:
    """Return how far the separation is off [m] for a relative error of the force; NaN without contact."""
    return abs(float(force)) / float(stiffness) if stiffness > 0.0 else math.nan


def _of_asperities(told: Mapping[str, Any], law: Mapping[str, Floats], step: int, of: Asked) -> float:
    """Return the error of the model in the law of asperities, at a step: relative [1], of a separation [m]."""
    unknown, names = np.full(1, np.nan), [name for name in WITH_MODEL_ERROR if name in law]
    here = [law[name][step : step + 1] for name in names]
    changes = [np.diff(law[name][step - 1 : step + 1]) if step else unknown for name in names]
    force = law["force"]
    extremes = np.array([np.nanmax(np.abs(force))]), np.array([max(-np.nanmin(force), 0.0)])
    kept = (law[name][step : step + 1] if name in law else unknown for name in ("contact_fraction", STATED))
    numbers = [np.array([told.get(name, np.nan)], dtype=np.float64) for name in NUMBERS]
    errors = errors_at(*kept, *extremes, *here, *changes, *numbers, names=names, given=of.given)
    found, value = (float(each[names.index(of.quantity)][0]) for each in (errors, here))
    return found if of.absolute else found / abs(value) if value != 0.0 else math.nan
