"""The force of one asperity along a path of the flat, with many digits and from the slope f' of its profile alone.

A contact stays on the stable branches of its equilibrium curve: where one ends it jumps to the next, inwards or
outwards, or detaches; it begins at first touch.
"""

import math
from collections.abc import Iterable, Iterator

from oracles.jkr import Asperity, Branch
from oracles.multiprecision import Number, mp
from oracles.profiles import closed_profile
from scipy.optimize import brentq

from roughmdr.kernels.adhesion import release_stretch
from roughmdr.shapes import Shape

DIGITS = 40
TANGENT_RANGE = 1e-11  # of the indentation above the start of a branch, where the tangent is right to its square
_MAX_ITERATIONS = 100
_LARGEST_LOG = 34.0  # of the distance from the middle of a branch: doubles end there


def branch_numbers(indentations: Iterable[Number], ends: list[tuple[Number, Number]], touch: Number) -> Iterator[int]:
    """Yield the number of the stable branch that a contact is on at each indentation of a path, -1 for no contact.

    ``ends`` are the indentations between which each branch lies, from the innermost to the outermost; a contact begins
    at ``touch``.
    """
    branch = -1
    for delta in indentations:
        if branch < 0 and delta >= touch:
            branch = 0
        while branch >= 0 and delta < ends[branch][0]:
            branch -= 1
        while branch >= 0 and delta > ends[branch][1]:
            branch += 1
        yield branch


class ContactPath:
    """One asperity on a half-space, loaded and unloaded."""

    touch: Number = 0
    """The indentation [m] at which a contact begins."""

    def __init__(self, ends: list[tuple[Number, Number]]) -> None:
        self.ends = ends
        """Indentations [m] between which each stable branch lies."""

    def force(self, branch: int, delta: Number) -> Number:
        """Return the force [N] on a branch at an indentation [m]."""
        raise NotImplementedError

    def forces(self, indentations: list[Number]) -> list[Number]:
        """Return the force [N] at each indentation [m] of a path."""
        branches = branch_numbers(indentations, self.ends, self.touch)
        return [self.force(k, delta) if k >= 0 else mp.mpf(0) for k, delta in zip(branches, indentations, strict=True)]


class PunchPath(ContactPath):
    """A flat punch without adhesion or with JKR's: its contact radius is always b."""

    def __init__(self, radius: float, effective_modulus: float, work: float) -> None:
        b = mp.mpf(radius)
        super().__init__([(-mp.sqrt(2 * mp.pi * b * work / mp.mpf(effective_modulus)), mp.inf)])
        self.stiffness = 2 * mp.mpf(effective_modulus) * b

    def force(self, branch: int, delta: Number) -> Number:
        """Return the force [N]."""
        return self.stiffness * delta


class JkrPath(ContactPath):
    """Any other shape without adhesion or with JKR's."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float) -> None:
        width, _, _ = shape.nondimensional()
        self.shape, self.asperity = shape, Asperity(closed_profile(shape), effective_modulus, work, width)
        self.branches = self.asperity.branches("indentation")
        super().__init__([(branch.value, self._top(branch)) for branch in self.branches])

    def _top(self, branch: Branch) -> Number:
        """Return the indentation [m] where a branch ends."""
        endless = branch.hi is None or branch.hi == self.asperity.profile.end
        return mp.inf if endless else self._indentation(branch.hi)[0]

    def _indentation(self, a: Number) -> tuple[Number, Number]:
        """Return the indentation [m], and its derivative by the radius."""
        g, slope, _ = self.asperity.profile.mdr(a)
        stretch = self.asperity.dl(a)
        return g - stretch, slope - stretch / (2 * a)

    def force(self, branch: int, delta: Number) -> Number:
        """Return the force [N]: the contact radius by Newton's method, and the remainder along the tangent."""
        own = self.branches[branch]
        if delta <= own.value:
            return self.asperity.state(own.lo)["force"] if own.lo > 0 else mp.mpf(0)
        a = self._initial_guess(own, float(delta))
        for _ in range(_MAX_ITERATIONS):
            state = self.asperity.state(a)
            rest = delta - state["indentation"]
            if abs(rest) <= TANGENT_RANGE * (delta - own.value):
                return state["force"] + state["stiffness"] * rest
            before, a = a, a + rest / self._indentation(a)[1]
            a = max(a, (before + own.lo) / 2)
            a = a if own.hi is None else min(a, (before + own.hi) / 2)
        raise ArithmeticError(f"no contact of {self.shape} at {delta}")

    def _initial_guess(self, branch: Branch, delta: float) -> Number:
        """Return the contact radius [m] on a branch in double precision."""
        low, work, effective_modulus = (
            float(branch.lo),
            float(self.asperity.work),
            float(self.asperity.effective_modulus),
        )
        scale = low or float(self.asperity.width)

        def radius(y: float) -> float:
            if branch.hi is None:
                return low + scale * math.exp(y)
            return low + (float(branch.hi) - low) / (1.0 + math.exp(-y))

        def excess(y: float) -> float:
            a = radius(y)
            return float(self.shape.g(a)) - release_stretch(a, effective_modulus, work) - delta

        return mp.mpf(radius(brentq(excess, -_LARGEST_LOG, _LARGEST_LOG, xtol=1e-15)))
