"""Ends of intervals that are not those of a parabola: at the jumps of a law, and by the profile of the sum of squares.

A jump lies between two measured steps, however uncertain it is by the standard errors of the parameters, if beyond one
of them the law would miss the load measured there by much more than the noise. The profile is the least sum of squares
over all other parameters.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.fitting.jumps import least_cost, nearest_in, places_of, projected
from roughmdr.fitting.model import Model
from roughmdr.fitting.search import Found
from roughmdr.fitting.slopes import slopes_of_jumps
from roughmdr.numerics.arguments import Floats

_OFF = 0.2  # deviation of the increase of the sum of squares from that of the parabola, over the latter
_SMALL = 1e-3  # reach in x over which any law is linear
_ITERATIONS, _LONGEST = 30, 1.0  # most iterations, and longest change of x in one
_TINY = np.finfo(float).tiny  # least square of a change of x that is divided by
_CONVERGED, _MET = 1e-4, 0.02  # relative change of the reach that ends them, and error of the increase there


def profiled(model: Model, found: Found, inverse: Floats, reach: Floats) -> Floats:
    """Return the reach [2, parameter] with the profile's where the parabola's, which is tried, is off.

    The profile ends where the sum of squares is as large as the parabola would be at its end. A ``reach`` that stays,
    for a jump cuts it or is uncertain, is negative; one at whose end the law has other jumps stays as well.
    """
    covariance, ends = np.asarray(inverse @ inverse.T), np.abs(reach)
    least, jumps = float(found.deviations @ found.deviations), model.point(found.x).jumps

    def is_apart(x: Floats) -> bool:
        return model.jumps and model.point(x).jumps != jumps

    for (side, i), width in np.ndenumerate(reach):
        if width > _SMALL:
            increase = float(width * width / covariance[i, i])
            ahead = (-1.0, 1.0)[side] * width * covariance[i] / covariance[i, i]
            there = np.clip(found.x + ahead, *model.bounds)
            off = abs(model.point(there).cost - least - increase)
            if not (off < _OFF * increase or is_apart(there)):
                end = _end(model, found, i, ahead, (least + increase, _MET * increase))
                if end is not None and not is_apart(end):
                    ends[side, i] = abs(end[i] - found.x[i])
    return ends


def _end(model: Model, found: Found, i: int, ahead: Floats, goal: tuple[float, float]) -> Floats | None:
    """Return the x with the farthest x[i] where the sum of squares is the goal, within an error, or at its bound.

    D. J. Venzon, S. H. Moolgavkar (1988), Applied Statistics 37, 87, with the linearised law; None where that fails.
    """
    (low, high), x, longest = model.bounds, found.x, _LONGEST
    last, slopes = found.deviations, found.slopes
    step = ahead
    for _ in range(_ITERATIONS):
        trial = np.clip(x + step * min(longest / np.abs(step).max(), 1.0), low, high)
        deviations = model.point(trial).deviations
        if not np.isfinite(deviations).all():
            longest *= 0.5
            continue
        done = abs(trial[i] - x[i]) <= _CONVERGED * abs(trial[i] - found.x[i])
        change, x, excess = trial - x, trial, float(deviations @ deviations) - goal[0]
        if (done and abs(excess) < goal[1]) or (excess < 0.0 and x[i] in (low[i], high[i])):
            return np.asarray(x)
        missed = deviations - last - slopes @ change
        slopes, last = slopes + np.outer(missed, change / max(float(change @ change), _TINY)), deviations
        held = np.zeros(x.size, dtype=bool)
        for _ in x:
            inverse = np.linalg.pinv(np.where(held, 0.0, slopes))
            step, covariance = -inverse @ deviations, inverse @ inverse.T
            if not covariance[i, i] > 0.0:
                return None
            rest = goal[0] - float(np.sum(np.square(deviations + slopes @ step)))
            step += np.sign(ahead[i]) * np.sqrt(max(rest, 0.0) / covariance[i, i]) * covariance[i]
            held |= np.where(step < 0.0, x <= low, x >= high) & (step != 0.0) & (np.arange(x.size) != i)
    return None


_CERTAIN = 25.0  # least increase of the sum of squares beyond an edge, over the variance of the noise: five deviations
_FARTHEST = float(
    np.log(1e9)
)  # largest logarithm of the multiple of a direction over the least that may be long enough


class Edges(NamedTuple):
    """Bounds of the changes of x: sides @ change <= ends."""

    sides: Floats
    """[edge, parameter]"""
    ends: Floats
    """[edge], at least 0."""
    certain: bool = True
    """Whether there is an edge wherever a jump could pass a measured step."""


def certain_edges(model: Model, found: Found) -> Edges:
    """Return the edges of the interval between jumps beyond which the law misses a load by much more than the noise."""
    here, edges, certain = model.point(found.x), list[tuple[Floats, float]](), True
    by_each = slopes_of_jumps(model, found.x) if model.jumps else None
    least = float(np.sum(np.square(found.deviations)))
    noise = float(np.mean(np.square(found.residuals))) if model.curve.error is None else 1.0
    if by_each is not None:
        places, slopes = places_of(model, here.jumps, here, by_each)
        ends = np.stack([places, 1.0 - places])
        for (side, jump), end in np.ndenumerate(np.maximum(ends, 0.0)):
            sign = (-1, 1)[side]
            interval = tuple((np.array(here.jumps) + sign * (np.arange(places.size) == jump)).tolist())
            beyond = nearest_in(model, here, interval, by_each)
            if beyond is None:
                continue
            # the least that parameters can reach there if the law is linear in them
            if least_cost(found.slopes, beyond.deviations) - least > _CERTAIN * noise:
                edges.append((sign * slopes[jump], end))
            else:
                certain = False
    sides = np.array([side for side, _ in edges]).reshape(-1, found.x.size)
    return Edges(sides, np.array([end for _, end in edges]), certain)


def farthest(direction: Floats, radius: float, edges: Edges) -> float:
    """Return the largest direction . u of the vectors u within edges that are no longer than ``radius``.

    It is the point within the edges that is nearest to some multiple of the direction, and grows with that.
    """
    from scipy.optimize import brentq

    def nearest(multiple: float) -> Floats:
        return projected(np.exp(multiple) * direction, edges.sides, edges.ends)

    low = float(np.log(0.5 * radius / (np.linalg.norm(direction) or 1.0)))
    high = low + _FARTHEST
    if np.linalg.norm(nearest(high)) > radius:
        high = brentq(lambda multiple: np.linalg.norm(nearest(multiple)) - radius, low, high)
    return float(direction @ nearest(high))
