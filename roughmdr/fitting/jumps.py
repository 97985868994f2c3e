"""Least squares of a law whose contacts jump: beside a measured step, or beyond it.

As a jump of the law passes a measured step, the sum of squares jumps as well. So it has a minimum for each interval
between steps, and where the noise draws the minimum of the smooth part out of the interval, the least lies at its edge.
Parameters are counted in standard errors here, u, in which the smooth part is a sphere about its minimum: the least
squares are at the point of the interval that is nearest to that.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

_REACH = 3.0  # standard errors within which other intervals are sought
_FRACTIONS = np.array([-1.0, -0.5, -0.25, -0.125, 0.125, 0.25, 0.5, 1.0])  # places where they are sought, in reaches
_FLAT = 1e-6  # slope over the largest one, below which it tells no standard error
_AT_REST = 1e-4  # standard errors to the minimum of the smooth part, where the search by slopes has reached it
_INSIDE = 1e-6  # standard errors from an edge, on the near side of it
_ROUGHLY = 1e-4  # standard errors to which an edge is found where only its direction is asked for
_APART = 0.05  # standard errors between places at which an edge is looked for, which tell its direction
_MAX_EDGES = 3  # edges at which the nearest point may lie
_LEAST_JUMP = 10.0  # least change of the sum of squares at an edge, over the variance of a deviation

Cost = Callable[[Floats], float]
"""Returns the sum of squares at a point u, over the variance of a deviation."""


class Surroundings(NamedTuple):
    """The parameters about the end of a search by slopes, in standard errors."""

    axes: Floats
    """x = middle + axes u."""
    goal: Floats
    """The minimum of the smooth part, u."""
    variance: float
    """Variance of a deviation."""

    @classmethod
    def of(cls, deviations: Floats, slopes: Floats) -> "Surroundings":
        """Return those of deviations and their slopes [step, parameter]."""
        left, sizes, right = np.linalg.svd(slopes, full_matrices=False)
        variance = float(np.mean(np.square(deviations)))
        errors = np.sqrt(variance) / np.maximum(sizes, _FLAT * sizes[0])
        return cls(right.T * errors, -(left.T @ deviations) * (sizes / variance) * errors, variance)

    @property
    def at_rest(self) -> bool:
        """Whether the minimum of the smooth part is reached."""
        return bool(np.linalg.norm(self.goal) < _AT_REST)

    def around(self) -> Floats:
        """Return points in which other intervals may lie: on the axes, and where one parameter is off: [point, u]."""
        profiles = self.axes.T / np.linalg.norm(self.axes, axis=1)
        ways = np.concatenate([np.eye(self.goal.size), profiles.T])
        return np.asarray((_REACH * _FRACTIONS[:, None, None] * ways).reshape(-1, self.goal.size))


def nearest_within(cost: Cost, goal: Floats) -> Floats:
    """Return the point that is nearest to ``goal`` without a jump between it and 0."""
    here, normals, ends = np.zeros_like(goal), list[Floats](), list[float]()
    for _ in range(_MAX_EDGES):
        aim = _projected(goal, normals, ends)
        way = float(np.linalg.norm(aim - here))
        if way < _INSIDE:
            break
        ahead = (aim - here) / way
        level = cost(here)
        if cost(aim) <= level:
            return aim
        far = _edge(cost, here, ahead, level, (0.0, way), _INSIDE)
        jump = cost(here + (far + 2.0 * _INSIDE) * ahead) - level
        if jump < _LEAST_JUMP:
            break
        limit = level + 0.5 * jump
        normal = ahead.copy()
        for side in np.linalg.svd(ahead[None])[2][1:]:
            apart = _edge(cost, here + _APART * side, ahead, limit, (far - 1.0, far + 1.0), _ROUGHLY)
            normal -= (apart - far) / _APART * side
        normal /= np.linalg.norm(normal)
        normals.append(normal)
        ends.append(float(normal @ (here + far * ahead)) - _INSIDE)
        here = here + max(far - _INSIDE, 0.0) * ahead
    return here


def _edge(cost: Cost, start: Floats, ahead: Floats, limit: float, between: tuple[float, float], error: float) -> float:
    """Return the distance ahead of a point up to which the cost is within a limit, by bisection to an error."""
    low, high = between
    while high - low > error:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if cost(start + middle * ahead) > limit else (middle, high)
    return low


def _projected(goal: Floats, normals: list[Floats], ends: list[float]) -> Floats:
    """Return the point nearest to ``goal`` with normal . u <= end for each edge.

    C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), chapter 23: least distance programming.
    """
    if not normals:
        return goal
    from scipy.optimize import nnls

    sides = np.array(normals)
    excess = sides @ goal - np.array(ends)
    last = np.zeros(goal.size + 1)
    last[-1] = 1.0
    multipliers, _ = nnls(np.vstack([-sides.T, excess]), last)
    rest = np.append(-sides.T @ multipliers, float(excess @ multipliers) - 1.0)
    return np.asarray(goal - rest[:-1] / rest[-1])
