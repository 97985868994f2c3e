"""The springs under one contact with adhesion of finite range: its force, gap and energy by their definitions."""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

from mpmath import mp
from precise_cohesion import Cohesion, State
from precise_profiles import Number, tanh_sinh

DIGITS = 30
STEPS = 28


class Sums(NamedTuple):
    """P [N], the gap [m] at c and the energy U [J]."""

    force: Number
    gap: Number
    energy: Number


def sums(cohesion: Cohesion, state: State) -> Sums:
    """Of u1 = delta - g(x) for x < a and -beta sqrt(c^2 - x^2) for a < x < c, with g from quadrature of its own.

    U = E* ∫_0^c u1^2 dx - w pi a^2 - ∫_a^c (w - sigma0 gap(r)) 2 pi r dr, of which the last, by exchange of the order,
    is pi w (c^2 - a^2) - 4 sigma0 ∫_a^c [g(x) - delta + u1(x)] sqrt(c^2 - x^2) dx.
    """
    a, c, delta, beta = state.a, state.c, state.delta, cohesion.beta
    straight, weighted, squared, pull = mp.mpf(0), mp.mpf(0), mp.mpf(0), mp.mpf(0)
    for x, dx in _nodes(cohesion, mp.mpf(0), a):
        u = delta - cohesion.profile.mdr(x)[0]
        straight += dx * u
        weighted += dx * u / mp.sqrt((c - x) * (c + x))
        squared += dx * u * u
    for x, dx in _nodes(cohesion, a, c):
        height = mp.sqrt((c - x) * (c + x))
        u = -beta * height
        straight += dx * u
        weighted -= dx * beta
        squared += dx * u * u
        pull += dx * (cohesion.profile.mdr(x)[0] - delta + u) * height
    energy = cohesion.effective_modulus * squared - mp.pi * cohesion.work * c * c + 4 * cohesion.strength * pull
    return Sums(2 * cohesion.effective_modulus * straight, cohesion.height(c) - delta + 2 / mp.pi * weighted, energy)


def _nodes(cohesion: Cohesion, lo: Number, hi: Number) -> Iterator[tuple[Number, Number]]:
    """Nodes and weights from ``lo`` to ``hi`` [m], dense on both sides of each kink."""
    edges = [lo, *(b for b in cohesion.profile.kinks if lo < b < hi), hi]
    for left, right in itertools.pairwise(edges):
        for x, weight in tanh_sinh(DIGITS, STEPS):
            yield left + (right - left) * x, (right - left) * weight
