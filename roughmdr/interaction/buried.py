"""Summits that lie below the flank of a higher asperity: they are no part of the surface that all make together."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.neighbours import within_reach
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, FlatPunch, ProfileShape

_NEAREST = 1e-5  # least distance, over the side of the patch: 1/r^3 is then 1e15 times its smooth part
_DOUBLINGS, _HALVINGS = 200, 30
_SEARCHED = 4.0
"""Radius up to which a hidden flank is looked for, over that at which a flank is as low as the lowest summit."""


def drop(ensemble: Ensemble, i: NDArray[np.int64], r: Floats) -> Floats:
    """Return f(r) [m] of the asperities i at distances r [m]; infinite beyond the end of a profile."""
    kind, columns = SHAPES[ensemble.shape], ensemble.columns
    width, rise = columns.width[i], columns.rise[i]
    with np.errstate(over="ignore", invalid="ignore"):
        if kind is FlatPunch:
            return np.where(r < width, 0.0, np.inf)
        if issubclass(kind, ProfileShape):
            from roughmdr.shapes.evaluate import f_and_slopes

            profile = kind.profile if ensemble.shared_profile is None else ensemble.shared_profile.profile
            params = (
                np.broadcast_to(columns.params[0], (i.size, columns.params.shape[1]))
                if kind.shared
                else columns.params[i]
            )
            ends = profile.end * width
            inside = np.minimum(r, 0.5 * ends if np.isinf(profile.end) else ends)
            return np.where(r <= ends, f_and_slopes(profile, kind.name, (width, rise, params), inside)[0], np.inf)
        return np.asarray(rise * (r / width) ** columns.params[i])


class Buried(NamedTuple):
    """Summits that lie below a flank, and from where on they are part of the surface."""

    hidden: NDArray[np.bool_]
    emerging: Floats
    """The radius [m] at which the flank of a hidden summit comes out of that of each asperity, the least; inf for none:
    a larger contact is no disc."""

    @classmethod
    def none(cls, count: int) -> "Buried":
        """Return that none of so many is below another."""
        return cls(np.zeros(count, dtype=np.bool_), np.full(count, np.inf))


def buried(ensemble: Ensemble, at: Floats, sides: Floats | None) -> Buried:
    """Return which summits lie below a flank; positions [asperity, 2] and ``sides`` of a patch that repeats [m].

    Of summits so near to each other that no digits are left of what tells them apart, all but the highest do.
    """
    height = ensemble.height
    hidden, emerging = np.zeros(height.size, dtype=np.bool_), np.full(height.size, np.inf)
    farthest = reach(ensemble, height - height.min())
    for i, j, away in within_reach(at, farthest, sides):
        lower = np.flatnonzero(height[j] < height[i])
        if lower.size:
            lower = lower[height[i[lower]] - drop(ensemble, i[lower], away[lower]) > height[j[lower]]]
        if lower.size:
            hidden[j[lower]] = True
            out = _emerging(ensemble, i[lower], j[lower], away[lower], farthest[i[lower]])
            np.minimum.at(emerging, i[lower], out)
    if sides is not None:
        for i, j, away in within_reach(at, np.full(height.size, _NEAREST * sides.max()), sides):
            later = (away < _NEAREST * sides.max()) & (i < j)  # heights descend
            hidden[j[later & ~hidden[i]]] = True
    return Buried(hidden, emerging)


def _emerging(ensemble: Ensemble, i: NDArray[np.int64], j: NDArray[np.int64], away: Floats, farthest: Floats) -> Floats:
    """Return the radius about i, towards j and beyond, where the flank of j comes out; inf where it does not."""

    def above(r: Floats) -> NDArray[np.bool_]:
        with np.errstate(invalid="ignore"):
            flank = ensemble.height[i] - drop(ensemble, i, r)
            return np.asarray(ensemble.height[j] - drop(ensemble, j, np.abs(r - away)) > flank)

    low, high = away, _SEARCHED * farthest
    never = ~above(high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        higher = above(middle)
        low, high = np.where(higher, low, middle), np.where(higher, middle, high)
    return np.where(never, np.inf, high)


def reach(ensemble: Ensemble, depth: Floats) -> Floats:
    """Return about the radius [m] at which the flank of each asperity is ``depth`` [m] below its summit, at least."""
    every = np.arange(ensemble.height.size)
    low, high = np.zeros(every.size), ensemble.columns.width.copy()
    for _ in range(_DOUBLINGS):
        above = drop(ensemble, every, high) < depth
        if not above.any():
            break
        low, high = np.where(above, high, low), np.where(above, 2.0 * high, high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        above = drop(ensemble, every, middle) < depth
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.where(depth > 0.0, high, 0.0)
