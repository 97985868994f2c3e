"""The search for the parameters of least squares: from the start of the scene, and if need be from others."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roughmdr.fitting.model import Model
from roughmdr.fitting.residuals import is_systematic, relative_rms
from roughmdr.numerics.arguments import Floats

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

_FTOL, _XTOL, _GTOL, _MAX_STEPS = 1e-10, 1e-7, 1e-12, 60
_STARTS, _TRIED = 16, 3  # other starts a parameter, and how many of them are followed
_REACH, _CLOSER, _MAX_ROUNDS = 3.0, 0.25, 12  # standard errors within which jumps are sought, at first and closer
_FRACTIONS = np.array([-1.0, -0.5, -0.25, -0.125, 0.125, 0.25, 0.5, 1.0])
_FLAT = 1e-6  # of the largest slope: smaller ones tell no standard error
_AT_REST = 1e-4  # slope of the sum of squares, over the sum itself, in standard errors
_POOR = 0.05  # of the largest load: a fit with a larger deviation is sought from elsewhere too


class Found(NamedTuple):
    """The parameters of least squares."""

    x: Floats
    deviations: Floats
    slopes: Floats
    """Derivatives of the deviations: [step, parameter]."""
    converged: bool


def search(model: Model) -> Found:
    """Return the parameters of least squares; RoughmdrError where no start has a law.

    Where the deviations from the start of the scene are systematic or large, other starts around it are tried. On a
    machine, whose law takes longer, that is done at the separations which the measured force means.
    """
    if model.curve.control == "separation":
        found = _search(model)
    else:
        with model.at_measured_separations():
            near = _search(model)
        found = _follow(model, near.x)
    return _settled(model, found) if model.jumps else found


def _search(model: Model) -> Found:
    start = np.zeros(len(model.parameters))
    found = [_follow(model, start)] if np.isfinite(model.deviations(start)).all() else []
    if not found or _is_poor(model, found[0]):
        starts = _other_starts(model)
        costs = [float(np.sum(np.square(model.deviations(x)))) for x in starts]
        best = [starts[i] for i in np.argsort(costs)[:_TRIED] if np.isfinite(costs[i])]
        if not best and not found:
            raise model.last_error
        found += [_follow(model, x) for x in best]
    return min(found, key=_cost)


def _cost(found: Found) -> float:
    return float(np.sum(np.square(found.deviations)))


def _settled(model: Model, found: Found) -> Found:
    """Return the least squares within a few standard errors of where the search by slopes has ended.

    Where contacts jump, the sum of squares does so too as a jump passes a measured step: slopes do not see it beyond
    the next step, and cannot follow its edge.
    """
    reach = _REACH
    for _ in range(_MAX_ROUNDS):
        left, sizes, right = np.linalg.svd(found.slopes, full_matrices=False)
        axes = right.T * np.sqrt(_cost(found) / found.deviations.size) / np.maximum(sizes, _FLAT * sizes[0])
        profiles = axes @ (axes.T / np.linalg.norm(axes, axis=1))
        low, high = np.transpose([parameter.bounds for parameter in model.parameters])
        ways = np.outer(_FRACTIONS, np.concatenate([axes, profiles], axis=1).T.ravel()).reshape(-1, found.x.size)
        trials = np.clip(found.x + reach * ways, low, high)
        costs = [float(np.sum(np.square(model.deviations(x)))) for x in trials]
        if min(costs) < (1.0 - _FTOL) * _cost(found):
            found = _follow(model, trials[int(np.argmin(costs))])
        elif np.linalg.norm(left.T @ found.deviations) < _AT_REST * np.linalg.norm(found.deviations):
            break
        else:
            reach *= _CLOSER
    return found


def _is_poor(model: Model, found: Found) -> bool:
    return is_systematic(found.deviations) or relative_rms(model.curve, found.deviations) > _POOR


def _follow(model: Model, start: Floats) -> Found:
    """Return where least squares lead to from a start; RoughmdrError where that has no law."""
    from scipy.optimize import least_squares

    if not np.isfinite(model.deviations(start)).all():
        raise model.last_error

    low, high = np.transpose([parameter.bounds for parameter in model.parameters])
    result: OptimizeResult = least_squares(
        model.deviations,
        np.clip(start, low, high),
        jac=model.slopes,
        bounds=(low, high),
        ftol=_FTOL,
        xtol=_XTOL,
        gtol=_GTOL,
        max_nfev=_MAX_STEPS,
    )
    return Found(result.x, result.fun, result.jac, result.status > 0)


def _other_starts(model: Model) -> Floats:
    """Return starts spread evenly, [start, parameter]."""
    from scipy.stats.qmc import Halton

    count = len(model.parameters)
    low, high = np.transpose([parameter.nearby for parameter in model.parameters])
    spread = Halton(count, scramble=False).random(_STARTS * count + 1)[1:]
    return np.asarray(low + (high - low) * spread)
