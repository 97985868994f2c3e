"""One asperity on a machine: a spring in series, such as a cantilever, or a dead load.

The far end of a spring that bears the force P is at X = delta + P/k_m. Along the equilibria X grows where the contact
is stable under fixed grips and k > -k_m: there it is stable on the spring. A branch ends in folds where k = -k_m, the
lower of which comes before that of fixed grips; under dead load, k_m -> 0, P stands for X. Where k does not grow along
a branch, as for power laws under JKR with 1/2 < n < 0.768, several parts of it can be stable.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.asperity.approach import Branch, approached, branches_of
from roughmdr.asperity.contact import Contact, Results
from roughmdr.asperity.stable_parts import stable_parts
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.loading.machine import DEAD_LOAD, STIFFNESS, Machine, spring
from roughmdr.numerics.arguments import Floats

_FARTHEST = 1e150  # largest ratio of the stiffnesses of machine and contact; its square is a float
_LARGEST = 1e140  # largest state; its square is a float
_SMALLEST = 1e-290  # least distance from the foot
_ABOVE = 1e300  # stands for numbers that are not representable


class _Part(NamedTuple):
    """A part of a branch that is stable on the machine, with the control, X or P, at both ends."""

    foot: float
    top: float
    low: float
    high: float


class OnMachine(NamedTuple):
    """A contact on a machine."""

    contact: Contact
    machine: Machine

    @classmethod
    def on_spring(cls, contact: Contact, machine_stiffness: float) -> "OnMachine":
        """Return the contact on a spring [N/m]; OutOfRange where its numbers are not representable."""
        if not 1.0 / _FARTHEST < machine_stiffness / contact.stiffness < _FARTHEST:
            raise OutOfRange(
                f"machine_stiffness is {machine_stiffness:g} N/m; it must be within a factor of {_FARTHEST:g} of the "
                f"natural stiffness of the contact, {contact.stiffness:g} N/m"
            )
        return cls(contact, spring(machine_stiffness))

    def control(self, state: Floats) -> Floats:
        """Return X [m], or P [N] under dead load, at which each state is in equilibrium."""
        delta, force = self.contact.indentation_of(state), self.contact.radius_force_stiffness(state)[1]
        return -self.machine.demand(-delta, force)

    def pull_off(self) -> Results:
        """Return the state in which a slow withdrawal of the spring ends, with remote [m]; arrays of one number."""
        last = min(self._parts(branches_of(self.contact)), key=lambda part: part.low)
        results = self.contact.at_states(np.array([True]), np.array([last.foot]))
        return {**results, "remote": np.array([last.low])}

    def on_retraction(self, values: Floats) -> Results:
        """Return the contact as on slow withdrawal to each value of the control; out of contact beyond its end."""
        parts = self._parts(branches_of(self.contact))
        part = np.full(values.shape, -1)
        for i, each in enumerate(parts):
            part[values >= each.low] = i
        if not self.contact.kernels.adhesive:
            part[values <= 0.0] = -1
        return self._results(values, part, parts)

    def on_approach(self, values: Floats) -> Results:
        """Return the contact as on slow approach from afar to each value of the control; out of contact before it."""
        if not self.contact.kernels.adhesive:
            return self.on_retraction(values)
        parts = self._parts(approached(self.contact))
        part = np.full(values.shape, -1)
        for i, each in reversed(list(enumerate(parts))):
            part[values <= each.high] = i
        part[values < self.machine.weight * self.contact.onset] = -1
        return self._results(values, part, parts)

    def _parts(self, branches: list[Branch]) -> list[_Part]:
        """Return the parts of branches that are stable on the machine, outwards."""
        found = [part for branch in branches for part in stable_parts(self.contact, self.machine, branch)]
        feet = self.control(np.array([part.foot for part in found]))
        tops = self.control(np.array([part.top if part.top < math.inf else part.foot for part in found]))
        return [
            _Part(part.foot, part.top, float(low), float(high) if part.top < math.inf else math.inf)
            for part, low, high in zip(found, feet, tops, strict=True)
        ]

    def _results(self, values: Floats, part: Floats, parts: list[_Part]) -> Results:
        """Return the states on the given parts, -1 for none."""
        states = np.full(values.shape, parts[-1].foot)
        for i, each in enumerate(parts):
            here = part == i
            states[here] = self._solve(each, values[here])
        results = self.contact.at_states(part >= 0, states)
        free = values if not self.machine.is_dead_load else 0.0
        return {**results, "indentation": np.where(part >= 0, results["indentation"], free)}

    def _solve(self, part: _Part, values: Floats) -> Floats:
        """Return the states on a part at which the control has the given values."""
        from scipy.optimize.elementwise import find_root

        if not values.size:
            return values

        def excess(beyond: Floats, wanted: Floats) -> Floats:
            value = self.control(part.foot + beyond) - wanted
            return np.where(np.isnan(value), _ABOVE, value).clip(-_ABOVE, _ABOVE)

        smallest = max(_SMALLEST, 2.0**-53 * abs(part.foot))
        low = np.full(values.shape, smallest)
        high = _bracket(excess, low, values, part.top - part.foot)
        at_foot = (values <= part.low) | (excess(low, values) >= 0.0)
        at_top = excess(high, values) <= 0.0
        solved = ~(at_foot | at_top)
        while (wide := solved & (high > 2.0 * low)).any():
            middle = np.sqrt(low[wide]) * np.sqrt(high[wide])
            below = excess(middle, values[wide]) < 0.0
            low[wide], high[wide] = np.where(below, middle, low[wide]), np.where(below, high[wide], middle)
        beyond = np.where(at_foot, 0.0, high)
        if solved.any():
            beyond[solved] = find_root(excess, (low[solved], high[solved]), args=(values[solved],)).x
        return np.asarray(part.foot + beyond)


def approach_at_force(contact: Contact, force: Floats) -> Results:
    """Return the contact as on approach under each dead load [N]; OutOfRange below 0, where there is none."""
    if (force < 0.0).any():
        raise OutOfRange(
            f"force is {float(force.min())!r} N; on approach it must be at least 0 N: a pulled tip never touches"
        )
    return OnMachine(contact, DEAD_LOAD).on_approach(force)


def check_machine_stiffness(given: float | str | None, *, wanted: bool) -> float:
    """Return k_m [N/m], 0 for none; RoughmdrError unless it is given where it is ``wanted``, with remote, alone."""
    if (given is not None) != wanted:
        raise RoughmdrError(f"machine_stiffness {'is missing; remote needs it' if wanted else 'goes with remote only'}")
    return STIFFNESS.argument("machine_stiffness", given) if given is not None else 0.0


def _bracket(excess: Callable[[Floats, Floats], Floats], low: Floats, values: Floats, end: float) -> Floats:
    """Return distances from the foot at which the control is above the values, at most ``end``."""
    if end < math.inf:
        return np.full(low.shape, end)
    high = np.full(low.shape, 2.0)
    while (short := (excess(high, values) < 0.0) & (high < _LARGEST)).any():
        high[short] *= high[short]
    return high
