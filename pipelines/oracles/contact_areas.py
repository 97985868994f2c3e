"""Contact areas from the pressures of a periodic square grid, better than the number of cells under pressure.

That number is too large: a cell at the edge counts in full. With contacts of some ten cells in radius it is off by 1 %
or more. Areas are shares of the grid.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from roughmdr.numerics.arguments import Floats

_EDGE_SHARE = (math.pi - 1.0 + math.log(2.0)) / 24.0  # of the cells' sides at the edge (Yastrebov et al.)


def by_perimeter(pressure: Floats) -> float:
    """Return the area with the mean share of the cells at the edge taken off, for contacts of any shape.

    V. A. Yastrebov, G. Anciaux and J.-F. Molinari, Tribol. Int. 114 (2017), 161.
    """
    loaded = pressure > 0.0
    sides = sum(np.count_nonzero(loaded != np.roll(loaded, 1, axis)) for axis in (0, 1))
    return float(np.count_nonzero(loaded) - _EDGE_SHARE * sides) / pressure.size


def label_contacts(pressure: Floats) -> NDArray[np.int64]:
    """Return the number of each cell's contact, 0 outside; cells that share a side, across the rim too, are in one."""
    labels, count = label(pressure > 0.0)
    rims = [(labels[0], labels[-1]), (labels[:, 0], labels[:, -1])]
    one, other = (np.concatenate(side) for side in zip(*rims, strict=True))
    both = (one > 0) & (other > 0)
    joined = coo_array((np.ones(both.sum()), (one[both], other[both])), shape=(count + 1, count + 1))
    merged = connected_components(joined, directed=False)[1].astype(np.int64)
    return np.asarray(np.where(labels > 0, merged[labels] + 1, 0))


def of_half_ellipsoids(pressure: Floats) -> float:
    """Return the area of separated contacts of paraboloids, whose pressure is half an ellipsoid: 9/8 (∫p)²/∫p² each.

    Neighbours change that shape of the pressure only in the fourth derivative of the displacement.
    """
    contact = label_contacts(pressure).ravel()
    first, second = (np.bincount(contact, pressure.ravel() ** power) for power in (1, 2))
    loaded = second > 0.0
    return 1.125 * float(np.sum(first[loaded] ** 2 / second[loaded])) / pressure.size
