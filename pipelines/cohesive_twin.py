"""A slow reference: one power-law asperity under adhesion of finite range (Dugdale), in closed form with 60 digits.

With x = c cos(phi), a = c cos(theta), m = c sin(theta), F = ∫_0^theta cos(phi)^n dphi and beta = 2 sigma0/E*, what the
gap at c asks for is

    g(1) c^n (F - theta cos(theta)^n) + beta c (theta sin(theta) - 1 + cos(theta)) = pi w/(2 sigma0),

with one root c for each theta. Along the curve the indentation grows where D = n g(1) c^(n-1) F - beta (1 - a/c) > 0,
the force where a D > beta c theta^2, and k = 2 E* (a - beta c theta^2/D). Beyond theta = pi/2 contact is lost, a = 0,
and c alone tells the state.
"""

import itertools
from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

from twins import PowerShape, Real, Twin, mp

_SPREADS = [mp.mpf(10) ** decade for decade in (-9, -7, *(i / 2 for i in range(-10, 9)), 6, 8, 10, 12)]
"""m/a, from contacts as in JKR to those that hardly touch."""
_FURTHER = (0.7, (-50, -40, -30, -24, -18, -13), (20, 40)), (0.53, (-200, -160, -120, -90, -70), ())
"""Below which exponent which decades of m/a belong to the curve too, before and after those."""
_CLOSE = mp.mpf(10) ** -45
_LEAP = 100  # in the logarithm of m/a
_PATIENCE = 400


class State(NamedTuple):
    """An equilibrium."""

    spread: Real
    """m/a; infinite where a = 0."""
    contact_radius: Real
    cohesive_radius: Real
    indentation: Real
    force: Real
    stiffness: Real
    growth: Real
    """D."""
    force_growth: Real
    fall: Real
    """-d(ln c)/d(ln m/a)."""

    def under(self, control: str) -> Real:
        """The control."""
        return self.force if control == "force" else self.indentation

    def grows(self, control: str) -> Real:
        """Above 0 where the control grows along the curve, which is stable."""
        return self.force_growth if control == "force" else self.growth


class CohesiveTwin:
    """f = c r^n pressed into a half-space; ``strength`` is sigma0 [Pa]."""

    def __init__(self, shape: PowerShape, effective_modulus: float, work: float, strength: float) -> None:
        self.plain = Twin(shape, effective_modulus, work)
        self.strength = mp.mpf(strength)
        self.beta = 2 * self.strength / self.plain.effective_modulus
        self.range = self.plain.work / self.strength

    def at(self, spread: Real) -> State:
        """The equilibrium with ``spread`` = m/a > 0."""
        with mp.workdps(mp.dps + 2 * max(0, -int(mp.log10(spread)))):  # digits that F - theta cos(theta)^n loses
            theta, cosine = mp.atan(spread), 1 / mp.sqrt(1 + spread * spread)
            return self._at(spread, theta, cosine, spread * cosine)

    def _at(self, spread: Real, theta: Real, cosine: Real, sine: Real) -> State:
        plain, n = self.plain, self.plain.n
        swept = sine * mp.hyp2f1(mp.mpf(1) / 2, (1 - n) / 2, mp.mpf(3) / 2, sine * sine)  # F
        bent = plain.g_at_1 * (swept - theta * cosine**n)
        short = sine * sine / (1 + cosine)  # 1 - cos(theta)
        pulled, wanted = self.beta * (theta * sine - short), mp.pi * self.range / 2
        c = min((wanted / bent) ** (1 / n), wanted / pulled)  # with one of the terms alone; their sum grows with c
        step = mp.mpf(1)
        while abs(step) > _CLOSE:
            first, second = bent * c**n, pulled * c
            step = mp.log((first + second) / wanted) * (first + second) / (n * first + second)
            c *= mp.exp(-step)
        a, m, first, second = c * cosine, c * sine, bent * c**n, pulled * c
        growth = n * plain.g(c) / c * swept - self.beta * short
        pull = self.beta * c * theta**2
        push = n / (n + 1) * a * plain.g(a)
        force = 2 * plain.effective_modulus * push - 2 * self.strength * (a * m + c * c * theta)
        stiffness = 2 * plain.effective_modulus * (a - pull / growth) if growth else mp.inf
        fall = theta * sine * (n * plain.g(a) * spread + self.beta * a) * cosine / (n * first + second)
        return State(spread, a, c, plain.g(a) - self.beta * m, force, stiffness, growth, a * growth - pull, fall)

    def lifted(self, c: Real) -> State:
        """The equilibrium with a = 0 and cohesive radius ``c``, which does not touch."""
        plain, half = self.plain, mp.pi / 2
        f = plain.g(c) / plain.kappa
        growth = half * plain.n * f / c - self.beta
        pull = self.beta * c * half**2
        indentation = f - 2 * self.beta * c / mp.pi - self.range
        stiffness = -2 * plain.effective_modulus * pull / growth if growth else mp.inf
        return State(
            mp.inf, mp.mpf(0), c, indentation, -mp.pi * self.strength * c * c, stiffness, growth, -pull, mp.inf
        )

    @cached_property
    def curve(self) -> list[State]:
        """Equilibria from the outermost on."""
        further = [
            mp.mpf(10) ** decade for n, *ends in _FURTHER if self.plain.n < n for decade in itertools.chain(*ends)
        ]
        return [self.at(spread) for spread in sorted([*_SPREADS, *further])]

    @cached_property
    def touch(self) -> State:
        """Where contact begins."""
        half, one = mp.pi / 2, mp.mpf(1)
        return self._at(mp.inf, half, mp.mpf(0), one)

    def pull_off(self, control: str) -> State:
        """The lowest foot of a stable branch."""
        return min(self.feet[control], key=lambda state: state.under(control))

    @cached_property
    def feet(self) -> dict[str, list[State]]:
        """Where the branches end on the way back, under each control, the outermost first."""
        return {control: [*self._folds(control), *self._lifted_feet(control)] for control in ("indentation", "force")}

    def _folds(self, control: str) -> list[State]:
        found = []
        for outer, inner in itertools.pairwise(self.curve):
            if outer.grows(control) > 0 >= inner.grows(control):
                found.append(self.at(_crossing(lambda x: self.at(x).grows(control), outer.spread, inner.spread)))
        return found

    def _lifted_feet(self, control: str) -> list[State]:
        """Those without touch: never under dead load."""
        n, nothing = self.plain.n, mp.mpf(10) ** -400
        if control == "force":
            return []
        feet = []
        if n != 1:  # D = 0
            fold = (2 * self.beta * self.plain.kappa / (mp.pi * n * self.plain.g_at_1)) ** (1 / (n - 1))
            if n > 1 and fold < self.touch.cohesive_radius:
                feet.append(self.lifted(fold))
        if n < 1 or (n == 1 and self.touch.growth > 0):
            feet.append(self.lifted(self.touch.cohesive_radius * nothing))
        return feet

    def compression(self, control: str, state: State) -> Real:
        """The part of the control without the cohesive stress: g(a), or 2 E* [a g(a) - G(a)]."""
        plain, a = self.plain, state.contact_radius
        return (
            plain.g(a)
            if control == "indentation"
            else 2 * plain.effective_modulus * plain.n / (plain.n + 1) * a * plain.g(a)
        )

    def answer(self, control: str, value: Real) -> State:
        """The state of a slow retraction: on the outermost branch that reaches down to ``value``."""
        feet = self.feet[control]
        foot = next((foot for foot in feet if foot.under(control) <= value), None)
        if foot is None:
            raise ArithmeticError(f"{control} = {mp.nstr(value, 17)} lies below every fold")
        if foot.contact_radius > 0 or value >= self.touch.under(control):
            most = foot.spread if foot.contact_radius > 0 else mp.inf
            return self._root(lambda state: state.under(control) - value, most, lambda s: self._slope(s, control))
        ends = foot.cohesive_radius, self.touch.cohesive_radius
        return self.lifted(_crossing(lambda c: self.lifted(c).indentation - value, *ends))

    def at_radius(self, a: Real) -> State:
        """The equilibrium with contact radius a > 0."""
        return self._root(lambda state: mp.log(state.contact_radius / a), mp.inf, self._growth)

    def _growth(self, state: State) -> Real:
        """d(ln a)/d(ln m/a): a = c/sqrt(1 + (m/a)^2)."""
        square = state.spread**2
        return -state.fall - square / (1 + square)

    def _slope(self, state: State, control: str) -> Real:
        """Of the control over ln m/a."""
        growth, a = self._growth(state), state.contact_radius
        slope = self.plain.n * self.plain.g(a) * growth - self.beta * a * state.spread * (growth + 1)
        return slope * (state.stiffness if control == "force" else 1)

    def _root(self, excess: Callable[[State], Real], most: Real, slope: Callable[[State], Real]) -> State:
        """Where ``excess``, which falls with m/a up to ``most``, is 0: Newton's method in its logarithm, and halves."""
        within = [state for state in self.curve if state.spread < most]
        low = max((state.spread for state in within if excess(state) > 0), default=within[0].spread)
        high = min((state.spread for state in within if excess(state) <= 0), default=min(most, self.curve[-1].spread))
        while excess(self.at(low)) <= 0:
            low, high = low / 1000, low
        spread = low
        for _ in range(_PATIENCE):
            state = self.at(spread)
            value = excess(state)
            low, high = (spread, high) if value > 0 else (low, spread)
            step = value / slope(state)
            if abs(step) < _CLOSE:
                return self.at(spread * mp.exp(-step))
            better = spread * mp.exp(-step) if abs(step) < _LEAP else mp.inf
            spread = better if low < better < high else mp.sqrt(low * high)
        raise ArithmeticError("no root")


def _crossing(function: Callable[[Real], Real], low: Real, high: Real) -> Real:
    """Where ``function`` of a positive number changes its sign: secants over its logarithm (the Illinois method)."""
    low, high = mp.log(low), mp.log(high)
    at_low, at_high = function(mp.exp(low)), function(mp.exp(high))
    for _ in range(_PATIENCE):
        middle = high - at_high * (high - low) / (at_high - at_low)
        value = function(mp.exp(middle))
        if value == 0 or min(abs(high - low), abs(middle - high)) < _CLOSE:
            return mp.exp(middle)
        if (value > 0) == (at_high > 0):
            at_low /= 2
        else:
            low, at_low = high, at_high
        high, at_high = middle, value
    raise ArithmeticError("no crossing")
