"""The error of the force of independent asperities, and the share of their contacts that overlap."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Origin
from roughmdr.numerics.arguments import Floats

_NEIGHBOURS = 6  # neighbours of a point of a hexagonal lattice


class Coefficients(NamedTuple):
    """The error of the force at given separation from the deformed mean plane, over the force of boundary elements and
    over the square root of the contact fraction (``pipelines/study.py versus_bem``).
    """

    low: float
    """Few errors are smaller."""
    typical: float
    """About the median."""
    estimate: float
    """Few errors are larger than this, with the contact fraction itself added (``interaction_error``)."""
    least: float = 0.0
    """Error at light contact, which is added wherever there is contact, to a typical error by half."""


ASPERITIES = Coefficients(low=0.5, typical=0.85, estimate=1.4)
"""Coefficients of asperities on a plane: at random, separated, or on a lattice, where the first order is exact: each of
equal contacts with spacing L and load P is pressed 3.9003 P/(pi E* L) deeper against the deformed mean plane than
alone.
"""

SUMMITS = Coefficients(low=0.5, typical=0.8, estimate=1.5, least=0.1)
"""Coefficients of the summits of a continuous surface, whose flanks are no paraboloids."""

TENSION, MOST_TENSION = 0.2, 1.1
"""The error of the pull-off force, of either sign, over the square root of the contact fraction there: typical size,
and size exceeded in one case of ten, against JKR asperities coupled in pairs (``pipelines/oracles/pairwise.py``)."""


HILLS = Coefficients(low=0.5, typical=3.0, estimate=10.0)
"""Coefficients of the hills of a map, which without interaction overlap their neighbours: the force is too high
(``pipelines/study.py hills``)."""

OF_ORIGIN: dict[Origin, Coefficients] = {"asperities": ASPERITIES, "summits": SUMMITS, "hills": HILLS}


def interaction_error(contact_fraction: Floats, coefficients: Coefficients = ASPERITIES) -> Floats:
    """Return the error of the force of independent asperities over the true force [1].

    ``contact_fraction`` is the summed contact area over the nominal area, shape (n,). Where boundary elements find full
    contact, from 0.3 to 0.5 on, the error is the whole force.
    """
    least = np.where(contact_fraction > 0.0, coefficients.least, 0.0)
    return np.minimum(least + coefficients.estimate * np.sqrt(contact_fraction) + contact_fraction, 1.0)


def poisson_overlap(radius: Floats, nominal_area: float) -> float:
    """Return the share of randomly placed contacts that overlap a neighbour, from their radii [m].

    Of n contacts per area one of radius a has no such neighbour with the probability exp(-n pi <(a + a')^2>).
    """
    side = math.sqrt(nominal_area)
    a = radius / side
    with np.errstate(over="ignore"):  # infinitely many contacts all overlap
        reached = math.pi * a.size * (a * a + 2.0 * a * np.mean(a) + np.mean(a * a))
    return float(-np.mean(np.expm1(-reached)))


def overlap_share(x: Floats, y: Floats, radius: Floats) -> float:
    """Return the share of contacts that overlap a neighbour, from centres and radii [m], shape (n,); > 0 each.

    Each contact is compared with the nearest centres of every size, in classes of a factor of two.
    """
    from scipy.spatial import cKDTree

    centres, overlapping = np.column_stack([x, y]), np.zeros(radius.size, dtype=bool)
    size = np.floor(np.log2(radius))
    for each in np.unique(size):
        members = np.flatnonzero(size == each)
        nearest = min(_NEIGHBOURS, members.size)
        found = cKDTree(centres[members]).query(centres, k=nearest)
        distance, neighbour = (np.reshape(part, (-1, nearest)) for part in found)
        itself = members[neighbour] == np.arange(radius.size)[:, None]
        overlapping |= (~itself & (distance < radius[:, None] + radius[members][neighbour])).any(axis=1)
    return float(overlapping.mean())
