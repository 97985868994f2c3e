"""The error of independent asperities from their number and their distances, to first order.

A contact is displaced by P/(pi E* r) by each other one, and its force falls by 2 E* a of that: independent asperities
are too stiff by the sum over all pairs, over the force. Few of them stand on a half-space that is elsewhere at rest,
and separations count from its plane. Many cover a patch, and separations count from its deformed mean plane: the mean
displacement by the others is subtracted; the rest depends on whether the asperities are crowded.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats

FEW = 10
"""Number of asperities up to which they are few."""

_PAIRS = 2**21
"""Largest number of pairs that are summed; beyond, an even choice of contacts is paired with all."""
_COINCIDENT = 2.0 / math.pi
"""Distance over the contact radius at which 1/r is the displacement by a coincident contact."""


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
