"""The error of the force of asperities that do not feel each other, and how many of their contacts overlap."""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats

ESTIMATE, LOW, HIGH = 0.85, 0.4, 1.3
"""Error of the force at given separation from the deformed mean plane, over that of boundary elements, over the square
root of the contact fraction: on randomly placed asperities, the least and the greatest of other arrangements
(``pipelines/versus_bem.py``)."""

_NEIGHBOURS = 13  # the contact itself, and two rings of a hexagonal lattice but for its corners


def interaction_error(contact_fraction: Floats, factor: float = ESTIMATE) -> Floats:
    """Return by how much the force of independent asperities is too low, over the true force [1].

    ``contact_fraction`` is the summed contact area over the nominal area, shape (n,).
    """
    return np.minimum(factor * np.sqrt(contact_fraction), 1.0)


def poisson_overlap(contact_fraction: float, mean_square: float = 1.0) -> float:
    """Return the share of contacts that reach into a neighbour's, of contacts placed at random.

    A contact of radius a has such a neighbour unless none lies within a + a'. With n contacts per area that has the
    probability exp(-n pi <(a + a')^2>) = exp(-2 f (1 + <a>^2/<a^2>)), f = n pi <a^2>; ``mean_square`` is <a>^2/<a^2>.
    """
    return -math.expm1(-2.0 * contact_fraction * (1.0 + mean_square))


def overlap_share(x: Floats, y: Floats, radius: Floats) -> float:
    """Return the share of contacts that reach into a neighbour's, from centres and radii [m], shape (n,); > 0 each.

    Each contact is held against its nearest centres; that one reaches it from farther away is rare enough.
    """
    from scipy.spatial import cKDTree

    if radius.size < 2:
        return 0.0
    centres = np.column_stack([x, y])
    distance, neighbour = cKDTree(centres).query(centres, k=min(_NEIGHBOURS, radius.size))
    return float((distance < radius[:, None] + radius[neighbour])[:, 1:].any(axis=1).mean())
