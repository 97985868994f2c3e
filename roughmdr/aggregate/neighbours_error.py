"""The error of independent asperities of an ensemble, from their distances along a path."""

import math
from collections.abc import Callable

import numpy as np

from roughmdr.aggregate import totals
from roughmdr.aggregate.mean_field import mean_inverse_distance
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.placed import sides_of
from roughmdr.loading.path import LoadingPath
from roughmdr.model_error.interaction import FEW, error_by_distances, error_of_few, interaction_error
from roughmdr.numerics.arguments import Floats

_HALVINGS = 12
"""Number of contact areas, each half the one before, at which the pairs of a path are summed."""


def are_few(ensemble: Ensemble) -> bool:
    """Return whether asperities are few and stand on a half-space that they alone deform."""
    return ensemble.origin == "asperities" and not ensemble.goes_on and ensemble.height.size <= FEW


def neighbours_error(
    ensemble: Ensemble, path: LoadingPath, total: Floats, radius_at: Callable[[float], Floats]
) -> Floats | None:
    """Return the error of the force at each step [1]; None where it follows from the contact fraction alone.

    ``total`` [row, step] has the area, that of few the count as well; ``radius_at`` returns the contact radius of each
    asperity [m] at a separation [m] that the flat has come down to. Positions show crowds, whose force is too high;
    without them the contact fraction gives the error. That of few asperities is by their distances, known or expected.
    """
    sides, few = sides_of(ensemble), are_few(ensemble)
    placed = {"x", "y"} <= ensemble.positions.keys()
    if ensemble.origin != "asperities" or ensemble.nominal_area is None or sides is None or not (few or placed):
        return None
    area, count = total[totals.AREA], total[totals.COUNT]
    if not placed:
        return error_of_few(area, count, count - 1.0, mean_inverse_distance(*sides))
    found = [(0.0, 0.0)]
    for step in _states(area[: int(np.argmin(path.separation)) + 1]):
        radius = radius_at(float(path.separation[step]))
        load = ensemble.relative_loads(radius) if radius.any() else radius
        on = load > 0.0  # not so a flat that only touches
        at = np.column_stack([ensemble.positions[name][on] for name in ("x", "y")])
        error = error_by_distances(radius[on], load[on], at, None if few else np.array(sides)) if on.any() else 0.0
        found.append((math.sqrt(area[step]), max(error, 0.0)))
    roots, errors = np.transpose(sorted(found))
    by_root = np.asarray(np.interp(np.sqrt(area), roots, errors))
    return by_root if few else np.maximum(by_root, interaction_error(area / ensemble.nominal_area))


def _states(area: Floats) -> list[int]:
    """Return the steps of a loading at which its growing contact area passes one half, one fourth ... of the last."""
    growing = np.maximum.accumulate(area)
    if not growing[-1] > 0.0:
        return []
    found = np.searchsorted(growing, growing[-1] * 0.5 ** np.arange(_HALVINGS))
    return [int(step) for step in np.unique(np.append(found, np.argmax(growing > 0.0)))]
