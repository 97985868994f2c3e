"""Arithmetic of 60 digits, unless ``mp.workdps`` says otherwise; root finding and quadrature in it."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

import mpmath

mp = mpmath.mp.clone()
mp.dps = 60

Number: TypeAlias = Any  # a number of any precision; mpmath carries no types
_SMALL = mp.mpf(10) ** -52


def root(function: Callable[[Number], Number], low: Number, high: Number) -> Number:
    """Return where ``function`` changes its sign between ``low`` and ``high``, by Chandrupatla's method."""
    narrow = mp.mpf(10) ** (10 - mp.dps)
    one, other = low, high
    f_one, f_other = function(low), function(high)
    if f_one * f_other > 0:
        raise ArithmeticError(f"no root between {mp.nstr(low, 20)} and {mp.nstr(high, 20)}")
    t: Number = mp.mpf(1) / 2
    while True:
        x = one + t * (other - one)
        value = function(x)
        if abs(value) < _SMALL or abs(other - one) < narrow * max(1, abs(x)):
            return x
        if (value > 0) == (f_one > 0):
            third, f_third = one, f_one
        else:
            third, f_third, other, f_other = other, f_other, one, f_one
        one, f_one = x, value
        xi, phi = (one - other) / (third - other), (f_one - f_other) / (f_third - f_other)
        t = mp.mpf(1) / 2
        if phi**2 < xi and (1 - phi) ** 2 < 1 - xi:  # inverse quadratic interpolation is safe
            t = f_one / (f_other - f_one) * f_third / (f_other - f_third)
            t += (third - one) / (other - one) * f_one / (f_third - f_one) * f_other / (f_third - f_other)


def bracket(function: Callable[[Number], Number]) -> tuple[Number, Number]:
    """Return arguments at which a growing ``function`` is negative and positive, near 0 where possible."""
    low, high, step = mp.mpf(0), mp.mpf(0), mp.mpf(2)
    while function(low) > 0:
        high, low, step = low, low - step, step * 2
    while function(high) <= 0:
        low, high, step = high, high + step, step * 2
    return low, high


def radius_between(lo: Number, hi: Number | None, size: Number, y: Number) -> Number:
    """Return a radius above ``lo`` that grows with the number y: without end by ``size`` e^y, or up to ``hi``."""
    return lo + size * mp.exp(y) if hi is None else lo + (hi - lo) / (1 + mp.exp(-y))


def digits(number: Number, count: int) -> str:
    """Return ``number`` written with so many digits."""
    return str(mp.nstr(number, count, min_fixed=-4, max_fixed=10))


@cache
def tanh_sinh(digits: int, steps: int) -> list[tuple[Number, Number]]:
    """Return double-exponential nodes and weights on (0, 1), for integrands that are singular at the ends."""
    rule = []
    with mp.workdps(digits + 10):
        edge = math.asinh((digits + 5) * math.log(10.0) / math.pi)
        for i in range(-math.ceil(edge * steps), math.ceil(edge * steps) + 1):
            t = mp.mpf(i) / steps
            grow = mp.exp(mp.pi * mp.sinh(t))
            rule.append((grow / (1 + grow), mp.pi * mp.cosh(t) * grow / (1 + grow) ** 2 / steps))
    return rule
