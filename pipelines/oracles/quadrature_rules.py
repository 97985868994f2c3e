"""Quadrature rules with any number of digits."""

import math
from functools import cache

import numpy as np

from oracles.multiprecision import Number, mp


@cache
def gauss(digits: int) -> list[tuple[Number, Number]]:
    """Return Gauss-Legendre nodes and weights on (0, 1), enough for trigonometric polynomials to ``digits``."""
    n = 8 + 32 * digits // 100
    rule = []
    with mp.workdps(digits + 10):
        for guess in np.polynomial.legendre.leggauss(n)[0]:
            x = mp.mpf(float(guess))
            for _ in range(2 + math.ceil(math.log2(digits / 14.0))):  # Newton's method doubles the digits
                before, value = mp.mpf(1), x
                for k in range(2, n + 1):
                    before, value = value, ((2 * k - 1) * x * value - (k - 1) * before) / k
                slope = n * (x * value - before) / (x * x - 1)
                x -= value / slope
            rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return rule


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


@cache
def whole_moments(power: float, digits: int) -> tuple[Number, Number]:
    """Return ∫ cos(psi)^power and ∫ cos(psi)^power sin(psi)^2 over 0 < psi < pi/2, for power > -1/2."""
    exponent = 8  # sin(phi)^power with phi ~ v^8 is smooth enough at 0 for the rule to see all of it
    plain, squared = mp.mpf(0), mp.mpf(0)
    with mp.workdps(digits + 20):
        for v, weight in tanh_sinh(digits + 20, 256):
            phi = mp.pi / 2 * v**exponent
            density = weight * mp.pi / 2 * exponent * v ** (exponent - 1) * mp.sin(phi) ** mp.mpf(power)
            plain += density
            squared += density * mp.cos(phi) ** 2
    return plain, squared
