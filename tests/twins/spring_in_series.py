"""One asperity on a spring in series, slow and plain: its equilibria as one curve, looked at point by point.

A curve begins where the surfaces come to attract each other. Along it X = delta + P/k_m is sampled: on retraction the
contact is at the last point with the X that is asked for, on approach at the first that X rises through, and it
detaches where X is least. Units: forces [N], lengths [m], E* [Pa], w [J/m2], strength [Pa].
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

Floats = NDArray[np.float64]


class State(NamedTuple):
    """Contact radius [m], indentation [m] and force [N]."""

    a: Floats
    delta: Floats
    force: Floats


@dataclass(frozen=True)
class Jkr:
    """The curve of a profile under JKR, over a/size: delta = g - dl, P = 2 E* (a g - G - a dl)."""

    modulus: float
    work: float
    size: float
    largest: float = 3000.0

    @property
    def grid(self) -> Floats:
        """Points of the curve, from first touch on."""
        return np.concatenate([np.geomspace(1e-9, 0.5, 2000), np.linspace(0.5, 3.0, 20001)[1:], self.outer])

    @property
    def outer(self) -> Floats:
        """Its outer points."""
        return np.geomspace(3.0, self.largest, 10001)[1:]

    def g_and_reduced_load(self, a: Floats) -> tuple[Floats, Floats]:
        """Return g [m] and a g - G [m2]."""
        raise NotImplementedError

    def at(self, p: Floats) -> State:
        """Return the states at points of the curve."""
        a = self.size * p
        g, reduced = self.g_and_reduced_load(a)
        dl = np.sqrt(2.0 * math.pi * a * self.work / self.modulus)
        return State(a, g - dl, 2.0 * self.modulus * (reduced - a * dl))


@dataclass(frozen=True)
class JkrPowerLaw(Jkr):
    """The curve of g = coefficient x^n."""

    n: float = 2.0
    coefficient: float = 1.0

    def g_and_reduced_load(self, a: Floats) -> tuple[Floats, Floats]:
        """Return g [m] and a g - G = n/(n + 1) a g [m2]."""
        g = self.coefficient * a**self.n
        return g, self.n / (self.n + 1.0) * a * g


@dataclass(frozen=True)
class JkrTruncatedCone(Jkr):
    """The curve of a cone of a slope with a flat of the radius ``size``."""

    slope: float = 0.1

    def g_and_reduced_load(self, a: Floats) -> tuple[Floats, Floats]:
        """Return g = S a acos(b/a) [m] and a g - G [m2]; 0 on the flat."""
        b, beyond = self.size, np.maximum(a, self.size)
        angle, q = np.arccos(b / beyond), np.sqrt((beyond - b) * (beyond + b))
        return self.slope * beyond * angle, 0.5 * self.slope * (beyond**2 * angle + b * q)


@dataclass(frozen=True)
class JkrRoundedCone(Jkr):
    """The curve of a cone of a slope with a tip that is rounded to the radius ``size``."""

    slope: float = 0.1

    def g_and_reduced_load(self, a: Floats) -> tuple[Floats, Floats]:
        """Return g [m] and a g - G [m2], by the closed forms of both."""
        b, beyond, s = self.size, np.maximum(a, self.size), self.slope
        angle, q = np.arccos(b / beyond), np.sqrt((beyond - b) * (beyond + b))
        g = s * beyond * (beyond - q) / b + s * beyond * angle
        G = s * (beyond**3 - q**3) / (3.0 * b) + 0.5 * s * (beyond**2 * angle - b * q)
        tip = a < b
        return np.where(tip, s * a * a / b, g), np.where(tip, 2.0 * s * a**3 / (3.0 * b), beyond * g - G)


@dataclass(frozen=True)
class JkrPunch(Jkr):
    """The curve of a flat punch of the radius ``size``: from 1 on it is in contact, and pressed by dl a unit."""

    def at(self, p: Floats) -> State:
        """Return the states at points of the curve."""
        a = self.size * np.minimum(p, 1.0)
        dl = np.sqrt(2.0 * math.pi * a * self.work / self.modulus)
        delta = dl * (np.maximum(p, 1.0) - 2.0)
        return State(a, delta, 2.0 * self.modulus * a * delta)


@dataclass(frozen=True)
class DugdaleParaboloid:
    """The curve of a paraboloid after Maugis: up to 1 over c with a = 0, beyond over a/m."""

    modulus: float
    work: float
    strength: float
    radius: float

    @property
    def grid(self) -> Floats:
        """Points of the curve, from where the attraction begins."""
        return np.concatenate([np.linspace(0.0, 1.0, 4001), 1.0 + np.geomspace(1e-6, 60.0, 20000)])

    def at(self, p: Floats) -> State:
        """Return the states at points of the curve."""
        beta, gap, R = 2.0 * self.strength / self.modulus, self.work / self.strength, self.radius
        slack = (1.0 - 2.0 / math.pi) * beta
        c_touch = R * (math.hypot(slack, math.sqrt(2.0 * gap / R)) - slack)
        c = c_touch * np.minimum(p, 1.0)
        T = 1.0 / np.maximum(p - 1.0, 1e-9)
        theta = np.arctan(T)
        square = ((T * T - 1.0) * theta + T) / R
        linear = beta * (T * theta - np.sqrt(1.0 + T * T) + 1.0)
        a = math.pi * gap / (linear + np.sqrt(linear * linear + square * math.pi * gap))
        m, outer = a * T, a * np.sqrt(1.0 + T * T)
        push = 2.0 * a**3 / (3.0 * R) - 0.5 * beta * (a * m + outer**2 * theta)
        lifted = p <= 1.0
        return State(
            np.where(lifted, 0.0, a),
            np.where(lifted, c * c / (2.0 * R) - 2.0 / math.pi * beta * c - gap, a * a / R - beta * m),
            np.where(lifted, -math.pi * self.strength * c * c, 2.0 * self.modulus * push),
        )


@dataclass(frozen=True)
class Held:
    """A curve on a spring [N/m]."""

    curve: Jkr | DugdaleParaboloid
    stiffness: float

    def remote(self, p: Floats | float) -> Floats:
        """Return X [m] at points of the curve."""
        state = self.curve.at(np.asarray(p, dtype=np.float64))
        return state.delta + state.force / self.stiffness

    def detachment(self) -> tuple[float, State]:
        """Return the least X [m], and the state there; at a fold the state is known to a root of rounding."""
        grid = self.curve.grid
        least = int(np.argmin(self.remote(grid)))
        around = (float(grid[max(least - 1, 0)]), float(grid[least + 1]))
        found = minimize_scalar(
            lambda p: float(self.remote(p)), bounds=around, method="bounded", options={"xatol": 1e-14}
        )
        p = min((float(found.x), float(grid[least])), key=lambda p: float(self.remote(p)))
        return float(self.remote(p)), self.curve.at(np.asarray(p))

    def retracted(self, remote: float) -> State:
        """Return the state at the last point with this X [m]."""
        return self._crossing(remote, -1)

    def approached(self, remote: float) -> State:
        """Return the state at the first point at which X [m] has risen so far."""
        return self._crossing(remote, 0)

    def _crossing(self, remote: float, which: int) -> State:
        grid = self.curve.grid
        below = self.remote(grid) < remote
        i = int(np.flatnonzero(below[:-1] & ~below[1:])[which])
        p = brentq(lambda p: float(self.remote(p)) - remote, grid[i], grid[i + 1], xtol=1e-15, rtol=1e-15)
        return self.curve.at(np.asarray(p))
