"""Adhesive contacts that feel each other at one separation: their residuals and their energy.

The energy is stationary over the loads and, in equilibrium, over the contact radii.
"""

import math
from dataclasses import dataclass, field as member, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction.coupling import Sums, add_moments, field_of
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.interface import Asperities, CoupledKernels
from roughmdr.interaction.jkr import coincident
from roughmdr.interaction.jkr.contacts import Contacts
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

Bools = NDArray[np.bool_]

_ERROR = 1e-13  # error of an equilibrium, over the natural depth
_ROUNDING = 16.0 * np.finfo(np.float64).eps  # rounding error of a gap, over the lengths of which it is the difference

_EACH = ("inside", "t", "load", "outer", "field", "potential", "by_loads", "release", "edge", "gap")
"""Names of arrays over the asperities in a ``State``, beside its contacts."""


@dataclass(eq=False)
class PairProblem:
    """Asperities that adhere and feel each other, in units of the patch."""

    kernels: CoupledKernels
    asperities: Asperities
    coupling: Dense
    """With the expansions of all pairs."""
    near: coincident.Near
    """The pairs that may come to overlap."""
    order: int
    work: float
    """w/(E* L)."""
    natural: Floats
    """Stretches of the edge of lone contacts as they are made, by which errors are measured."""
    _last: "tuple[NDArray[np.int64], PairProblem] | None" = member(default=None, init=False)

    def part(self, kept: NDArray[np.int64]) -> "PairProblem":
        """Return the problem of some of the asperities, alone; that returned last is remembered."""
        if self._last is None or not np.array_equal(self._last[0], kept):
            few, natural = Asperities(*(each[kept] for each in self.asperities)), self.natural[kept]
            near = self.near.part(kept, few, natural)
            coupling = self.coupling.part(kept)
            self._last = kept, replace(self, asperities=few, coupling=coupling, near=near, natural=natural)
        return self._last[1]


class Step(NamedTuple):
    """A change of contacts."""

    radius: Floats
    load: Floats
    along: float = 0.0
    """Change of the place along the path."""


class Drive(NamedTuple):
    """By how much separation and outer field change along a path from 0 to 1."""

    separation: float
    outer: Floats


class State(NamedTuple):
    """Asperities at a separation under a field from without."""

    inside: Bools
    """Which asperities are in contact."""
    t: Floats
    load: Floats
    separation: float
    outer: Floats
    """Effect of jumped contacts that the others have not taken up yet, [row, asperity]: the displacement with its
    derivatives, as ``field``, and the part of de/da by overlap."""
    field: Floats
    contacts: Contacts
    overlap: coincident.Overlap
    bells: coincident.Bells
    potential: Floats
    """Displacement of each asperity."""
    by_loads: Floats
    """Its part by loads alone."""
    release: Floats
    """dl, the stretch at which the edge of each contact is at rest."""
    edge: Floats
    """Residual of the edge condition: de/da over 2 dl."""
    gap: Floats
    """z - h - U less the indentation: 0 in equilibrium; out of contact, negative before first touch."""
    error: float
    """The largest residual over the natural depth."""
    limit: float
    """The error that rounding leaves."""
    factors: Any = None
    """The ``Factors`` of the tangent of the contacts at this state or near it."""


@njit
def _compare(
    inside: Bools, pinned: bool, work: float, above: Floats, contacts: Contacts, natural: Floats, rows: Floats
) -> tuple[float, float]:
    """Fill ``rows`` of dl, the residuals of the edges (de/da before) and of the gaps (the displacement U before).

    Return the largest residual of the contacts, and that which rounding leaves, over the natural depth; inf where there
    is none that a float holds. ``above`` is z - h.
    """
    largest, limit = 0.0, _ERROR
    release, edge, gap = rows
    for i in range(inside.size):
        release[i] = math.sqrt(2.0 * math.pi * work * contacts.radius[i])
        size = abs(above[i]) + abs(gap[i]) + abs(contacts.depth[i])
        gap[i] = above[i] - gap[i]
        if not inside[i]:
            edge[i], gap[i] = 0.0, gap[i] + contacts.lift[i]
            continue
        limit = max(limit, _ERROR + _ROUNDING * size / natural[i])
        edge[i] = 0.0 if pinned else edge[i] / (2.0 * release[i])
        gap[i] -= contacts.depth[i]
        residual = max(abs(edge[i]), abs(gap[i])) / natural[i]
        largest = max(largest, residual if math.isfinite(abs(edge[i]) + abs(gap[i])) else math.inf)
    return largest, limit


def no_field(problem: PairProblem) -> Floats:
    """Return an outer field of 0."""
    return np.zeros((5, problem.natural.size))


def evaluate(
    problem: PairProblem,
    inside: Bools,
    t: Floats,
    load: Floats,
    separation: float,
    outer: Floats,
    known: tuple[NDArray[np.int64], "State"] | None = None,
) -> State:
    """Return the contacts with their residuals; ``known`` are some, all in contact among them, whose field is known."""
    overlap = problem.near.at(separation)
    coupling: Sums = problem.coupling if known is None else problem.coupling.beside(known[0])
    pairs, order, heights = overlap.pairs, problem.order, problem.asperities.height
    field = field_of(coupling, pairs, order, load)
    if known is not None:
        field[:, known[0]] = known[1].field
    contacts = Contacts(*np.zeros((len(Contacts._fields), t.size)))
    whole = field + outer[:4]
    problem.kernels.fill(inside, t, load, whole, problem.work, problem.asperities, contacts)
    by_loads, edge = field[0].copy(), contacts.edge + outer[4]
    found = coincident.bells(pairs, contacts.radius)
    if pairs.share.size:
        coincident.add_bells(pairs, found, contacts.radius, load, by_loads, edge)
    potential = by_loads.copy()
    if order == 2:
        moments = 0.25 * contacts.second_moment, contacts.tilting * whole[1], contacts.tilting * whole[2]
        add_moments(coupling, pairs, moments, potential)
    if known is not None:
        potential[known[0]], by_loads[known[0]] = known[1].potential, known[1].by_loads
    rows = np.array([edge, edge, potential + outer[0]])
    pinned, natural = problem.kernels.pinned, problem.natural
    error, limit = _compare(inside, pinned, problem.work, heights - separation, contacts, natural, rows)
    release, edge, gap = rows
    totals = potential, by_loads, release, edge, gap, error, limit
    return State(inside, t, load, separation, outer, field, contacts, overlap, found, *totals)


def among(problem: PairProblem, kept: NDArray[np.int64], few: State, outer: Floats | None = None) -> State:
    """Return the state of all asperities of a problem, of which ``kept`` are as in ``few`` and no other in contact."""
    outer = no_field(problem) if outer is None else outer
    inside, (t, load) = np.zeros(outer.shape[1], np.bool_), np.zeros((2, outer.shape[1]))
    inside[kept], t[kept], load[kept] = few.inside, few.t, few.load
    return evaluate(problem, inside, t, load, few.separation, outer, (kept, few))._replace(factors=few.factors)


def part_of(few: PairProblem, kept: NDArray[np.int64], state: State) -> State:
    """Return the state of some asperities, all that are in contact among them; ``among`` undoes it."""
    overlap, contacts = few.near.at(state.separation), Contacts(*np.take(state.contacts, kept, axis=1))
    # np.take lays rows out as they are elsewhere: compiled code of other layouts would be compiled once more
    each: dict[str, Any] = {name: np.take(getattr(state, name), kept, axis=-1) for name in _EACH}
    bells = coincident.bells(overlap.pairs, contacts.radius)
    return state._replace(contacts=contacts, overlap=overlap, bells=bells, **each)


def alone(problem: PairProblem, state: State) -> tuple[PairProblem, State]:
    """Return the problem of the asperities in contact, without all others, and their state."""
    kept = np.flatnonzero(state.inside)
    few = problem.part(kept)
    return few, part_of(few, kept, state)


def interpolated(
    problem: PairProblem, first: State, last: State, part: float, separation: float, outer: Floats
) -> State:
    """Return the contacts a part of the way from one state to another, to be taken for a guess."""
    t, load = first.t + part * (last.t - first.t), first.load + part * (last.load - first.load)
    return evaluate(problem, first.inside, t, load, separation, outer)


def moved(problem: PairProblem, state: State, step: Step, drive: Drive) -> State:
    """Return the state of contacts moved by a step."""
    t = state.t
    if not problem.kernels.pinned:
        t = np.maximum(t + step.radius / state.contacts.slope, 0.1 * t)
    outer = state.outer + drive.outer * step.along
    separation = state.separation + drive.separation * step.along
    return evaluate(problem, state.inside, t, state.load + step.load, separation, outer)


def energy(problem: PairProblem, state: State) -> float:
    """Return the energy of all contacts in equilibrium [E* L^3]."""
    between = state.load * (state.potential - 0.5 * state.by_loads)
    return math.fsum(state.contacts.energy.tolist()) + math.pi * math.fsum(between.tolist())
