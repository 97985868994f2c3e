"""The second derivatives of the energy of adhesive contacts over their radii and loads: one symmetric tangent.

Steps with it are found from those with its factors.
"""

import math

import numpy as np
from scipy.linalg.lapack import dgelss

from roughmdr.interaction import close
from roughmdr.interaction.coupling import add_moments, field_of
from roughmdr.interaction.jkr.contacts import Contacts
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, Step
from roughmdr.interaction.jkr.factors import Factors, Lead
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_MAX_STEPS = 50
_REMEMBERED = 8  # steps of an iteration, by which the next is improved
_RCOND = 1e-12


class Mixing:
    """Steps of an iteration, improved by those before (D. G. Anderson, J. ACM 12 (1965) 547)."""

    def __init__(self) -> None:
        self._steps = list[Floats]()
        self._ways = list[Floats]()

    def improved(self, step: Floats) -> Floats:
        """Return the way to where the steps so far, with this one, say that there is none; one without end as it is."""
        self._steps = [*self._steps[-_REMEMBERED:], step]
        steps, most = np.array(self._steps), min(_REMEMBERED, step.size)
        if not self._ways or not np.isfinite(steps).all():
            return step
        changes = (steps[1:] - steps[:-1])[-most:]
        part = dgelss(changes.T, step, cond=_RCOND)[1][: len(changes)]
        return np.asarray(step - part @ (changes + self._ways[-most:]))

    def go(self, way: Floats) -> None:
        """Have the iteration go a way from its last point."""
        self._ways.append(way)


@njit
def _respond(c: Contacts, radius: Floats, load: Floats, whole: Floats, field: Floats, order: int, rows: Floats) -> None:
    """Fill ``rows`` of the changes of de/da, of the gaps and, to second order, of the moments that displace others.

    Radii and loads change, and the field on a contact, which is ``whole``, by ``field``.
    """
    edge, gap, bending, along_x, along_y = rows
    for i in range(load.size):
        a = c.radius[i]
        edge[i] = c.edge_by_radius[i] * radius[i] + c.edge_by_load[i] * load[i]
        gap[i] = c.edge_by_load[i] / math.pi * radius[i] - 0.5 * math.pi / a * load[i] - field[0, i]
        if order == 1:
            continue
        x, y, bent = field[1, i], field[2, i], 0.25 * field[3, i]
        along = whole[1, i] * x + whole[2, i] * y
        edge[i] += c.edge_by_curvature[i] * bent + c.edge_by_tilt[i] * along
        gap[i] -= 2.0 / 3.0 * a * a * bent - c.lift[i] * along
        moment = c.moment_by_radius[i] * radius[i] + 2.0 / 3.0 * a * a * load[i]
        bending[i] = 0.25 * (moment - 32.0 / (45.0 * math.pi) * a**5 * bent)
        turn = c.edge_by_tilt[i] / math.pi * radius[i] + c.lift[i] * load[i]
        along_x[i] = c.tilting[i] * x + turn * whole[1, i]
        along_y[i] = c.tilting[i] * y + turn * whole[2, i]


class Tangent:
    """The derivatives at a state in which all asperities are in contact."""

    def __init__(self, problem: PairProblem, state: State, drive: Drive) -> None:
        self.problem, self.state, self.drive = problem, state, drive

    def along(self) -> tuple[Floats, Floats]:
        """Return the derivatives of de/da and of the gaps by the place along the path."""
        nothing = np.zeros(self.state.t.size)
        return self.product(Step(nothing, nothing, 1.0))

    def product(self, step: Step) -> tuple[Floats, Floats]:
        """Return the changes of de/da and of the gaps by a step; symmetric, the second times pi."""
        problem, contacts, state, load = self.problem, self.state.contacts, self.state, step.load
        pairs, closer = state.overlap.pairs, -self.drive.separation * step.along
        outer = self.drive.outer * step.along
        field = field_of(problem.coupling, pairs, problem.order, load) + outer[:4]
        sharing = pairs._replace(share=state.overlap.rate)
        if closer != 0.0 and pairs.share.size:
            close.take_from_field(sharing, closer * state.load, problem.order, field)
        edge, gap, bending, along_x, along_y = rows = np.zeros((5, load.size))
        whole = state.field + state.outer[:4]
        _respond(contacts, step.radius, load, whole, field, problem.order, rows)
        edge += outer[4]
        gap += closer
        if problem.order == 2:
            potential = np.zeros_like(gap)
            add_moments(problem.coupling, pairs, (bending, along_x, along_y), potential)
            if closer != 0.0 and pairs.share.size:
                bent, (x, y) = 0.25 * closer * contacts.second_moment, closer * contacts.tilting * whole[1:3]
                close.take_from_moments(sharing, bent, x, y, potential)
            gap -= potential
        if pairs.share.size:
            self._add_bells(step, closer, edge, gap)
        return edge, gap

    def _add_bells(self, step: Step, closer: float, edge: Floats, gap: Floats) -> None:
        """Add what the contacts of overlapping pairs do to each other; ``closer`` by how much the flat comes."""
        pairs, rate = self.state.overlap
        i, j = pairs.members.T
        a, p, bells, radius, load = self.state.contacts.radius, self.state.load, self.state.bells, *step[:2]
        spread, grown = 2.0 / 3.0 * (a[i] * radius[i] + a[j] * radius[j]), closer * rate / pairs.share
        change = bells.by_spread * spread + bells.value * grown
        np.add.at(gap, i, -(bells.value * load[j] + change * p[j]))
        np.add.at(gap, j, -(bells.value * load[i] + change * p[i]))
        product = load[i] * p[j] + p[i] * load[j] + p[i] * p[j] * grown
        for one in (i, j):
            change = product * bells.by_spread * a[one]
            change = change + p[i] * p[j] * (bells.by_spread * radius[one] + bells.curvature * spread * a[one])
            np.add.at(edge, one, -2.0 / 3.0 * math.pi * change)

    def rate(self, factors: Factors, rtol: float, lead: Lead | None = None) -> Step:
        """Return the change of the contacts along the path, or with a leading radius, whose change is 1."""
        nothing = np.zeros(self.state.t.size)
        if lead is None:
            edge, gap = self.along()
            return self.solve(-edge, -gap, factors, rtol)
        one = nothing.copy()
        one[lead.asperity] = 1.0
        edge, gap = self.product(Step(one, nothing))
        return self.solve(-edge, -gap, factors, rtol, lead)

    @np.errstate(all="ignore")  # a singular tangent has no step
    def solve(self, edge: Floats, gap: Floats, factors: Factors, rtol: float, lead: Lead | None = None) -> Step:
        """Return the step with these changes of de/da and of the gaps; NaN where it is not found."""
        step = factors.solve(edge, gap, lead)
        found = factors.unknowns(step, lead)
        mixing, size = Mixing(), float(np.abs(found).max(initial=0.0))
        for _ in range(_MAX_STEPS):
            by_edge, by_gap = self.product(factors.step_of(found, lead))
            change = factors.unknowns(factors.solve(edge - by_edge, gap - by_gap, lead), lead)
            if not np.abs(change).max(initial=0.0) > rtol * size:
                return factors.step_of(found + change, lead)
            way = mixing.improved(change)
            mixing.go(way)
            found = found + way
        nothing = np.full(gap.size, math.nan)
        return Step(nothing, nothing, math.nan)


def leading(problem: PairProblem, state: State, drive: Drive, factors: Factors, asperity: int) -> Lead:
    """Return the radius of an asperity as one that is given."""
    edge, gap = Tangent(problem, state, drive).along()
    return Lead(asperity, factors.solve(-edge, -gap), -edge)
