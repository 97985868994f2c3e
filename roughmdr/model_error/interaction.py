"""The error of the force of independent asperities, and the share of their contacts that overlap.

From their number and their distances the error follows to first order. A contact is displaced by P/(pi E* r) by each
other one, and its force falls by 2 E* a of that: independent asperities are too stiff by the sum over all pairs, over
the force. Few of them stand on a half-space that is elsewhere at rest, and separations count from its plane. Many cover
a patch, and separations count from its deformed mean plane: the mean displacement by the others is subtracted; the rest
depends on whether the asperities are crowded.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Origin
from roughmdr.numerics.arguments import Floats

_NEIGHBOURS = 6  # neighbours of a point of a hexagonal lattice
FEW = 10
"""Number of asperities up to which they are few."""
_PAIRS = 2**21
"""Largest number of pairs that are summed; beyond, an even choice of contacts is paired with all."""
_COINCIDENT = 2.0 / math.pi
"""Distance over the contact radius at which 1/r is the displacement by a coincident contact."""


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


def error_by_distances(radius: Floats, load: Floats, at: Floats, sides: Floats | None) -> float:
    """Return the relative excess of the force of independent asperities [1], for few at most 1; negative: too low.

    Contact radii [m] and loads in any unit, shape (n,), all above 0; positions [m], shape (n, 2). ``sides`` [m] are
    those of the patch that many cover; None for few.
    """
    n = radius.size
    rows = np.unique(np.linspace(0.0, n - 1.0, min(n, 1 + _PAIRS // n)).astype(np.int64))
    apart = at[rows, None] - at
    if sides is not None:
        apart -= sides * np.rint(apart / sides)
    distance = np.maximum(np.hypot(apart[..., 0], apart[..., 1]), _COINCIDENT * np.maximum(radius[rows, None], radius))
    distance[np.arange(rows.size), rows] = np.inf
    displaced = (load / distance).sum(axis=1)
    if sides is not None:
        displaced -= _mean_inverse_from_middle(sides) * (load.sum() - load[rows])
    lost, alone = 2.0 / math.pi * radius[rows] * displaced, float(np.sum(load[rows]))
    if sides is not None:
        return float(np.sum(lost)) / alone
    off = float(np.sum(np.minimum(lost, load[rows])))  # no contact loses more than its load
    return off / max(alone - off, off)


def error_of_few(area: Floats, contacts: Floats, others: Floats, inverse_distance: float) -> Floats:
    """Return the relative excess of the force [1] of few independent contacts whose positions are not known.

    They have a summed area [m2], and each has so many ``others`` at a mean 1/r [1/m].
    """
    radius = np.sqrt(area / (math.pi * np.maximum(contacts, 1.0)))
    return np.asarray(2.0 / math.pi * radius * np.maximum(others, 0.0) * inverse_distance)


def _mean_inverse_from_middle(sides: Floats) -> float:
    """Return the mean of 1/r [1/m] over a rectangle from its middle."""
    a, b = sides
    return float(2.0 * (np.arcsinh(b / a) / b + np.arcsinh(a / b) / a))
