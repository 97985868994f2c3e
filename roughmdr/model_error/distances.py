"""The error of independent asperities as their number and their distances tell it, to first order.

A contact is displaced by P/(pi E* r) by each other one, and its force falls by 2 E* a of that: independent asperities
are too stiff by the sum over all pairs, over the force. Few of them stand on a half-space that is elsewhere at rest,
and separations count from its plane. Many cover a patch, and separations count from its deformed mean plane: the mean
displacement by the others is taken off, and what is left tells whether the asperities stand in crowds.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats

FEW = 10
"""Number of asperities up to which they are few."""

_PAIRS = 2**21
"""Largest number of pairs that are summed; of more, those of evenly chosen contacts with all are."""
_COINCIDENT = 2.0 / math.pi
"""Distance over the contact radius at which 1/r displaces a contact as one at the same place does."""


def error_by_distances(radius: Floats, load: Floats, at: Floats, sides: Floats | None) -> float:
    """Return by how much the force of independent asperities is too high [1], of few at most 1; negative: too low.

    Contact radii [m] and loads in any unit, shape (n,), all above 0; positions [m], shape (n, 2). ``sides`` [m] are
    those of the patch that many cover; None of few.
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
    off = float(np.sum(np.minimum(lost, load[rows])))  # no contact loses more than it bears
    return off / max(alone - off, off)


def error_of_few(area: Floats, contacts: Floats, others: Floats, inverse_distance: float) -> Floats:
    """Return by how much the force of few independent contacts is too high [1], whose positions are not known.

    They have a summed area [m2], and each has so many ``others`` at a mean 1/r [1/m].
    """
    radius = np.sqrt(area / (math.pi * np.maximum(contacts, 1.0)))
    return np.asarray(2.0 / math.pi * radius * np.maximum(others, 0.0) * inverse_distance)


def _mean_inverse_from_middle(sides: Floats) -> float:
    """Return the mean of 1/r [1/m] over a rectangle from its middle."""
    a, b = sides
    return float(2.0 * (np.arcsinh(b / a) / b + np.arcsinh(a / b) / a))
