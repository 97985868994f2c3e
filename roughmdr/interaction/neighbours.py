"""Asperities near each other, each within a reach of its own."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

_PAIRS_AT_A_TIME = 2.0**22
_BEYOND_ALL = 1.01  # reach over the diagonal of all points: two of them lie on it, but for rounding
_AT_ONCE = 2.0**12  # pairs so few that one class is found sooner than several


def within_reach(
    at: Floats, reach: Floats, sides: Floats | None
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64], Floats]]:
    """Yield numbers i and j and the distance of pairs nearer than the reach of i, and some more; each in both orders.

    Points [point, 2] on a patch with ``sides`` that repeats, or on a plane. Reaches are taken in classes of two.
    """
    from scipy.spatial import cKDTree

    reaching = np.flatnonzero(reach > 0.0)
    if not reaching.size:
        return
    wrapped = at if sides is None else np.clip(at - sides * np.floor(at / sides), 0.0, np.nextafter(sides, 0.0))
    whole = cKDTree(wrapped, boxsize=sides)
    extent = np.ptp(at, axis=0) if sides is None else sides
    density = len(at) / max(float(extent[0] * extent[1]), float(np.finfo(np.float64).tiny))
    farthest = _BEYOND_ALL * float(np.hypot(*extent))

    def expected(far: float) -> float:
        return min(density * math.pi * far * far, len(at)) + 1.0

    size = np.ceil(np.log2(reach[reaching]))
    if reaching.size * expected(float(2.0 ** size.max())) < _AT_ONCE:
        size[:] = size.max()
    for each in np.unique(size):
        members, far = reaching[size == each], float(min(2.0**each, farthest))
        parts = np.array_split(members, math.ceil(members.size * expected(far) / _PAIRS_AT_A_TIME))
        for part in parts:
            near = cKDTree(wrapped[part], boxsize=sides).sparse_distance_matrix(whole, far, output_type="ndarray")
            i, j = part[near["i"]], near["j"]
            other = i != j
            yield i[other], j[other], near["v"][other]
