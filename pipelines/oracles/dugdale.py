"""Adhesion of finite range (Dugdale), exactly: the equilibrium curve of one asperity from its slope f' alone.

With r = a cos(psi), T = m/a and theta = acos(a/c), the order of the integrals over g and over f' exchanged,
    g(a) = a ∫ f' dpsi,   a g - G = a^2 ∫ f' cos(psi)^2 dpsi,
    I = ∫_a^c (g(x) - g(a))/sqrt(c^2 - x^2) dx = pi/2 (f(c) - f(a)) + a ∫ f' [sin(psi) atan(T/sin(psi)) - theta] dpsi,
    J = dI/dc = pi/2 f'(c) - m/c ∫ f' cos(psi)^2/(T^2 + sin(psi)^2) dpsi, all over 0 < psi < pi/2.
The curve is I + beta (m theta - c + a) = pi w/(2 sigma0). Along it delta grows where D = J - beta (1 - a/c) > 0, the
force where a D > beta c theta^2, and k = 2 E* (a - beta c theta^2/D); a = 0 is the limit theta = pi/2.
"""

from functools import cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from oracles.multiprecision import Number, mp, root, tanh_sinh
from oracles.profiles import Piece, Profile

Array = NDArray[Any]  # array of doubles, or of numbers of any precision
STEPS = 64
FIELDS = {"contact_radius": "a", "cohesive_radius": "c", "indentation": "delta", "force": "force"}
"""The fields of a state by the names of results."""


@cache
def arithmetic(digits: int) -> SimpleNamespace:
    """Return functions of numbers of ``digits``, of doubles where that is 0, and a rule on (0, 1).

    The rule is nodes x, 1 - x and weights.
    """
    nodes: Array = np.array(tanh_sinh(digits or 16, STEPS if digits else 12))
    if not digits:
        x, weight = nodes.astype(np.float64).T
        rule = x, x[::-1], weight
        return SimpleNamespace(
            number=float, sqrt=np.sqrt, sin=np.sin, log=np.log, exp=np.exp, atan2=np.arctan2, rule=rule
        )
    names = {"sqrt": 1, "sin": 1, "log": 1, "exp": 1, "atan2": 2}
    functions = {name: np.frompyfunc(getattr(mp, name), count, 1) for name, count in names.items()}
    return SimpleNamespace(number=mp.mpf, rule=(nodes[:, 0], nodes[::-1, 0], nodes[:, 1]), **functions)


class Integrals(NamedTuple):
    """The integrals of the module's docstring; ``push`` is a g - G."""

    g: Array
    push: Array
    I: Array
    J: Array


class State(NamedTuple):
    """An equilibrium: radii and indentation [m], force [N], stiffness [N/m], D [1] and a D - beta c theta^2 [m]."""

    a: Any
    c: Any
    delta: Any
    force: Any
    stiffness: Any
    growth: Any
    force_growth: Any

    def under(self, control: str) -> Any:
        """Return the force under "force", else the indentation."""
        return self.force if control == "force" else self.delta

    def grows(self, control: str) -> Any:
        """Return a number that is above 0 where the control grows along the curve: where the state is stable."""
        return self.force_growth if control == "force" else self.growth


class Dugdale:
    """Adhesion of finite range on a half-space: ``work`` [J/m2] and ``strength`` sigma0 [Pa], with pi as precise."""

    def __init__(self, effective_modulus: Number, work: Number, strength: Number, pi: Number) -> None:
        self.effective_modulus, self.work, self.strength, self.pi = effective_modulus, work, strength, pi
        self.beta = 2 * strength / effective_modulus
        self.range = work / strength
        """The gap [m] at which cohesion ends."""

    def touching(self, a: Array, c: Array, m: Array, theta: Array, found: Integrals) -> State:
        """Return the states on the curve with a > 0, from their integrals."""
        g, push, _, J = found
        growth = J - self.beta * m * m / (c * (c + a))
        pull = self.beta * c * theta**2
        force = 2 * self.effective_modulus * push - 2 * self.strength * (a * m + c * c * theta)
        stiffness = 2 * self.effective_modulus * (a - _ratio(pull, growth))
        return State(a, c, g - self.beta * m, force, stiffness, growth, a * growth - pull)

    def not_touching(self, c: Array, f: Array, slope: Array) -> State:
        """Return the states with a = 0 and cohesive radii ``c`` [m], where the profile is ``f`` [m]."""
        growth = self.pi / 2 * slope - self.beta
        delta = f - 2 * self.beta * c / self.pi - self.range
        pull = self.beta * c * self.pi**2 / 4
        force = -self.pi * self.strength * c * c
        return State(0 * c, c, delta, force, -2 * self.effective_modulus * _ratio(pull, growth), growth, -pull)


def _ratio(pull: Array, growth: Array) -> Any:
    """Return their ratio, infinite at a fold itself."""
    fold = growth == 0
    return np.where(fold, mp.inf, pull / np.where(fold, 1, growth))[()]


class Cohesion(Dugdale):
    """One asperity of ``profile`` on a half-space of ``effective_modulus`` [Pa], ``work`` [J/m2], ``strength`` [Pa]."""

    def __init__(
        self, profile: Profile, effective_modulus: Number, work: Number, strength: Number, digits: int
    ) -> None:
        self.profile, self.digits = profile, digits
        self.math = arithmetic(digits)
        number = self.math.number
        super().__init__(number(effective_modulus), number(work), number(strength), number(mp.pi))
        self.end = None if profile.end is None else number(profile.end)
        self.pieces = profile.pieces or [Piece(mp.mpf(0), None, ((mp.mpf(0), 0.0),))]

    def f(self, r: Array) -> Array:
        """Return the profile [m] at ``r`` [m]."""
        if self.end is not None:
            return np.asarray(r * r / (self.end + self.math.sqrt((self.end - r) * (self.end + r))))
        total = 0 * r
        for piece in self.pieces:
            lo = self.math.number(piece.lo)
            top = np.maximum(r, lo) if piece.hi is None else np.clip(r, lo, self.math.number(piece.hi))
            for c, power in piece.terms:
                n = self.math.number(power) + 1
                total = total + self.math.number(c) / n * (top**n - lo**n)
        return total

    def height(self, r: Number) -> Number:
        """Return ``f`` of a number."""
        return self.f(np.array([r]))[0]

    def slope(self, r: Array, inside: bool = False) -> Array:
        """Return f' [1] at ``r`` [m]; at a corner itself that from outside, or from ``inside``."""
        total = 0 * r
        for piece in self.pieces:
            hi = np.inf if piece.hi is None else self.math.number(piece.hi)
            lo = self.math.number(piece.lo)
            here = (r > lo) & (r <= hi) if inside else (r >= lo) & (r < hi)
            total = np.where(here, self._slope(piece, r), total)
        return total

    def _slope(self, piece: Piece, r: Array) -> Array:
        if self.end is not None:
            return np.asarray(r / self.math.sqrt((self.end - r) * (self.end + r)))
        return np.asarray(sum(self.math.number(c) * r ** self.math.number(power) for c, power in piece.terms))

    def integrals(self, a: Array, m: Array, c: Array, inside: bool = False) -> Integrals:
        """Return the integrals for arrays ``a`` > 0, ``m`` > 0 and ``c`` [m]."""
        sin, atan2 = self.math.sin, self.math.atan2
        x, rest, weight = self.math.rule
        T, theta = (m / a)[:, None], atan2(m, a)
        g, push, deficit, shade = 0 * a, 0 * a, 0 * a, 0 * a
        for piece in self.pieces:
            if all(coefficient == 0 for coefficient, _ in piece.terms) and self.end is None:
                continue
            begin = 0 * a if piece.hi is None else self._angle(piece.hi, a)
            length = self._angle(piece.lo, a) - begin
            beyond = self.pi / 2 - begin - length
            sine = sin(begin[:, None] + length[:, None] * x)
            cosine = sin(beyond[:, None] + length[:, None] * rest)
            density = self._slope(piece, a[:, None] * cosine) * (length[:, None] * weight)
            g = g + density.sum(axis=1)
            push = push + (density * cosine**2).sum(axis=1)
            deficit = deficit + (density * (sine * atan2(T, sine) - theta[:, None])).sum(axis=1)
            shade = shade + (density * cosine**2 / (T**2 + sine**2)).sum(axis=1)
        opening = self.pi / 2 * (self.f(c) - self.f(a)) + a * deficit
        return Integrals(a * g, a * a * push, opening, self.pi / 2 * self.slope(c, inside) - m / c * shade)

    def _angle(self, r: Number, a: Array) -> Array:
        """Return psi where a cos(psi) = r; 0 beyond a."""
        edge = self.math.number(r)
        inner = np.minimum(edge, a)
        return np.asarray(self.math.atan2(self.math.sqrt((a - inner) * (a + inner)), edge))

    def excess(self, a: Array, m: Array) -> tuple[Array, Array]:
        """Return 2 sigma0 gap(c)/(pi w), which is 1 on the curve, and its derivative by ln(m)."""
        c, theta = self.math.sqrt(a * a + m * m), self.math.atan2(m, a)
        found = self.integrals(a, m, c)
        unit = self.pi * self.range / 2
        value = found.I + self.beta * (m * theta - m * m / (c + a))
        by_c = found.J + self.beta * (c * theta / m - m * m / (c * (c + a)))
        return value / unit, by_c * m * m / (c * unit)

    def spread(self, a: Array, guess: Array) -> Array:
        """Return m [m] on the curve at each ``a`` > 0, by Newton's method in logarithms or by halves."""
        if self.end is not None:
            guess = np.minimum(guess, self.math.sqrt((self.end - a) * (self.end + a)) / 2)
        m, small = guess, (mp.mpf(10) ** (-self.digits // 2 - 4) if self.digits else 1e-6)
        low, high = guess * self.math.number("1e-60"), guess * self.math.number("1e60")
        for i in range(200):
            before, (value, by_log) = m, self.excess(a, m)
            low, high = np.where(value < 1, m, low), np.where(value > 1, m, high)
            step = self.math.log(value) * value / by_log
            m = m * self.math.exp(-np.clip(step, -3, 3))
            # Past a sharp edge the method may go to and fro.
            lost = (np.abs(step) > 0.1) & ((m <= low) | (m >= high) | (i % 4 == 3))
            m = np.where(lost, self.math.sqrt(low * high), m)
            if self.end is not None:  # short of the equator
                m = np.minimum(m, (before + self.math.sqrt((self.end - a) * (self.end + a))) / 2)
            if np.max(np.abs(step)) < small:
                return np.asarray(m)
        raise ArithmeticError("no cohesive radius")

    def at(self, a: Array, m: Array, corner: Array | None = None, inside: bool = False) -> State:
        """Return the states with contact radii ``a`` > 0 [m] and ``m`` [m] on the curve; c is given at a corner."""
        c, theta = self.math.sqrt(a * a + m * m) if corner is None else corner, self.math.atan2(m, a)
        found = self.integrals(a, m, c, inside)
        return self.touching(a, c, m, theta, found)

    def lifted(self, c: Array, inside: bool = False) -> State:
        """Return the states with a = 0 and cohesive radii ``c`` [m]."""
        return self.not_touching(c, self.f(c), self.slope(c, inside))


class Punch(Dugdale):
    """A flat punch of radius b [m]: all its contacts have c = b, and a > 0 until the springs' edges meet."""

    def __init__(self, radius: Number, effective_modulus: Number, work: Number, strength: Number) -> None:
        super().__init__(mp.mpf(effective_modulus), mp.mpf(work), mp.mpf(strength), mp.pi)
        self.b = mp.mpf(radius)

    def state(self, delta: Number) -> State:
        """Return the state at an indentation [m], stable while in contact."""
        b, always = self.b, mp.mpf(1)
        k = 2 * self.effective_modulus * b
        if delta >= 0:
            return State(b, b, delta, k * delta, k, always, always)
        m = min(b, -delta / self.beta)
        a = mp.sqrt((b - m) * (b + m))
        force = -2 * self.strength * (a * m + b * b * mp.acos(a / b))
        return State(a, b, delta, force, 2 * self.effective_modulus * a, always, mp.sign(a))

    def pull_off(self, control: str) -> State:
        """Return the state where gap(b) reaches the range of the adhesion.

        Under dead load a lifted punch detaches where it lifts: farther out the force stays the same.
        """
        b, unit = self.b, 2 * self.beta * self.strength / (mp.pi * self.work)

        def gap(m: Number) -> Number:
            a = mp.sqrt((b - m) * (b + m))
            return unit * (m * mp.acos(a / b) - b + a) - 1

        if gap(b) > 0:
            return self.state(-self.beta * root(gap, b * mp.mpf("1e-9"), b))
        return self.state(-self.beta * b if control == "force" else -2 * self.beta * b / mp.pi - self.range)

    def energy(self, state: State) -> Number:
        """Return U [J], its integrals done by hand."""
        a, b, beta = state.a, self.b, self.beta
        around = beta**2 * (2 * b**3 - 3 * b * b * a + a**3) / 3  # ∫ u1^2 from a to b
        area = (b * b * mp.acos(a / b) - a * mp.sqrt((b - a) * (b + a))) / 2  # ∫ sqrt(b^2 - x^2) from a to b
        elastic = a * state.delta**2 - around - 2 * beta * state.delta * area
        return self.effective_modulus * elastic - mp.pi * self.work * b * b
