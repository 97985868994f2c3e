"""About the error of the force that contacts near to each other leave in their coupling.

Where they do not overlap it falls off as a power of their distance: what an order leaves out. Where they do, it grows
with how far they reach into each other. A contact that reaches to where the flank of a buried summit comes out is no
disc either. Against boundary elements of ensembles (``pipelines/study.py versus_bem``). Where neighbours tilt the
surface so that a contact does not reach the whole edge of its tip, its load is a little too large
(``tip_edge.py``).
"""

import numpy as np

from roughmdr.interaction.neighbours import within_reach
from roughmdr.numerics.arguments import Floats

_NEAR: dict[int, tuple[float, float]] = {1: (0.02, 3.0), 2: (0.004, 6.0)}
"""Error by a neighbour that touches, and the power of distance over summed radii with which it falls, by order."""
_OVERLAP = 0.45
"""Error by a neighbour over 1 - D/(a + a'), the depth of the overlap."""
_BURIED = 0.22
"""Error by a buried summit over 1 - r/a, r where its flank comes out."""
_PARTIAL = 0.4
"""Error of a tilted flat-ended punch over (1 - a/b)^(3/2), b its radius (``tests/interaction/test_tip_edge.py``)."""
_FARTHEST = 2.5
"""Distance over summed radii beyond which neighbours are left out."""


def crowding(
    at: Floats,
    radius: Floats,
    load: Floats,
    sides: Floats | None,
    emerging: Floats,
    order: int,
    whole: Floats | None = None,
) -> float:
    """Return about the relative error of the force of contacts by those near to each other, at low contact fractions.

    Positions [asperity, 2], contact radii, ``sides`` of a patch that repeats and the radii from which on the flanks of
    buried summits are in a contact, in one unit; loads in any, 0 out of contact. ``whole`` are the radii with the whole
    edge of their tips in contact, where they may be larger.
    """
    on = np.flatnonzero(load)
    if not on.size:
        return 0.0
    a, share = radius[on], np.abs(load[on]) / np.sum(np.abs(load[on]))
    total = _BURIED * float(np.sum(share * np.maximum(1.0 - emerging[on] / a, 0.0)))
    if whole is not None:
        total += _PARTIAL * float(np.sum(share * np.maximum(1.0 - a / whole[on], 0.0) ** 1.5))
    touching, power = _NEAR[order]
    for i, j, away in within_reach(at[on], 2.0 * _FARTHEST * a, sides):
        apart = away / (a[i] + a[j])
        error = touching * np.maximum(apart, 1.0) ** -power + _OVERLAP * np.maximum(1.0 - apart, 0.0)
        once = ((a[j] < a[i]) | ((a[j] == a[i]) & (j < i))) & (apart < _FARTHEST)
        total += float(np.sum(np.where(once, error * (share[i] + share[j]), 0.0)))
    return total
