"""The error of the force of asperities that do not feel each other, and how many of their contacts overlap."""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats

TYPICAL, LOW = 0.85, 0.5
"""Error of the force at given separation from the deformed mean plane, over the force of boundary elements and over the
square root of the contact fraction: of many randomly placed asperities, and the least (``pipelines/versus_bem.py``)."""

_SELF, _SELF_AREA = 1.40, 0.44
_NEIGHBOURS = 6  # of a hexagonal lattice


def interaction_error(contact_fraction: Floats) -> Floats:
    """Return by how much the force of independent asperities is too low at most, over the true force [1].

    ``contact_fraction`` is the summed contact area over the nominal area, shape (n,). The estimate is exact for equal
    contacts on a square lattice of spacing L: against the deformed mean plane each is pressed 3.9003 P/(pi E* L) deeper
    than alone, by the periodic Green's function at the origin without its singular part. With f = pi a^2/L^2 that gives
    1.40 sqrt(f) + 0.44 f. Many random contacts are off by less. From f = 0.4 on it is the whole force: there boundary
    elements find full contact.
    """
    return np.minimum(_SELF * np.sqrt(contact_fraction) + _SELF_AREA * contact_fraction, 1.0)


def poisson_overlap(radius: Floats, nominal_area: float) -> float:
    """Return the share of contacts that reach into a neighbour's, of contacts placed at random, from their radii [m].

    Of n contacts per area one of radius a has no such neighbour with the probability exp(-n pi <(a + a')^2>).
    """
    side = math.sqrt(nominal_area)
    a = radius / side
    reached = math.pi * a.size * (a * a + 2.0 * a * np.mean(a) + np.mean(a * a))
    return float(-np.mean(np.expm1(-reached)))


def overlap_share(x: Floats, y: Floats, radius: Floats) -> float:
    """Return the share of contacts that reach into a neighbour's, from centres and radii [m], shape (n,); > 0 each.

    Each contact is held against the nearest centres of every size, sizes in classes of a factor of two.
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
