"""Adhesive contacts that feel each other at one separation: their residuals and their energy.

The energy is stationary over the loads and, in equilibrium, over the contact radii.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction import close
from roughmdr.interaction.contacts import Asperities
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.jkr import coincident
from roughmdr.interaction.jkr.contacts import Contacts, JkrKernels
from roughmdr.numerics.arguments import Floats

Bools = NDArray[np.bool_]


class Problem(NamedTuple):
    """Asperities that adhere and feel each other, in units of the patch."""

    kernels: JkrKernels
    asperities: Asperities
    coupling: Dense
    pairs: close.Pairs
    """Those that come to overlap."""
    order: int
    work: float
    """w/(E* L)."""
    natural: Floats
    """Stretches of the edge of lone contacts as they are made, by which errors are measured."""

    def part(self, kept: NDArray[np.int64]) -> "Problem":
        """Return the problem of some of the asperities, alone."""
        number = np.full(self.natural.size, -1)
        number[kept] = np.arange(kept.size)
        members = number[self.pairs.members]
        both = (members >= 0).all(axis=1)
        apart, share = self.pairs.apart[both], self.pairs.share[both]
        pairs = close.Pairs(members[both], apart, share, self.pairs.radius[kept])
        few = Asperities(*(each[kept] for each in self.asperities))
        return self._replace(asperities=few, coupling=self.coupling.part(kept), pairs=pairs, natural=self.natural[kept])


class State(NamedTuple):
    """Contacts at a separation under a field from without."""

    inside: Bools
    """Which asperities are in contact."""
    t: Floats
    load: Floats
    separation: float
    outer: Floats
    """Field [row, asperity] of loads that contacts have shed and others have not taken up yet."""
    field: Floats
    contacts: Contacts
    bells: coincident.Bells
    potential: Floats
    """Displacement of each asperity."""
    by_loads: Floats
    """Its part by loads alone."""
    edge: Floats
    """Residual of the edge condition: de/da over 2 dl."""
    gap: Floats
    """z - h - U less the indentation: 0 in equilibrium; out of contact, negative before first touch."""
    error: float
    """The largest residual over the natural depth."""


def evaluate(problem: Problem, inside: Bools, t: Floats, load: Floats, separation: float, outer: Floats) -> State:
    """Return the contacts with their residuals."""
    pairs, coupling = problem.pairs, problem.coupling
    field = np.zeros((4, t.size))
    if problem.order == 1:
        field[0] = coupling.potential(load)
        zero = np.zeros_like(field)
        close.take_from_field(pairs, load, zero)
        field[0] += zero[0]
    else:
        field = coupling.field(load)
        close.take_from_field(pairs, load, field)
    contacts = Contacts(*np.zeros((len(Contacts._fields), t.size)))
    whole = field + outer
    problem.kernels.fill(inside, t, load, whole, problem.work, problem.asperities, contacts)
    found = coincident.bells(pairs, contacts.radius)
    i, j = pairs.members.T
    by_loads = field[0].copy()
    np.add.at(by_loads, i, found.value * load[j])
    np.add.at(by_loads, j, found.value * load[i])
    pull = -2.0 / 3.0 * math.pi * load[i] * load[j] * found.by_spread
    edge = contacts.edge.copy()
    np.add.at(edge, i, pull * contacts.radius[i])
    np.add.at(edge, j, pull * contacts.radius[j])
    potential = by_loads
    if problem.order == 2:
        moments = 0.25 * contacts.second_moment, contacts.tilting * whole[1], contacts.tilting * whole[2]
        other = coupling.of_moments(*moments)
        close.take_from_moments(pairs, *moments, other)
        potential = by_loads + other
    with np.errstate(invalid="ignore", divide="ignore"):
        release = np.sqrt(2.0 * math.pi * problem.work * contacts.radius)
        edge = np.where(inside & (not problem.kernels.pinned), edge / (2.0 * release), 0.0)
    reached = problem.asperities.height - separation - potential - outer[0]
    gap = np.where(inside, reached - contacts.depth, reached + contacts.lift)
    residual = np.maximum(np.abs(edge), np.abs(gap)) / problem.natural
    error = float(residual[inside].max(initial=0.0)) if np.isfinite(residual[inside]).all() else math.inf
    return State(inside, t, load, separation, outer, field, contacts, found, potential, by_loads, edge, gap, error)


def energy(problem: Problem, state: State) -> float:
    """Return the energy of all contacts in equilibrium [E* L^3]."""
    between = state.load * (state.potential - 0.5 * state.by_loads)
    return math.fsum(state.contacts.energy.tolist()) + math.pi * math.fsum(between.tolist())
