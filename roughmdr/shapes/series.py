"""The power series f = sum of c r^n, c > 0."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.array_shapes import SharedProfile
from roughmdr.shapes.base import check_one, check_positive, check_radii
from roughmdr.shapes.profile import Params, Profile

_MAX_LOG = 690.0  # e^690 = 1e299: a little inside the range of a float
_MAX_EXPONENT = 1000.0  # a steeper term is a float for radii within a factor of two only


def _sums(t: float, first: int, params: Params) -> tuple[float, float]:
    """Return the sums of c t^n and of n c t^n, with the coefficients c at ``first`` and at every third place on."""
    value, slope = 0.0, 0.0
    for i in range(int(params[0])):
        n, term = params[1 + 3 * i], params[first + 3 * i] * t ** params[1 + 3 * i]
        value += term
        slope += n * term
    return value, slope


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    """g = sum of kappa(n) c a^n (H 26); params are the number of terms, and for each n, kappa(n) c and c."""
    g, slope = _sums(t, 2, params)
    return t, 1.0, g, slope / t


def _reduced_load(t: float, params: Params) -> float:
    total = 0.0
    for i in range(int(params[0])):
        n = params[1 + 3 * i]
        total += n / (n + 1.0) * params[2 + 3 * i] * t**n
    return total * t


def _elastic_integral(t: float, params: Params) -> float:
    total = 0.0
    for i in range(int(params[0])):
        for j in range(int(params[0])):
            n, m = params[1 + 3 * i], params[1 + 3 * j]
            total += n * m / (m + 1.0) / (n + m + 1.0) * (params[2 + 3 * i] * t**n) * (params[2 + 3 * j] * t**m)
    return 2.0 * total * t


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    f, slope = _sums(r, 3, params)
    return f, slope / r if r > 0.0 else (math.inf if params[1] < 1.0 else (params[3] if params[1] == 1.0 else 0.0))


def _roundings(params: Params) -> float:
    """Add the roundings of each sum, and of t in the steepest power, to those of any profile."""
    return 14.0 + params[0] + params[3 * int(params[0]) - 2]


def _kink(low: float, high: float, params: Params) -> bool:
    """Return whether the steepest term grows so much that a few nodes do not integrate it to rounding."""
    return params[3 * int(params[0]) - 2] * (high - low) > 0.5 * low


def _check_distinct(exponents: list[float]) -> None:
    for exponent in exponents:
        if exponents.count(exponent) > 1:
            raise ShapeError(f"power_series: terms holds the exponent {exponent:g} twice; add them up")


@dataclass(frozen=True, eq=False)
class PowerSeries(SharedProfile):
    """f = sum of c r^n over ``terms`` {n: c}, with n [1] and c [m^(1-n)], plain numbers for r and f in metres.

    ShapeError unless there is a term and all n and c are finite and > 0.
    """

    terms: Mapping[float, float]

    name = "power_series"
    units: ClassVar[dict[str, str]] = {"exponent": "1", "terms": "1"}
    parameter_sets = (("terms",),)
    dimension = "term"
    profile = Profile(
        _mdr_profile, _reduced_load, _f_and_slope, kink=_kink, elastic_integral=_elastic_integral, roundings=_roundings
    )

    def __post_init__(self) -> None:
        if not isinstance(self.terms, Mapping) or not self.terms:
            message = f"terms is {self.terms!r}; it must hold exponents and coefficients, {{n: c}}"
            raise ShapeError(f"power_series: {message}")
        for exponent, coefficient in self.terms.items():
            if not isinstance(exponent, str):  # keys of a scene are texts
                check_one("power_series", "an exponent of terms", exponent)
            check_one("power_series", f"the coefficient of r^{exponent}", coefficient)
            check_positive("power_series", "an exponent of terms", exponent)
            if float(exponent) > _MAX_EXPONENT:
                message = f"an exponent of terms is {exponent}; it must be at most {_MAX_EXPONENT:g}"
                raise ShapeError(f"power_series: {message}")
            check_positive("power_series", f"the coefficient of r^{exponent}", coefficient)
        _check_distinct([float(exponent) for exponent in self.terms])
        terms = {float(n): float(c) for n, c in sorted(self.terms.items(), key=lambda term: float(term[0]))}
        object.__setattr__(self, "terms", terms)

    @classmethod
    def example(cls) -> dict[str, Any]:
        return {"terms": {"2": 1.0}}

    @property
    def columns(self) -> dict[str, Floats]:
        return {"exponent": np.array(list(self.terms)), "terms": np.array(list(self.terms.values()))}

    @classmethod
    def from_columns(cls, columns: dict[str, Floats]) -> Self:
        exponents = columns["exponent"].tolist()
        _check_distinct(exponents)
        return cls(dict(zip(exponents, columns["terms"].tolist(), strict=True)))

    # In the power of a steep term r/width has too few digits for f'.
    def f(self, r: ArrayLike) -> Floats:
        r = check_radii("r", r)
        return np.asarray(sum((c * r**n for n, c in self.terms.items()), np.zeros_like(r)))

    def df(self, r: ArrayLike) -> Floats:
        r = check_radii("r", r)
        with np.errstate(all="ignore"):  # below n = 1 the tip is infinitely steep
            return np.asarray(sum((n * c * r ** (n - 1.0) for n, c in self.terms.items()), np.zeros_like(r)))

    def nondimensional(self) -> tuple[float, float, Any]:
        """Return the width where the first and the last term are equal, the first term there, and the params."""
        from roughmdr.numerics import double_double as extended  # these alone need the compiler
        from roughmdr.shapes.kappa import precise_kappa

        (n, c), (n_last, c_last) = next(iter(self.terms.items())), list(self.terms.items())[-1]
        log_width = (math.log(c) - math.log(c_last)) / (n_last - n) if n_last > n else 0.0
        width = math.exp(min(max(log_width, -25.0), 5.0))  # lengths from 1e-11 to 100 m
        log_of_width = extended.log((width, 0.0))
        # A logarithm of hundreds has no more than 13 digits as one float.
        logs = [
            extended.add(extended.log((factor, 0.0)), extended.multiply((exponent, 0.0), log_of_width))
            for exponent, factor in self.terms.items()
        ]
        ratios = [extended.add(log, (-logs[0][0], -logs[0][1])) for log in logs]
        if max(abs(log[0]) for log in (*logs, *ratios)) > _MAX_LOG:
            raise OutOfRange(f"power_series: terms {dict(self.terms)} lie too far apart for floats")
        parts = [float(len(self.terms))]
        for exponent, log in zip(self.terms, ratios, strict=True):
            factor = extended.exp(log)
            parts += [exponent, extended.multiply(precise_kappa(exponent), factor)[0], factor[0]]
        return width, extended.exp(logs[0])[0], np.array(parts)

    def precisely(self, t: float) -> tuple[Any, Any, Any]:
        from mpmath import mp

        with mp.workdps(40):
            a = mp.mpf(self.nondimensional()[0]) * mp.mpf(t)
            g = load = mp.mpf(0)
            for exponent, coefficient in self.terms.items():
                n = mp.mpf(exponent)
                kappa = mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2)
                term = kappa * mp.mpf(coefficient) * a**n
                g, load = g + term, load + n / (n + 1) * term * a
            return a, g, load

    @classmethod
    def least_exponent(cls, params: Floats) -> float:
        return float(params[0, 1])
