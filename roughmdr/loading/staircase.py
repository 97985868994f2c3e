"""What an ensemble of adhesive contacts remembers of the path: the staircase of the Preisach model.

A contact with summit z and fold -d is made when the flat comes down to z and lost when it rises above z + d. So at any
moment it is held if, for some earlier position b, the flat was at b <= z and since then never above t < z + d. Of all
the pairs (b, t) only those count that no other pair beats in both; they are the steps of a staircase that grows and
shrinks with the turning points of the path. A straight way in and out has one step, and no asperity stores anything.

Source: I. D. Mayergoyz, Mathematical Models of Hysteresis (1991), section 1.3.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats


class Staircase(NamedTuple):
    """For step m of a path, the pairs (bottom, top)[first[m]:first[m + 1]]."""

    first: NDArray[np.int64]
    bottom: Floats
    top: Floats


def staircase(separation: Floats) -> Staircase:
    """The staircase at each step of a path that comes from infinity; separation is [m]."""
    steps: list[tuple[float, float]] = []
    first, bottom, top = [0], [], []
    for h in separation.tolist():
        # Later steps have higher bottoms and lower tops: a low flat wipes them out, a high one levels them.
        while steps and steps[-1][0] >= h:
            steps.pop()
        lifted = [(low, max(high, h)) for low, high in steps]
        steps = [pair for i, pair in enumerate(lifted) if i == 0 or pair[1] < lifted[i - 1][1]]
        if not steps or steps[-1][1] > h:
            steps.append((h, h))
        bottom += [low for low, _ in steps]
        top += [high for _, high in steps]
        first.append(len(bottom))
    return Staircase(np.array(first, dtype=np.int64), np.array(bottom), np.array(top))


def no_memory(separation: Floats) -> Staircase:
    """The staircase of contacts without memory: only where the flat is now counts."""
    return Staircase(np.arange(separation.size + 1), separation, separation)
