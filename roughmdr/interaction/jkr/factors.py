"""A tangent of adhesive contacts that is factored at one state, by which near states find their equilibrium.

All terms of the energy are in it but what the moments do that neighbours induce: of the fourth order in radius over
distance. Loads follow from the edge condition, so that one number stands for each contact.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from roughmdr.interaction.jkr.equilibrium import Problem, State, Step
from roughmdr.numerics.arguments import Floats


class Lead(NamedTuple):
    """A radius that is given, so that the place along the path follows."""

    asperity: int
    by_place: Step
    """The change of the contacts along the path as the factors have it."""


class Factors:
    """The factored tangent at a state in which all asperities are in contact."""

    def __init__(self, problem: Problem, state: State) -> None:
        contacts, matrices, pairs = state.contacts, problem.coupling.matrices, problem.pairs
        a, p = contacts.radius, state.load
        self.pinned, self.natural = problem.kernels.pinned, problem.natural
        self._scale = a, 2.0 / math.pi * a * problem.natural
        self.release = state.release
        i, j = pairs.members.T
        block = matrices[0].copy()
        self._by_load = contacts.edge_by_load
        self._cross: Floats | None = None  # of gaps by radii, but for those of the contacts themselves
        if problem.order == 2:
            block += (a[:, None] ** 2 + a[None, :] ** 2) / 6.0 * matrices[3]
            whole = state.field + state.outer
            sliding = matrices[1] * whole[1] + matrices[2] * whole[2]
            lifted = sliding * contacts.lift
            block += lifted
            block += lifted.T
            self._cross = -0.25 * contacts.moment_by_radius * matrices[3] - sliding * (contacts.edge_by_tilt / math.pi)
        elif i.size:
            self._cross = np.zeros_like(block)
        block[np.diag_indices(a.size)] += 0.5 * math.pi / a
        if i.size:
            bells = state.bells
            block[i, j] += bells.value
            block[j, i] += bells.value
            assert self._cross is not None
            for one, other in ((i, j), (j, i)):
                self._cross[one, other] -= 2.0 / 3.0 * bells.by_spread * a[other] * p[other]
                np.add.at(self._cross, (one, one), -2.0 / 3.0 * bells.by_spread * a[one] * p[other])
        self._block = block
        if self.pinned:
            self._follow = np.zeros(a.size)
            matrix = -block
        else:
            own = edge_by_radius(problem, state)
            self._follow = -own / self._by_load
            matrix = -block * self._follow
            matrix[np.diag_indices(a.size)] += self._by_load / math.pi
            if self._cross is not None:
                matrix += self._cross
                matrix += (0.5 * math.pi**2 / (a * self._by_load))[:, None] * self._cross.T * self._follow
            if i.size:
                self._between = between = -4.0 / 9.0 * math.pi * p[i] * p[j] * bells.curvature * a[i] * a[j]
                self._members = i, j
                matrix[i, j] += 0.5 * math.pi / (a[i] * self._by_load[i]) * between
                matrix[j, i] += 0.5 * math.pi / (a[j] * self._by_load[j]) * between
        self._lu = lu_factor(matrix, check_finite=False, overwrite_a=True)

    @property
    def stable(self) -> bool:
        """Whether an even number of folds lies between the state and one without tension."""
        lu, pivots = self._lu
        swaps = np.count_nonzero(pivots != np.arange(pivots.size))
        signs = np.count_nonzero(np.diag(lu) < 0.0)
        return bool((signs + swaps + pivots.size) % 2 == 0)

    def solve(self, edge: Floats, gap: Floats, lead: Lead | None = None) -> Step:
        """Return the step with these changes of de/da and of the gaps."""
        if self.pinned:
            step = Step(np.zeros_like(gap), np.asarray(lu_solve(self._lu, gap, check_finite=False)))
        else:
            given = edge / self._by_load
            right = gap + self._block @ given
            if self._cross is not None:
                right -= 0.5 * math.pi**2 / (self._scale[0] * self._by_load) * (given @ self._cross)
            radius = np.asarray(lu_solve(self._lu, right, check_finite=False))
            step = Step(radius, self._loads(radius, given))
        if lead is None:
            return step
        other, number = lead.by_place, lead.asperity
        along = -float(step.radius[number] / other.radius[number])
        radius = step.radius + along * other.radius
        radius[number] = 0.0
        return Step(radius, step.load + along * other.load, along)

    def _loads(self, radius: Floats, given: Floats) -> Floats:
        """Return the changes of the loads that keep the edge condition."""
        load = given + self._follow * radius
        if self._cross is None:
            return load
        other = math.pi * (load @ self._cross)
        if hasattr(self, "_members"):
            i, j = self._members
            np.add.at(other, i, self._between * radius[j])
            np.add.at(other, j, self._between * radius[i])
        return np.asarray(load - other / self._by_load)

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
        load = unknowns[-size:] * self._scale[1] if size else np.zeros(0)
        if self.pinned:
            return Step(np.zeros(size), load)
        radius = unknowns[:size] * self._scale[0]
        if lead is not None:
            along, radius[lead.asperity] = float(unknowns[lead.asperity]), 0.0
        return Step(radius, load, along)


def edge_by_radius(problem: Problem, state: State) -> Floats:
    """Return the derivative of de/da of each contact over its own radius."""
    found = state.contacts.edge_by_radius.copy()
    if problem.pairs.members.size:
        a, p, bells = state.contacts.radius, state.load, state.bells
        members = problem.pairs.members.T
        for first in members:
            bend = bells.by_spread + 2.0 / 3.0 * a[first] ** 2 * bells.curvature
            np.add.at(found, first, -2.0 / 3.0 * math.pi * p[members[0]] * p[members[1]] * bend)
    return found
