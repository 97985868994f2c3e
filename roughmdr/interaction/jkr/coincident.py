"""Adhesive contacts that come to overlap: their loads felt as those of bells, at any distance.

Where the expansion in the distance D fails, each contact is taken for a load spread as a Gaussian with the second
moment of a flat punch, 2/3 P a^2. It is felt by another at D as

    sqrt(pi/2)/s exp(-z) I0(z),  s^2 = (a^2 + b^2)/3,  z = D^2/(4 s^2),

which goes to 1/D + (a^2 + b^2)/(6 D^3) and is smooth in the radii. At D = 0 it is 1.535/a for equal radii, below the
pi/2/a of a contact's own compliance, so that the coupling stays positive definite at any overlap.

How far a pair is taken so is settled by where the flat stands, not by its past: from the radii about which both
profiles have risen by the depth of the flat below the summit and the natural depth, near those of contacts alone. There
the energy is a function of radii and loads. On the way from one to the other its change is not the work of the flat
alone.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import i0e, i1e

from roughmdr.interaction import close
from roughmdr.interaction.interface import Asperities, CoupledKernels, kernel
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_FAR = 1e-6  # D^2/4s^2 beyond the inverse of this has no digits more
_ROOT = math.sqrt(0.5 * math.pi)
_RTOL, _LARGEST_STATE, _MAX_ROUNDS = 1e-15, 1e30, 200


def flanks(which: NDArray[np.int64], h: float, natural: Floats, asperities: Asperities, out: Floats) -> None:
    """Fill ``out`` with the radii of asperities that decide on their overlap under a flat at h, and the slopes over h.

    The depth sets in smoothly, from the natural depth before first touch to as much after it.
    """
    for number in range(which.size):
        i = which[number]
        size, rise = asperities.size[i], asperities.depth[i]
        if kernel.pinned:
            out[0, number], out[1, number] = size, 0.0
            continue
        own = kernel.params_of(asperities.params, i)
        begun = min(max(1.0 + (asperities.height[i] - h) / natural[i], 0.0), 2.0)  # 1 at first touch
        depth = 0.25 * begun * begun * natural[i] + max(asperities.height[i] - h - natural[i], 0.0)
        risen = (natural[i] + depth) / rise
        low, high = 0.5, 1.0
        while kernel.terms(high, own)[2] < risen and high < _LARGEST_STATE:
            low, high = high, 2.0 * high
        while kernel.terms(low, own)[2] > risen and low > 0.0:
            low, high = 0.5 * low, low
        t = 0.5 * (low + high)
        a, da, g, dg, _ = kernel.terms(t, own)
        for _ in range(_MAX_ROUNDS):
            low, high = (t, high) if g < risen else (low, t)
            step = (risen - g) / dg
            if not low < t + step < high:
                step = 0.5 * (low + high) - t
            if abs(step) <= _RTOL * t:
                break
            t += step
            a, da, g, dg, _ = kernel.terms(t, own)
        out[0, number] = size * a
        out[1, number] = -0.5 * begun * size * da / (rise * dg)


class Overlap(NamedTuple):
    """Pairs that overlap at a separation, with their shares."""

    pairs: close.Pairs
    rate: Floats
    """By which their shares fall with the separation."""


class Near:
    """Asperities of which pairs may come to overlap."""

    def __init__(self, kernels: CoupledKernels, asperities: Asperities, natural: Floats, pairs: close.Pairs) -> None:
        self._kernels, self._asperities, self._natural = kernels, asperities, natural
        self.pairs = pairs
        self._which, place = np.unique(pairs.members, return_inverse=True)
        self._place = place.reshape(-1, 2)
        self._last: tuple[float, Overlap] | None = None

    def part(self, kept: NDArray[np.int64], asperities: Asperities, natural: Floats) -> "Near":
        """Return some of them, which are told again."""
        number = np.full(self._natural.size, -1)
        number[kept] = np.arange(kept.size)
        members = number[self.pairs.members]
        both = (members >= 0).all(axis=1)
        pairs = close.Pairs(members[both], self.pairs.apart[both], self.pairs.share[both], self.pairs.radius[kept])
        return Near(self._kernels, asperities, natural, pairs)

    def at(self, separation: float) -> Overlap:
        """Return the pairs that overlap under a flat at a separation; those told last are remembered."""
        if self._last is None or self._last[0] != separation:
            self._last = separation, self._found(separation)
        return self._last[1]

    def _found(self, separation: float) -> Overlap:
        pairs, reach = self.pairs, np.empty((2, self._which.size))
        self._kernels.flanks(self._which, separation, self._natural, self._asperities, reach)
        share, rate = np.zeros((2, pairs.share.size))
        _share(pairs.apart, self._place, reach, share, rate)
        on = np.flatnonzero(share)
        if on.size < share.size:
            pairs, rate = pairs._replace(members=pairs.members[on], apart=pairs.apart[on]), rate[on]
        return Overlap(pairs._replace(share=share[on]), rate)


@njit
def _share(apart: Floats, place: NDArray[np.int64], reach: Floats, share: Floats, rate: Floats) -> None:
    """Fill the shares of pairs and by how much they fall with the separation; ``reach`` holds radii and their slopes.

    ``place`` [pair, 2] says where those of a pair are.
    """
    for number in range(share.size):
        i, j = place[number]
        share[number], by_reach = close.share_of(apart[number, 2], reach[0, i] + reach[0, j])
        rate[number] = -by_reach * (reach[1, i] + reach[1, j])


class Bells(NamedTuple):
    """How the loads of overlapping pairs are felt, [pair], times their share."""

    value: Floats
    by_spread: Floats
    """Slope over s^2."""
    curvature: Floats
    """Second derivative over s^2."""


def bells(pairs: close.Pairs, radius: Floats) -> Bells:
    """Return the coupling of pairs that share, at contact radii; 0 where both are out of contact."""
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


@njit
def add_bells(
    pairs: close.Pairs, bells: Bells, radius: Floats, load: Floats, displacement: Floats, edge: Floats
) -> None:
    """Add what the loads of overlapping pairs do to each other: to the displacement, and to de/da."""
    for number in range(pairs.share.size):
        i, j = pairs.members[number]
        displacement[i] += bells.value[number] * load[j]
        displacement[j] += bells.value[number] * load[i]
        pull = -2.0 / 3.0 * math.pi * load[i] * load[j] * bells.by_spread[number]
        edge[i] += pull * radius[i]
        edge[j] += pull * radius[j]
