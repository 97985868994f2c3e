"""A tangent of adhesive contacts that is factored at one state, by which near states find their equilibrium.

Loads follow from the edge condition, so that one number stands for each contact. It holds what overlapping pairs do to
each other, and of all others the terms to the third order in radius over distance, not the moments that they induce.
"""

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs, dsytrf

from roughmdr.interaction.close import Pairs
from roughmdr.interaction.green import point_load
from roughmdr.interaction.jkr.contacts import Contacts
from roughmdr.interaction.jkr.equilibrium import PairProblem, State, Step
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_ITERATIONS = 5
_BLOCK = 64  # number of columns that LAPACK factors at a time; with the least work space it takes three times as long


class Lead(NamedTuple):
    """A radius that is given, so that the place along the path follows."""

    asperity: int
    by_place: Step
    """The change of the contacts along the path as the factors have it."""
    edge: Floats
    """That of de/da."""


@njit
def _felt(
    i: int, j: int, terms: tuple[float, float, float, float], order: int, contacts: Contacts, slopes: Floats
) -> tuple[float, float]:
    """Return what the gap of i changes by the load of j, and by its radius; ``terms`` are G, its slopes and Laplacian.

    Both are in proportion to those.
    """
    g, x, y, laplacian = terms
    if order == 1:
        return g, 0.0
    squares = contacts.radius[i] * contacts.radius[i] + contacts.radius[j] * contacts.radius[j]
    sliding = x * slopes[0, j] + y * slopes[1, j]
    back = -x * slopes[0, i] - y * slopes[1, i]
    by_load = g + (squares / 6.0 * laplacian + sliding * contacts.lift[j] + back * contacts.lift[i])
    by_radius = -0.25 * contacts.moment_by_radius[j] * laplacian - sliding * contacts.edge_by_tilt[j] / math.pi
    return by_load, by_radius


@njit
def _fill(
    matrices: Floats, pairs: Pairs, order: int, contacts: Contacts, slopes: Floats, block: Floats, cross: Floats
) -> None:
    """Fill what the gaps of contacts change by the loads of others, the other way round, and by their radii.

    The expansion of pairs is left out, as far as they share.
    """
    for i in range(contacts.radius.size):
        for j in range(contacts.radius.size):
            terms = matrices[0, i, j], matrices[1, i, j], matrices[2, i, j], matrices[3, i, j]
            block[i, j], cross[i, j] = _felt(i, j, terms, order, contacts, slopes)
        block[i, i] += 0.5 * math.pi / contacts.radius[i]
    for number in range(pairs.share.size):
        x, y, share = pairs.apart[number, 0], pairs.apart[number, 1], pairs.share[number]
        for way in range(2):
            i, j = pairs.members[number, way], pairs.members[number, 1 - way]
            by_load, by_radius = _felt(i, j, point_load(x, y), order, contacts, slopes)
            block[i, j] -= share * by_load
            cross[i, j] -= share * by_radius
            x, y = -x, -y


@njit
def _eliminate(cross: Floats, a: Floats, by_load: Floats, ratio: Floats, matrix: Floats) -> None:
    """Add to the matrix of the radii what the loads change by them, but for their main part."""
    for i in range(a.size):
        part = 0.5 * math.pi**2 / (a[i] * by_load[i])
        for j in range(a.size):
            matrix[i, j] += cross[i, j] - part * cross[j, i] * ratio[j]
        matrix[i, i] += by_load[i] / math.pi


class Factors:
    """The factored tangent at a state in which all asperities are in contact."""

    def __init__(self, problem: PairProblem, state: State) -> None:
        contacts, size = state.contacts, state.t.size
        a = contacts.radius
        self.pinned, self.natural, self.release = problem.kernels.pinned, problem.natural, state.release
        self._scale = a, 2.0 / math.pi * a * problem.natural
        self._by_load, self.slope = contacts.edge_by_load, contacts.slope
        self._block, self._cross = np.empty((2, size, size))
        slopes = state.field[1:3] + state.outer[1:3]
        pairs = state.overlap.pairs
        _fill(problem.coupling.matrices, pairs, problem.order, contacts, slopes, self._block, self._cross)
        self._pairs = _Overlapping(state)
        i, j = pairs.members.T
        self._block[i, j] += state.bells.value
        self._block[j, i] += state.bells.value
        matrix = self._block
        if not self.pinned:
            self._own = edge_by_radius(state)
            ratio, near = self._own / self._by_load, self._pairs
            matrix = self._block * ratio
            if near.members.size:
                matrix[:, near.members] = self._block[:, near.members] @ near.ratio
                matrix[np.ix_(near.members, near.members)] += near.cross
            _eliminate(self._cross, a, self._by_load, ratio, matrix)
        else:
            matrix = -self._block
        self._lu, self._pivots = matrix.T, np.zeros(0, np.int32)
        if size:
            self._lu, self._pivots, _ = dgetrf(matrix.T, overwrite_a=True)  # row by row, so that it is not copied

    @cached_property
    def unstable(self) -> int:
        """How many modes have no stable equilibrium.

        Counted by the inertia of the tangent of the first order (Sylvester's law), made even or odd by that factored.
        """
        swaps = np.count_nonzero(self._pivots != np.arange(self._pivots.size))
        odd = (np.count_nonzero(np.diag(self._lu) < 0.0) + swaps + self._pivots.size) % 2
        if self._pairs.members.size and not self.pinned:  # without them all loads pull the edge outwards
            odd ^= int(np.linalg.slogdet(-self._pairs.by_load)[0] < 0.0)
        if self.pinned or not self._own.size:
            return int(odd)
        own = np.where(self._own == 0.0, np.finfo(np.float64).tiny, self._own)
        loads, near = self._block.copy(), self._pairs
        single = self._by_load**2 / (math.pi * own)
        single[near.members] = 0.0
        loads[np.diag_indices(own.size)] += single
        negative = np.count_nonzero(np.delete(own, near.members) < 0.0)
        if near.members.size:
            loads[np.ix_(near.members, near.members)] += (
                near.by_load.T @ np.linalg.solve(near.own, near.by_load) / math.pi
            )
            negative += np.count_nonzero(np.linalg.eigvalsh(near.own) < 0.0)
        factored, pivots, _ = dsytrf(loads.T, lower=True, lwork=_BLOCK * own.size, overwrite_a=True)
        below = np.count_nonzero(np.diag(factored)[pivots > 0] < 0.0)
        count = int(negative - below - np.count_nonzero(pivots < 0) // 2)  # of each double pivot one is negative
        return count if count % 2 == odd else abs(count - 1)

    def least_stable(self) -> int:
        """Return the contact that the least stable mode moves most, by inverse iteration."""
        a = self._scale[0]
        mode = np.ones_like(a)
        for _ in range(_ITERATIONS):
            mode = self.solve(mode / a, np.zeros_like(a)).radius / a
            mode /= np.abs(mode).max()
        return int(np.argmax(np.abs(mode)))

    @np.errstate(all="ignore")  # at a fold they are singular
    def solve(self, edge: Floats, gap: Floats, lead: Lead | None = None) -> Step:
        """Return the step with these changes of de/da and of the gaps."""
        if self.pinned:
            return Step(np.zeros_like(gap), self._solved(gap))
        given = self._held(edge)
        other = 0.5 * math.pi**2 / (self._scale[0] * self._by_load) * (given @ self._cross)
        radius, along = self._solved(gap + self._block @ given - other), 0.0
        if lead is not None:
            rate, number = lead.by_place.radius, lead.asperity
            along = -float(radius[number] / rate[number])
            radius, given = radius + along * rate, given + along * self._held(lead.edge)
            radius[number] = 0.0
        return Step(radius, self._loads(radius, given), along)

    def _solved(self, right: Floats) -> Floats:
        return np.asarray(dgetrs(self._lu, self._pivots, right, trans=1)[0]) if right.size else right

    def _held(self, edge: Floats) -> Floats:
        """Return the changes of the loads by which de/da changes so, with all radii as they are."""
        load, near = edge / self._by_load, self._pairs
        if near.members.size:
            load[near.members] = near.load_by_edge @ edge[near.members]
        return load

    def _loads(self, radius: Floats, given: Floats) -> Floats:
        """Return the changes of the loads that keep the edge condition."""
        followed, near = self._own / self._by_load * radius, self._pairs
        if near.members.size:
            followed[near.members] = near.ratio @ radius[near.members]
        load = given - followed
        return np.asarray(load - self._held(math.pi * (load @ self._cross)))

    def unknowns(self, step: Step, lead: Lead | None) -> Floats:
        """Return a step over its scales: radii, unless they are pinned, then loads; the place for a leading radius."""
        load = step.load / self._scale[1]
        if self.pinned:
            return load
        radius = step.radius / self._scale[0]
        if lead is not None:
            radius[lead.asperity] = step.along
        return np.concatenate([radius, load])

    def step_of(self, unknowns: Floats, lead: Lead | None) -> Step:
        """Return the step with these unknowns."""
        size, along = self.natural.size, 0.0
        load = unknowns[-size:] * self._scale[1]
        if self.pinned:
            return Step(np.zeros(size), load)
        radius = unknowns[:size] * self._scale[0]
        if lead is not None:
            along, radius[lead.asperity] = float(unknowns[lead.asperity]), 0.0
        return Step(radius, load, along)


class _Overlapping:
    """Matrices of the contacts that overlap others: what those do to each other."""

    def __init__(self, state: State) -> None:
        self.members, places = np.unique(state.overlap.pairs.members, return_inverse=True)
        if not self.members.size:
            return
        i, j = places.reshape(-1, 2).T
        a, p, bells = state.contacts.radius[self.members], state.load[self.members], state.bells
        self.cross = np.zeros((a.size, a.size))
        """Gaps by radii."""
        for one, other in ((i, j), (j, i)):
            np.add.at(self.cross, (one, other), -2.0 / 3.0 * bells.by_spread * a[other] * p[other])
            np.add.at(self.cross, (one, one), -2.0 / 3.0 * bells.by_spread * a[one] * p[other])
        self.own = np.diag(edge_by_radius(state)[self.members])
        """de/da by radii."""
        between = -4.0 / 9.0 * math.pi * p[i] * p[j] * bells.curvature * a[i] * a[j]
        self.own[i, j] += between
        self.own[j, i] += between
        self.by_load = np.diag(state.contacts.edge_by_load[self.members]) + math.pi * self.cross.T
        """de/da by loads."""
        self.load_by_edge = np.linalg.inv(self.by_load)
        """Loads by de/da, at the radii as they are."""
        self.ratio = self.load_by_edge @ self.own


def edge_by_radius(state: State) -> Floats:
    """Return the derivative of de/da of each contact over its own radius."""
    found, members = state.contacts.edge_by_radius.copy(), state.overlap.pairs.members.T
    if members.size:
        a, p, bells = state.contacts.radius, state.load, state.bells
        for first in members:
            bend = bells.by_spread + 2.0 / 3.0 * a[first] ** 2 * bells.curvature
            np.add.at(found, first, -2.0 / 3.0 * math.pi * p[members[0]] * p[members[1]] * bend)
    return found
