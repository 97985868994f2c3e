"""One power-law asperity with adhesion of finite range (Dugdale), in closed form with 60 digits.

With x = c cos(phi), a = c cos(theta), m = c sin(theta), F = ∫_0^theta cos(phi)^n dphi and beta = 2 sigma0/E*, the gap
at c is the range of the adhesion where

    g(1) c^n (F - theta cos(theta)^n) + beta c (theta sin(theta) - 1 + cos(theta)) = pi w/(2 sigma0),

with one root c for each theta. In the terms of ``dugdale.py`` J = n g(1) c^(n-1) F. Beyond theta = pi/2 contact is
lost, a = 0, and c alone determines the state.
"""

import itertools
from collections.abc import Callable, Iterator
from functools import cached_property

from oracles.dugdale import Dugdale, Integrals, State
from oracles.jkr import JkrPowerLaw, PowerShape
from oracles.multiprecision import Number, mp, root

_DECADES = (-9, -7, *(i / 2 for i in range(-10, 9)), 6, 8, 10, 12)
"""log10(m/a), from contacts as in JKR to those that hardly touch."""
_FURTHER = (0.7, (-50, -40, -30, -24, -18, -13), (20, 40)), (0.53, (-200, -160, -120, -90, -70), ())
"""Exponents below which the curve needs further decades, before and after those."""
_RTOL = mp.mpf(10) ** -45


class DugdalePowerLaw(Dugdale):
    """f = c r^n pressed into a half-space; ``strength`` is sigma0 [Pa]."""

    def __init__(self, shape: PowerShape, effective_modulus: float, work: float, strength: float) -> None:
        self.jkr = JkrPowerLaw(shape, effective_modulus, work)
        super().__init__(self.jkr.effective_modulus, self.jkr.work, mp.mpf(strength), mp.pi)

    def at(self, ratio: Number) -> State:
        """Return the equilibrium with m/a = ``ratio`` > 0."""
        with mp.workdps(mp.dps + 2 * max(0, -int(mp.log10(ratio)))):  # digits that F - theta cos(theta)^n loses
            cosine = 1 / mp.sqrt(1 + ratio * ratio)
            return self._at(mp.atan(ratio), cosine, ratio * cosine)

    def _at(self, theta: Number, cosine: Number, sine: Number) -> State:
        g, n = self.jkr.g, self.jkr.n
        F = sine * mp.hyp2f1(mp.mpf(1) / 2, (1 - n) / 2, mp.mpf(3) / 2, sine * sine)
        elastic = self.jkr.g_at_1 * (F - theta * cosine**n)
        cohesive = self.beta * (theta * sine - sine * sine / (1 + cosine))
        gap = mp.pi * self.range / 2
        c = min((gap / elastic) ** (1 / n), gap / cohesive)  # with one of the terms alone; their sum grows with c
        step = mp.mpf(1)
        while abs(step) > _RTOL:
            first, second = elastic * c**n, cohesive * c
            step = mp.log((first + second) / gap) * (first + second) / (n * first + second)
            c *= mp.exp(-step)
        a = c * cosine
        found = Integrals(g(a), self.jkr.reduced_load(a), elastic * c**n, n * g(c) / c * F)
        return self.touching(a, c, c * sine, theta, found)

    def lifted(self, c: Number) -> State:
        """Return the equilibrium with a = 0 and cohesive radius ``c``, which does not touch."""
        f = self.jkr.g(c) / self.jkr.kappa
        return self.not_touching(c, f, self.jkr.n * f / c)

    @cached_property
    def curve(self) -> list[tuple[Number, State]]:
        """Ratios m/a and equilibria, from the outermost on."""
        further = [decade for n, *ends in _FURTHER if self.jkr.n < n for decade in itertools.chain(*ends)]
        ratios = [mp.mpf(10) ** decade for decade in sorted([*_DECADES, *further])]
        return [(ratio, self.at(ratio)) for ratio in ratios]

    @cached_property
    def touch(self) -> State:
        """The state where contact begins."""
        return self._at(mp.pi / 2, mp.mpf(0), mp.mpf(1))

    @cached_property
    def folds(self) -> dict[str, list[tuple[Number, State]]]:
        """The ends of the branches on retraction under each control, with their m/a, the outermost first."""
        found = {control: list(self._folds(control)) for control in ("indentation", "force")}
        found["indentation"] += [(mp.inf, self.lifted(c)) for c in self._lifted_folds()]  # none under dead load
        return found

    def _folds(self, control: str) -> Iterator[tuple[Number, State]]:
        for (outer, state), (inner, state_within) in itertools.pairwise(self.curve):
            if state.grows(control) > 0 >= state_within.grows(control):
                ratio = _crossing(lambda ratio: self.at(ratio).grows(control), outer, inner)
                yield ratio, self.at(ratio)

    def _lifted_folds(self) -> list[Number]:
        """Return the cohesive radii of the folds without touch."""
        n, touch = self.jkr.n, self.touch
        if n < 1 or (n == 1 and touch.growth > 0):
            return [touch.c * mp.mpf(10) ** -400]
        if n == 1:
            return []
        c = (2 * self.beta * self.jkr.kappa / (mp.pi * n * self.jkr.g_at_1)) ** (1 / (n - 1))  # where D = 0
        return [c] if c < touch.c else []

    def pull_off(self, control: str) -> State:
        """Return the lowest fold."""
        return min((state for _, state in self.folds[control]), key=lambda state: state.under(control))

    def fold_below(self, control: str, value: Number) -> tuple[Number, State] | None:
        """Return the end of the outermost branch that extends down to ``value``, with its m/a, or None."""
        return next((fold for fold in self.folds[control] if fold[1].under(control) <= value), None)

    def retracted(self, control: str, value: Number) -> State:
        """Return the state of a slow retraction to ``value``."""
        fold = self.fold_below(control, value)
        if fold is None:
            raise ArithmeticError(f"{control} = {mp.nstr(value, 17)} lies below every fold")
        ratio, state = fold
        if ratio == mp.inf and value < self.touch.under(control):
            return self.lifted(_crossing(lambda c: self.lifted(c).delta - value, state.c, self.touch.c))
        return self._root(lambda state: state.under(control) - value, ratio)

    def at_radius(self, a: Number) -> State:
        """Return the equilibrium with contact radius a > 0."""
        return self._root(lambda state: mp.log(state.a / a), mp.inf)

    def _root(self, excess: Callable[[State], Number], end: Number) -> State:
        """Return where ``excess``, which falls with m/a as far as ``end``, is 0."""
        values = [(ratio, excess(state)) for ratio, state in self.curve if ratio < end]
        low = max((ratio for ratio, value in values if value > 0), default=values[0][0])
        high = min((ratio for ratio, value in values if value <= 0), default=min(end, self.curve[-1][0]))
        while excess(self.at(low)) <= 0:
            low, high = low / 1000, low
        return self.at(_crossing(lambda ratio: excess(self.at(ratio)), low, high))


def _crossing(function: Callable[[Number], Number], low: Number, high: Number) -> Number:
    """Return where ``function`` of a positive number changes its sign, searched in the logarithm."""
    unit = min(abs(function(low)), abs(function(high))) or 1
    return mp.exp(root(lambda y: function(mp.exp(y)) / unit, mp.log(low), mp.log(high)))
