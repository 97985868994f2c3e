"""Bounds on parameters by the jumps of a law.

A jump lies between two measured steps, however uncertain it is by the standard errors of the parameters, if beyond one
of them the law would miss the load measured there by much more than the noise.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.fitting.jumps import jumps_at, nearest_in, places_of, projected
from roughmdr.fitting.model import Model
from roughmdr.fitting.search import Found
from roughmdr.numerics.arguments import Floats

_CERTAIN = 25.0  # least increase of the sum of squares beyond an edge, over the variance of the noise: five deviations
_BISECTIONS = 50  # halvings in the search for the multiple of a direction
_LARGEST = 1e9  # largest such multiple, over the least that may be long enough


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
    jumps = jumps_at(model, found.x) if model.jumps else None
    left = np.linalg.svd(found.slopes, full_matrices=False)[0]
    least = float(np.sum(np.square(found.deviations)))
    noise = float(np.mean(np.square(found.residuals))) if model.curve.error is None else 1.0
    if jumps is not None:
        places, slopes = places_of(model, here.jumps, jumps)
        ends = np.stack([places, 1.0 - places])
        for (side, jump), end in np.ndenumerate(np.maximum(ends, 0.0)):
            sign = (-1, 1)[side]
            next_one = np.array(here.jumps) + sign * (np.arange(places.size) == jump)
            beyond = nearest_in(model, here, tuple(next_one.tolist()), jumps)
            if beyond is None:
                continue
            # the least that parameters can reach there if the law is linear in them
            squares = np.sum(np.square(beyond.deviations)) - np.sum(np.square(left.T @ beyond.deviations))
            if squares - least > _CERTAIN * noise:
                edges.append((sign * slopes[jump], end))
            else:
                certain = False
    sides = np.array([side for side, _ in edges]).reshape(-1, found.x.size)
    return Edges(sides, np.array([end for _, end in edges]), certain)


def farthest(direction: Floats, radius: float, edges: Edges) -> float:
    """Return the largest direction . u of the vectors u within edges that are no longer than ``radius``.

    It is the point within the edges that is nearest to some multiple of the direction, and grows with that.
    """
    low = 0.5 * radius / float(np.linalg.norm(direction) or 1.0)
    high = _LARGEST * low
    for _ in range(_BISECTIONS):
        middle = float(np.sqrt(low * high))
        nearest = projected(middle * direction, edges.sides, edges.ends)
        low, high = (low, middle) if np.linalg.norm(nearest) > radius else (middle, high)
    return float(direction @ projected(low * direction, edges.sides, edges.ends))
