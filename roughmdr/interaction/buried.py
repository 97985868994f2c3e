"""Summits that lie below the flank of a higher asperity: they are no part of the surface that all make together."""

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.neighbours import within_reach
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, FlatPunch, ProfileShape

_NEAREST = 1e-5  # of the side of the patch: 1/r^3 is then 1e15 times what is smooth on the patch
_DOUBLINGS, _HALVINGS = 200, 30


def drop(ensemble: Ensemble, i: NDArray[np.int64], r: Floats) -> Floats:
    """Return f(r) [m] of the asperities i at distances r [m]; infinite beyond the end of a profile."""
    kind, columns = SHAPES[ensemble.shape], ensemble.nondimensional()
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


def buried(ensemble: Ensemble, at: Floats, sides: Floats | None) -> NDArray[np.bool_]:
    """Return which summits lie below a flank; positions [asperity, 2] and ``sides`` of a patch that repeats [m].

    Of summits so near to each other that no digits are left of what tells them apart, all but the highest do.
    """
    height = ensemble.height
    hidden = np.zeros(height.size, dtype=np.bool_)
    for i, j, away in within_reach(at, reach(ensemble, height - height.min()), sides):
        lower = np.flatnonzero(height[j] < height[i])
        if not lower.size:
            continue
        flank = height[i[lower]] - drop(ensemble, i[lower], away[lower])
        hidden[j[lower][flank > height[j[lower]]]] = True
    if sides is not None:
        for i, j, away in within_reach(at, np.full(height.size, _NEAREST * sides.max()), sides):
            later = (away < _NEAREST * sides.max()) & (i < j)  # heights descend
            hidden[j[later & ~hidden[i]]] = True
    return hidden


def reach(ensemble: Ensemble, depth: Floats) -> Floats:
    """Return about the radius [m] at which the flank of each asperity is ``depth`` [m] below its summit, at least."""
    every = np.arange(ensemble.height.size)
    low, high = np.zeros(every.size), ensemble.nondimensional().width.copy()
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
