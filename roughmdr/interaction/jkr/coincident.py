"""Adhesive contacts that come to overlap: their loads felt as those of bells, at any distance.

Where the expansion in the distance D fails, each contact is taken for a load spread as a Gaussian with the second
moment of a flat punch, 2/3 P a^2. It is felt by another at D as

    sqrt(pi/2)/s exp(-z) I0(z),  s^2 = (a^2 + b^2)/3,  z = D^2/(4 s^2),

which goes to 1/D + (a^2 + b^2)/(6 D^3) and is smooth in the radii. At D = 0 it is 1.535/a for equal radii, below the
pi/2/a of a contact's own compliance, so that the coupling stays positive definite at any overlap.

Which pairs are taken so is settled for a whole path, from bounds of the radii: an energy must not depend on its past.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import i0e, i1e

from roughmdr.interaction import close
from roughmdr.interaction.close import FULL, NONE
from roughmdr.interaction.green import point_load
from roughmdr.interaction.neighbours import within_reach
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_FAR = 1e-6  # D^2/4s^2 beyond the inverse of this has no digits more
_ROOT = math.sqrt(0.5 * math.pi)


def find(at: Floats, bound: Floats, sides: Floats | None) -> close.Pairs:
    """Return the pairs that overlap where their radii reach ``bound``, with their shares."""
    found = [np.empty((0, 2), np.int64)]
    for i, j, away in within_reach(at, 2.0 * NONE * bound, sides):
        keep = (away < NONE * (bound[i] + bound[j])) & ((bound[j] < bound[i]) | ((bound[j] == bound[i]) & (i < j)))
        found.append(np.sort(np.column_stack([i[keep], j[keep]]), axis=1))
    members = np.unique(np.concatenate(found), axis=0)
    apart = at[members[:, 0]] - at[members[:, 1]]
    if sides is not None:
        apart -= sides * np.rint(apart / sides)
    away = np.hypot(apart[:, 0], apart[:, 1])
    u = (NONE - away / bound[members].sum(axis=1)) / (NONE - FULL)
    u = np.clip(u, 0.0, 1.0)
    return close.Pairs(members, np.column_stack([apart, away]), u * u * (3.0 - 2.0 * u), bound)


@njit
def take_out(pairs: close.Pairs, matrices: Floats) -> None:
    """Take the expansion of the pairs out of the matrices of G, its slopes and its Laplacian, as far as they share."""
    for number in range(pairs.share.size):
        i, j = pairs.members[number]
        share = pairs.share[number]
        g, gx, gy, lap = point_load(pairs.apart[number, 0], pairs.apart[number, 1])
        for row, value, sign in ((0, g, 1.0), (1, gx, -1.0), (2, gy, -1.0), (3, lap, 1.0)):
            matrices[row, i, j] -= share * value
            matrices[row, j, i] -= sign * share * value


class Bells(NamedTuple):
    """How the loads of overlapping pairs are felt, [pair], times their share."""

    value: Floats
    by_spread: Floats
    """Slope over s^2."""
    curvature: Floats
    """Second derivative over s^2."""


def bells(pairs: close.Pairs, radius: Floats) -> Bells:
    """Return the coupling of the pairs at contact radii; 0 where both are out of contact."""
    if not pairs.members.size:
        return Bells(np.zeros(0), np.zeros(0), np.zeros(0))
    a, b = radius[pairs.members].T
    q = (a * a + b * b) / 3.0
    square = pairs.apart[:, 2] ** 2
    touching = (a > 0.0) | (b > 0.0)
    q = np.where(touching, q, 1.0)
    z = np.maximum(square / (4.0 * q), 1e-300)
    zero, one = i0e(z), i1e(z)
    root = _ROOT / np.sqrt(q)
    # y(z) = exp(-z) I0(z): y' = e^-z (I1 - I0), y'' = e^-z (2 I0 - 2 I1 - I1/z); dz/dq = -z/q
    slope, bend = one - zero, 2.0 * zero - 2.0 * one - one / z
    value = root * zero
    first = root / q * (-0.5 * zero - z * slope)
    second = root / (q * q) * (0.75 * zero + 3.0 * z * slope + z * z * bend)
    far = z * _FAR > 1.0
    if far.any():
        away = pairs.apart[far, 2]
        value[far] = 1.0 / away + 0.5 * q[far] / away**3
        first[far], second[far] = 0.5 / away**3, 0.0
    share = np.where(touching, pairs.share, 0.0)
    return Bells(share * value, share * first, share * second)
