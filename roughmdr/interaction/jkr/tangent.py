"""The derivatives of the energy of adhesive contacts over their radii and loads, and steps that solve with them.

They make up one symmetric tangent of the second order. Steps are found by GMRES with it, begun from a tangent of the
contacts alone with G between them. Near the end of a stable path one radius is given and the place along the path is
found instead: there the tangent is regular.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import LinearOperator, gmres

from roughmdr.interaction import close
from roughmdr.interaction.jkr.equilibrium import Problem, State
from roughmdr.numerics.arguments import Floats

_RTOL, _RESTART = 1e-3, 30


class Step(NamedTuple):
    """A change of the state."""

    radius: Floats
    load: Floats
    along: float = 0.0
    """Change of the place along the path."""


class Drive(NamedTuple):
    """By how much separation and outer field change along a path from 0 to 1."""

    separation: float
    outer: Floats


class Factors:
    """The tangent of contacts with G between them alone, factored at one state; steps from near states begin with it.

    Radii follow from the edge condition, so that one number stands for each contact.
    """

    def __init__(self, problem: Problem, state: State) -> None:
        self.inside = state.inside
        self.on = on = np.flatnonzero(state.inside)
        contacts, matrices, pairs = state.contacts, problem.coupling.matrices, problem.pairs
        a = contacts.radius[on]
        block = matrices[0][np.ix_(on, on)]
        if problem.order == 2:
            block += (a[:, None] ** 2 + a[None, :] ** 2) / 6.0 * matrices[3][np.ix_(on, on)]
        if pairs.members.size:
            number = np.full(state.t.size, -1)
            number[on] = np.arange(on.size)
            i, j = number[pairs.members].T
            keep = (i >= 0) & (j >= 0)
            i, j, share, away = i[keep], j[keep], pairs.share[keep], pairs.apart[keep, 2]
            expanded = 1.0 / away
            if problem.order == 2:
                expanded = expanded + (a[i] ** 2 + a[j] ** 2) / 6.0 / away**3
            change = state.bells.value[keep] - share * expanded
            block[i, j] += change
            block[j, i] += change
        block[np.diag_indices(on.size)] += 0.5 * math.pi / a
        self.block, self.by_load = block, contacts.edge_by_load[on]
        if problem.kernels.pinned:
            self.follow = np.ones(on.size)
            matrix = -block
        else:
            self.follow = -edge_by_radius(problem, state)[on] / self.by_load
            matrix = -block * self.follow
            matrix[np.diag_indices(on.size)] += self.by_load / math.pi
        self._lu = lu_factor(matrix, check_finite=False, overwrite_a=True)

    def solve(self, right: Floats) -> Floats:
        """Return the numbers of the contacts for changes of the gaps."""
        return np.asarray(lu_solve(self._lu, right, check_finite=False))

    @property
    def stable(self) -> bool:
        """Whether an even number of folds lies between the state and one without tension."""
        lu, pivots = self._lu
        swaps = np.count_nonzero(pivots != np.arange(pivots.size))
        signs = np.count_nonzero(np.diag(lu) < 0.0)
        return bool((signs + swaps + self.on.size) % 2 == 0)


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


class Tangent:
    """The derivatives at a state, and steps that solve with them; ``lead`` has a radius that is given."""

    def __init__(self, problem: Problem, state: State, drive: Drive, factors: Factors, lead: int | None = None) -> None:
        self.problem, self.state, self.drive, self.factors = problem, state, drive, factors
        self.on = factors.on
        self._release = np.sqrt(2.0 * math.pi * problem.work * state.contacts.radius[self.on])
        self.pinned = problem.kernels.pinned
        self.lead = None if lead is None else int(np.searchsorted(self.on, lead))
        if self.lead is not None:
            self._by_place = factors.solve(self.along()[1])

    def along(self) -> tuple[Floats, Floats]:
        """Return the derivatives of both residuals by the place along the path."""
        return self.product(Step(np.zeros(self.on.size), np.zeros(self.on.size), 1.0))

    def rate(self, rtol: float = _RTOL) -> Step:
        """Return the change of the contacts along the path."""
        edge, gap = self.along()
        return self.solve(-edge, -gap, rtol)

    def product(self, step: Step) -> tuple[Floats, Floats]:
        """Return the changes of de/da and of the gap by a step; symmetric, the second times pi."""
        problem, on, contacts, state = self.problem, self.on, self.state.contacts, self.state
        pairs = problem.pairs
        radius, load = np.zeros(state.t.size), np.zeros(state.t.size)
        radius[on], load[on] = step.radius, step.load
        outer = self.drive.outer * step.along
        a, c = contacts.radius, contacts
        edge = c.edge_by_radius * radius + c.edge_by_load * load
        gap = -np.where(state.inside, -c.edge_by_load / math.pi * radius, 0.0)
        gap[on] -= 0.5 * math.pi / a[on] * step.load
        if problem.order == 1:
            field = np.zeros((4, load.size))
            field[0] = problem.coupling.potential(load)
            zero = np.zeros_like(field)
            close.take_from_field(pairs, load, zero)
            field[0] += zero[0]
            gap -= field[0]
        else:
            field = problem.coupling.field(load)
            close.take_from_field(pairs, load, field)
            gap -= field[0]
            field = field + outer
            whole = state.field + state.outer
            bent, tilt = 0.25 * field[3], field[1:3]
            along = whole[1] * tilt[0] + whole[2] * tilt[1]
            edge += c.edge_by_curvature * bent + c.edge_by_tilt * along
            moment = c.moment_by_radius * radius + 2.0 / 3.0 * a * a * load - 32.0 / (45.0 * math.pi) * a**5 * bent
            turn = c.edge_by_tilt / math.pi * radius + np.where(state.inside, c.lift, 0.0) * load
            moments = 0.25 * moment, c.tilting * tilt[0] + turn * whole[1], c.tilting * tilt[1] + turn * whole[2]
            other = problem.coupling.of_moments(*moments)
            close.take_from_moments(pairs, *moments, other)
            gap -= other + 2.0 / 3.0 * a * a * bent - np.where(state.inside, c.lift, 0.0) * along
        if pairs.members.size:
            i, j = pairs.members.T
            p, bells = state.load, state.bells
            spread = 2.0 / 3.0 * (a[i] * radius[i] + a[j] * radius[j])
            np.add.at(gap, i, -(bells.value * load[j] + bells.by_spread * spread * p[j]))
            np.add.at(gap, j, -(bells.value * load[i] + bells.by_spread * spread * p[i]))
            product = load[i] * p[j] + p[i] * load[j]
            for one in (i, j):
                change = product * bells.by_spread * a[one]
                change = change + p[i] * p[j] * (bells.by_spread * radius[one] + bells.curvature * spread * a[one])
                np.add.at(edge, one, -2.0 / 3.0 * math.pi * change)
        gap -= self.drive.separation * step.along + outer[0]
        return edge[on], gap[on]

    def _scaled(self, unknown: Floats) -> Step:
        """Return the step of unknowns: radii and loads over their scales, the leading radius in favour of the place."""
        on, natural = self.on, self.problem.natural[self.on]
        a = self.state.contacts.radius[on]
        radius, load = unknown[: on.size] * a, unknown[on.size :] * (2.0 / math.pi * a * natural)
        if self.pinned:
            radius = np.zeros(on.size)
        if self.lead is None:
            return Step(radius, load)
        along, radius[self.lead] = float(unknown[self.lead]), 0.0
        return Step(radius, load, along)

    def _unscaled(self, step: Step) -> Floats:
        on, natural = self.on, self.problem.natural[self.on]
        a = self.state.contacts.radius[on]
        first = step.radius / a
        if self.lead is not None:
            first[self.lead] = step.along
        return np.concatenate([first, step.load / (2.0 / math.pi * a * natural)])

    def _rows(self, edge: Floats, gap: Floats) -> Floats:
        natural = self.problem.natural[self.on]
        return np.concatenate([edge / (2.0 * self._release) / natural, gap / natural])

    def _before(self, rows: Floats) -> Floats:
        """Solve with the factored tangent."""
        on, natural, factors = self.on, self.problem.natural[self.on], self.factors
        edge, gap = rows[: on.size] * 2.0 * self._release * natural, rows[on.size :] * natural
        if self.pinned:
            found = factors.solve(gap)
            return np.concatenate([rows[: on.size], self._unscaled(Step(np.zeros(on.size), found))[on.size :]])
        given = edge / factors.by_load
        found, along = factors.solve(gap + factors.block @ given), 0.0
        if self.lead is not None:
            along = float(found[self.lead] / self._by_place[self.lead])
            found = found - along * self._by_place
            found[self.lead] = 0.0
        return self._unscaled(Step(found, factors.follow * found + given, along))

    def solve(self, edge: Floats, gap: Floats, rtol: float = _RTOL) -> Step:
        """Return the step with these changes of de/da and of the gap."""
        size = 2 * self.on.size
        right = self._rows(edge, gap)
        if not right.any():
            return Step(np.zeros(self.on.size), np.zeros(self.on.size))

        def product(unknown: Floats) -> Floats:
            unknown = unknown.ravel()
            rows = self._rows(*self.product(self._scaled(unknown)))
            if self.pinned:
                rows[: self.on.size] = unknown[: self.on.size]
            return rows

        operator = LinearOperator((size, size), matvec=product, dtype=np.float64)
        before = LinearOperator((size, size), matvec=lambda rows: self._before(rows.ravel()), dtype=np.float64)
        found, _ = gmres(operator, right, M=before, rtol=rtol, atol=0.0, restart=min(_RESTART, size), maxiter=2)
        return self._scaled(found)
