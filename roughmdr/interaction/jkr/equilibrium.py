"""Adhesive contacts in equilibrium at one separation: Newton's method on their radii and loads.

The energy of all contacts is stationary over the loads, so that the derivatives over radii and loads make up one
symmetric tangent of the second order. Steps are found by GMRES with it, begun from a tangent of the contacts alone
with G between them. Near the end of a stable path one radius is given and the place along the path is found instead:
there the tangent is regular.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import LinearOperator, gmres

from roughmdr.interaction import close
from roughmdr.interaction.contacts import Asperities
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.jkr import coincident
from roughmdr.interaction.jkr.contacts import Contacts, JkrKernels
from roughmdr.numerics.arguments import Floats

_PATIENCE = 3  # steps, in which the residual has to halve
_RTOL, _RESTART = 1e-3, 30
_LARGEST_STEP = 0.3  # of a radius
_ROUNDING = 16.0 * np.finfo(np.float64).eps
_ERROR = 1e-13  # of the natural depth
_AT_REST = 1e3  # times the error: where rounding lets no step go further

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


def tolerance(problem: Problem, state: State) -> float:
    """Return the residual over the natural depth that rounding leaves."""
    on = state.inside
    size = np.abs(problem.asperities.height - state.separation) + np.abs(state.potential) + np.abs(state.contacts.depth)
    return float(np.max(_ERROR + _ROUNDING * (size / problem.natural)[on], initial=_ERROR))


@np.errstate(all="ignore")  # a guess that no float holds leads nowhere
def newton(
    problem: Problem, state: State, drive: Drive, factors: Factors, along: float = 0.0, lead: int | None = None
) -> tuple[State, float]:
    """Return the equilibrium from a guess, and the place along the path, which changes only with a leading radius.

    Its error is inf where there is none to be found.
    """
    errors = [math.inf] * _PATIENCE
    while state.inside.any():
        limit = tolerance(problem, state)
        if state.error <= limit or (state.error > 0.5 * errors[-1] and errors[-1] <= _AT_REST * limit):
            break
        if not state.error < 0.5 * errors[-_PATIENCE] and math.isfinite(errors[-_PATIENCE]):
            return state._replace(error=math.inf), along
        if not math.isfinite(state.error):
            break
        errors.append(state.error)
        tangent = Tangent(problem, state, drive, factors, lead)
        on = tangent.on
        edge = -state.edge[on] * 2.0 * np.sqrt(2.0 * math.pi * problem.work * state.contacts.radius[on])
        step = tangent.solve(edge, -state.gap[on])
        if not (np.isfinite(step.radius).all() and np.isfinite(step.load).all() and math.isfinite(step.along)):
            return state._replace(error=math.inf), along
        largest = 0.0 if tangent.pinned else float(np.max(np.abs(step.radius) / (state.contacts.slope * state.t)[on]))
        part = min(1.0, _LARGEST_STEP / largest) if largest > 0.0 else 1.0
        state, along = moved(problem, state, on, step, part, drive, along)
    return state, along


def moved(
    problem: Problem, state: State, on: NDArray[np.int64], step: Step, part: float, drive: Drive, along: float
) -> tuple[State, float]:
    """Return the state moved by a part of a step, and its place along the path."""
    t, load = state.t.copy(), state.load.copy()
    if not problem.kernels.pinned:
        t[on] = np.maximum(t[on] + part * step.radius / state.contacts.slope[on], 0.1 * t[on])
    load[on] += part * step.load
    change = part * step.along
    outer = state.outer + drive.outer * change
    return evaluate(problem, state.inside, t, load, state.separation + drive.separation * change, outer), along + change
