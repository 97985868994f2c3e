"""The memory of an ensemble of adhesive contacts: the staircase of the Preisach model.

A contact with summit z and pull-off at the indentation -d is made when the flat comes down to z and lost when it rises
above z + d. So it exists now if, for some earlier position b, the flat was at b <= z and since then never above
t < z + d. Only those pairs (b, t) matter that no other pair undercuts in both. They are the steps of a staircase that
grows and shrinks with the turning points of the path; loading and then unloading has one step. No asperity stores
anything.

Source: I. D. Mayergoyz, Mathematical Models of Hysteresis (1991), section 1.3.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats


class Staircase(NamedTuple):
    """For step m of a path, the pairs (bottom, top)[first[m]:first[m + 1]] [m]."""

    first: NDArray[np.int64]
    bottom: Floats
    top: Floats


def staircase(separation: Floats) -> Staircase:
    """Return the staircase at each step of a path that comes from infinity; separation is [m]."""
    lows, highs = list[float](), list[float]()
    first, bottom, top = [0], list[float](), list[float]()
    for h in separation.tolist():
        # Later pairs have higher bottoms and lower tops. A flat at h removes pairs with bottom >= h and lifts lower
        # tops to h; of pairs with equal tops the first remains.
        while lows and lows[-1] >= h:
            lows.pop()
            highs.pop()
        low = h
        while highs and highs[-1] <= h:
            low = lows.pop()
            highs.pop()
        lows.append(low)
        highs.append(h)
        bottom += lows
        top += highs
        first.append(len(bottom))
    return Staircase(np.array(first, dtype=np.int64), np.array(bottom), np.array(top))


def no_memory(separation: Floats) -> Staircase:
    """Return the staircase of contacts without memory: only the present position of the flat counts."""
    return Staircase(np.arange(separation.size + 1), separation, separation)


def risen(turns: Floats, separation: Floats) -> Staircase:
    """Return the staircase along a path by some turning points [m], the last of which is the lowest of a rise.

    After them it goes through the ascending separations of the rise [m].
    """
    before = staircase(turns)
    last = slice(before.first[-2], before.first[-1])
    bottom, top = before.bottom[last], before.top[last]  # the bottoms ascend, the tops descend
    if bottom.size == 1:
        count = np.ones(separation.size, dtype=np.int64)
        more_bottom, more_top = np.full(separation.size, bottom[0]), np.maximum(top[0], separation)
    else:
        higher = (top > separation[:, None]).sum(axis=1)  # pairs whose tops are above the flat
        count = np.minimum(higher + 1, bottom.size)
        kept = np.arange(bottom.size) < count[:, None]
        more_bottom = np.broadcast_to(bottom, kept.shape)[kept]
        more_top = np.maximum(top, separation[:, None])[kept]
    first = np.concatenate([before.first, before.first[-1] + np.cumsum(count)])
    return Staircase(first, np.concatenate([before.bottom, more_bottom]), np.concatenate([before.top, more_top]))
