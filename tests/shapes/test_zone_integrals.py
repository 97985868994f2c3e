"""The closed forms of the integrals over a cohesive zone, against quadrature with 40 digits and against the profile."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from oracles.multiprecision import Number, mp

from roughmdr.shapes import SHAPES, zone_integrals
from roughmdr.shapes.kappa import kappa
from roughmdr.shapes.power_profiles import profile_of

Exact = Callable[[Number, Number], tuple[Number, Number]]


def q_of(x: Number) -> Number:
    return mp.sqrt((x - 1) * (x + 1)) if x > 1 else mp.mpf(0)


PROFILES: dict[str, Exact] = {
    "cone": lambda x, n: (mp.pi / 2 * x, mp.pi / 2 * x),
    "power_law": lambda x, n: (kappa_of(n) * x**n, n * kappa_of(n) * x**n),
    "sphere": lambda x, n: (x * mp.atanh(x), x * mp.atanh(x) + x * x / (1 - x * x)),
    "truncated_cone": lambda x, n: (x * mp.atan(q_of(x)), x * mp.atan(q_of(x)) + (x / q_of(x) if x > 1 else 0)),
    "truncated_paraboloid": lambda x, n: (x * q_of(x), x * (1 + 2 * q_of(x) ** 2) / q_of(x) if x > 1 else 0),
    "rounded_punch": lambda x, n: (x * (q_of(x) - mp.atan(q_of(x))), x * (2 * q_of(x) - mp.atan(q_of(x)))),
    "rounded_cone": lambda x, n: (
        x * x - x * q_of(x) + x * mp.atan(q_of(x)),
        2 * x * x - 2 * x * q_of(x) + x * mp.atan(q_of(x)),
    ),
    "capped_paraboloid": lambda x, k: (
        k * x * x + (1 - k) * x * q_of(x),
        2 * k * x * x + ((1 - k) * x * (1 + 2 * q_of(x) ** 2) / q_of(x) if x > 1 else 0),
    ),
}
"""g and x g' in units of width and rise, from the exponent or the flatness."""
BROKEN = {"truncated_cone", "truncated_paraboloid", "rounded_punch", "rounded_cone", "capped_paraboloid"}


def kappa_of(n: Number) -> Number:
    return mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2)


def by_quadrature(name: str, a: float, m: float, number: float) -> tuple[Number, Number, Number]:
    """I, K, and g(a) theta."""
    low, n = mp.mpf(a), mp.mpf(number)
    c = mp.sqrt(low * low + mp.mpf(m) ** 2)
    total = [mp.mpf(0), mp.mpf(0)]
    parts = [(low, min(c, mp.mpf(1)), mp.mpf(0)), (max(low, mp.mpf(1)), c, mp.mpf(1))]
    for begin, end, base in parts if name in BROKEN else [(low, c, mp.mpf(0))]:
        if not begin < end:
            continue
        reach = mp.sqrt(c * c - base * base)
        wide, narrow = (mp.acos(mp.sqrt(abs(x * x - base * base)) / reach) for x in (begin, end))
        cuts = [mp.mpf(10) ** -k for k in range(int(mp.log10(reach + 1)) + 2, -1, -1)]  # a pole lies next to pi/2
        places = [narrow, *sorted(x for x in (mp.pi / 2 - cut for cut in cuts) if narrow < x < wide), wide]
        for i in (0, 1):

            def at(psi: Number, i: int = i, reach: Number = reach, base: Number = base) -> Number:
                x = mp.sqrt(base * base + (reach * mp.cos(psi)) ** 2)
                return PROFILES[name](x, n)[i] * reach * mp.cos(psi) / x

            total[i] += mp.quad(at, places)
    return total[0], total[1], PROFILES[name](low, n)[0] * mp.acos(low / c)


def t_of(name: str, a: float, number: float) -> float:
    profile = profile_of(SHAPES[name])
    flat = profile.flat and a <= 1.0
    return 0.0 if flat else float(profile.t_of_radius(a, 1.0, (number, 0.0)))


@pytest.mark.few(1)
@pytest.mark.parametrize("name", PROFILES)
def test_they_are_the_integrals(name: str) -> None:
    rng = np.random.default_rng(sorted(PROFILES).index(name))
    for _ in range(12):
        number = float(10.0 ** rng.uniform(-0.28, 1.3)) if name == "power_law" else float(10.0 ** rng.uniform(-3, 0))
        if name == "sphere":
            a = float(rng.uniform(0.01, 0.99))
            m = math.sqrt((1 - a) * (1 + a)) * float(10.0 ** rng.uniform(-3, -0.01))
        else:
            a = float(10.0 ** rng.uniform(-2, 2))
            m = a * float(10.0 ** rng.uniform(-3, 3))
        with mp.workdps(40):
            whole, slope, flat = by_quadrature(name, a, m, number)
            i, k = profile_of(SHAPES[name]).zone_integrals(
                t_of(name, a, number), a, m, math.atan2(m, a), (number, kappa(number))
            )
            square = m * m - (1.0 - a) * (1.0 + a)
            digits = 1.0 if name not in BROKEN or a > 1.0 or square <= 0.0 else max(1.0, m * m / square)
            assert abs(i - whole) <= 1e-14 * digits * max(abs(whole - flat), flat), (number, a, m)
            assert abs(k - slope) <= 1e-14 * digits * abs(slope), (number, a, m)


@pytest.mark.parametrize("name", PROFILES)
@settings(deadline=None)
@given(log_c=st.floats(-3.0, 3.0), number=st.floats(0.55, 1.0))
def test_from_the_axis_on_they_are_the_profile(name: str, log_c: float, number: float) -> None:
    """f(c) = 2/pi ∫_0^c g/sqrt(c^2 - x^2) dx (H 12)."""
    c = 10.0**log_c if name != "sphere" else 0.999 / (1.0 + 10.0**log_c)
    profile = profile_of(SHAPES[name])
    i, _ = profile.zone_integrals(0.0, 0.0, c, 0.5 * math.pi, (number, kappa(number)))
    f, _ = profile.f_and_slope(c, (number, kappa(number)))
    assume(not 0.99 < c < 1.01)  # where c^2 - 1, a difference here, has few digits
    assert 2.0 / math.pi * i == pytest.approx(f, rel=1e-11, abs=0.0)


def test_a_steep_power_law_takes_the_continued_fraction_to_its_end() -> None:
    """With n = 400 the integral to pi/2 is pi/(2 kappa) to all digits, over nearly all of the zone."""
    n = 400.0
    i, k = zone_integrals.power_law(0.3, 0.3, 0.9, math.atan2(0.9, 0.3), (n, kappa(n)))
    c = math.hypot(0.3, 0.9)
    assert i == pytest.approx(0.5 * math.pi * c**n, rel=1e-12)
    assert k == n * i
