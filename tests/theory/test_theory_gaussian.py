"""The laws over all summits of a Gaussian surface: against mpmath, against drawn summits, and in their limits."""

import math
from functools import cache

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.special import erfcx

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.quadrature import panel_rule
from roughmdr.theory.bush import ellipses

LAWS = {"elliptic": rm.theory.bush_gibson_thomas, "circular": rm.theory.greenwood_elliptic}
SURFACE = {"effective_modulus": 2e9, "m0": 1e-14, "m2": 1e-3, "m4": 2.5e8}
"""alpha is 2.5."""
ALPHA = 2.5


def ellipse_by_johnson(ratio: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """k2/k1 and the factors of force and area, all from E* = p0 = a = 1 in Hertz's theory of K. L. Johnson (1985)."""
    e2 = 1 - ratio**2
    K, E = mp.ellipk(e2), mp.ellipe(e2)
    A, B = ratio / e2 * (K - E), ratio / e2 * (E / ratio**2 - K)
    delta, force, area, curvature = ratio * K, 2 * mp.pi * ratio / 3, mp.pi * ratio, 2 * mp.sqrt(A * B)
    return A / B, force / (4 * delta**1.5 / (3 * mp.sqrt(curvature))), area / (mp.pi * delta / curvature)


@pytest.mark.parametrize("ratio", [1e-6, 0.02, 0.5, 0.9999])
def test_the_ellipses_are_those_of_johnson(ratio: float) -> None:
    with mp.workdps(30):
        quotient, force, area = ellipse_by_johnson(mp.mpf(ratio))
        slope = mp.diff(lambda b: 2 / (1 + ellipse_by_johnson(b)[0]) - 1, mp.mpf(ratio))
        (spread,), (spread_slope,), (of_force,), (of_area,) = ellipses(np.array([ratio]))
        assert spread == pytest.approx(float((1 - quotient) / (1 + quotient)), abs=1e-15)
        assert spread_slope == pytest.approx(float(slope), abs=1e-11)
        assert of_force == pytest.approx(float(force), rel=1e-13)
        assert of_area == pytest.approx(float(area), rel=1e-13)


@cache
def spreads() -> tuple[Floats, ...]:
    """Nodes of tanh and sinh over the spread r of curvatures: r, 1 - r^2, weight, and the factors of the contact."""
    rows = []
    with mp.workdps(50):
        for t in np.arange(-2.5, 3.41, 0.05):
            left = 1 / (1 + mp.exp(mp.pi * mp.sinh(t)))
            r = 1 - left
            weight = mp.pi * mp.cosh(t) * left * r / 20
            aim = mp.log(left / (1 + r))
            axes = mp.findroot(
                lambda s, aim=aim: mp.log(ellipse_by_johnson(mp.exp(s))[0]) - aim, (aim, aim / 2), "ridder"
            )
            _, force, area = ellipse_by_johnson(mp.exp(axes))
            rows.append([float(x) for x in (r, left * (1 + r), weight, force, area)])
    return tuple(np.array(rows).T)


def by_mpmath(contacts: str, variable: str, h: float, alpha: float) -> float:
    """The law over S and r, the heights given S by parabolic cylinder functions; h in sqrt(m0), no scales."""
    n, p = {"pressure": (1.5, 0.5), "contact_fraction": (1.0, 1.0), "contact_density": (0.0, 0.0)}[variable]
    rho = math.sqrt(1.5 / alpha)
    c = math.sqrt(1.0 - rho * rho)
    r, rest, weight, force, area = spreads()
    factor = {"pressure": force, "contact_fraction": area, "contact_density": np.ones_like(r)}[variable]
    factor = factor if contacts == "elliptic" else np.ones_like(r)
    total = 0.0
    for y, share in zip(
        *(part.ravel() for part in panel_rule(np.linspace(0.0, 3.5 + 0.1 * max(h, 0.0), 12))), strict=True
    ):
        S = y * y
        u = mp.mpf(h - rho * S) / c
        heights = c**n * mp.gamma(n + 1) / mp.sqrt(2 * mp.pi) * mp.exp(-u * u / 4) * mp.pcfd(-n - 1, u)
        density = math.sqrt(6.0 / math.pi) * S**2 * rest * np.exp(-((r * S) ** 2) - 0.5 * S * S) * 2.0 * r * S**2
        total += 2.0 * y * share * float(heights) * float(np.sum(weight * density * (S * np.sqrt(rest)) ** -p * factor))
    return total


def scaled(contacts: str, variable: str, h: float, alpha: float) -> float:
    """The law at m0 = m2 = 1, less the scales."""
    value = LAWS[contacts](separation=h, effective_modulus=1.0, m0=1.0, m2=1.0, m4=alpha, variable=variable)
    curvature = math.sqrt(2.0 * alpha / 3.0)
    unit = {"pressure": 4.0 / (3.0 * math.sqrt(curvature)), "contact_fraction": math.pi / curvature}.get(variable, 1.0)
    return float(value) / (unit * alpha / (6.0 * math.pi * math.sqrt(3.0)))


@pytest.mark.few(1)
@pytest.mark.parametrize("variable", ["pressure", "contact_fraction", "contact_density"])
@pytest.mark.parametrize(("h", "alpha"), [(-2.0, 1.8), (3.0, 2.5), (6.0, 1.8), (6.0, 40.0), (20.0, 2.5)])
def test_the_laws_against_mpmath(variable: str, h: float, alpha: float) -> None:
    for contacts in LAWS:
        assert scaled(contacts, variable, h, alpha) == pytest.approx(by_mpmath(contacts, variable, h, alpha), rel=1e-12)


def test_greenwood_by_the_closed_joint_law_of_height_and_curvature() -> None:
    """J. A. Greenwood's way: v = S^2 - q; S from sqrt(v) on, at a given height, is a Gaussian integral, so erfc."""
    h, rho2 = 1.5, 1.5 / ALPHA
    c2 = 1.0 - rho2
    y, over_y = (part.ravel() for part in panel_rule(np.linspace(0.0, 3.0, 10)))
    t, over_t = (part.ravel()[:, None] for part in panel_rule(np.linspace(0.0, 3.0, 7)))
    z, s = h + t * t, y * y
    # exp(v - 3/2 S^2) times the normal density of z given S, as one Gaussian of S.
    precision = 3.0 + rho2 / c2
    mean = math.sqrt(rho2) * z / c2 / precision
    beyond = (s - mean) * math.sqrt(precision / 2.0)
    exponent = s * s + precision * mean**2 / 2.0 - z * z / (2.0 * c2) - beyond**2
    joint = erfcx(beyond) * np.exp(exponent) / (2.0 * math.sqrt(c2 * precision))
    exact = math.sqrt(6.0 / math.pi) * np.sum(over_t * 2.0 * t**4 * joint * 4.0 * y**6 * over_y)
    assert scaled("circular", "pressure", h, ALPHA) == pytest.approx(float(exact), rel=1e-12)


@pytest.mark.large
@pytest.mark.parametrize("alpha", [1.55, 4.0])
def test_drawn_summits_carry_what_the_laws_say(alpha: float) -> None:
    """The height and second derivatives of a Gaussian surface where its slope is 0, weighted as their density is."""
    random = np.random.Generator(np.random.Philox(5))
    bend, twist, shear, rest = random.standard_normal((4, 2_000_000))
    mean, half = bend * math.sqrt(2.0 * alpha / 3.0), np.hypot(twist, shear) * math.sqrt(alpha / 3.0)
    height = math.sqrt(1.5 / alpha) * bend + math.sqrt(1.0 - 1.5 / alpha) * rest
    weight = np.where(mean > half, mean**2 - half**2, 0.0) / (2.0 * math.pi)
    curvature = np.sqrt(np.where(mean > half, mean**2 - half**2, 1.0))
    for h in (-1.0, 1.0):
        depth = np.maximum(height - h, 0.0)
        drawn = weight * np.array(
            [4.0 / 3.0 * depth**1.5 / np.sqrt(curvature), np.pi * depth / curvature, depth > 0.0], dtype=float
        )
        for variable, values in zip(("pressure", "contact_fraction", "contact_density"), drawn, strict=True):
            law = LAWS["circular"](separation=h, effective_modulus=1.0, m0=1.0, m2=1.0, m4=alpha, variable=variable)
            assert abs(values.mean() - float(law)) < 3.0 * values.std() / math.sqrt(values.size)


@pytest.mark.parametrize("alpha", [1.5 * (1.0 + 1e-9), 1.51, 3.0, 1e5])
def test_the_moments_of_the_heights_of_summits(alpha: float) -> None:
    """Nayak's: as integrals over the number of summits above a height."""
    h, share = (part.ravel() for part in panel_rule(np.linspace(-9.0, 12.0, 43)))
    above = rm.theory.bush_gibson_thomas(
        separation=h, effective_modulus=1.0, m0=1.0, m2=1.0, m4=alpha, variable="contact_density"
    ) / (alpha / (6.0 * math.pi * math.sqrt(3.0)))
    mean = float(above @ share) - 9.0
    square = float(2.0 * (above * (h + 9.0)) @ share) - 18.0 * mean - 81.0
    assert mean == pytest.approx(4.0 / math.sqrt(math.pi * alpha), rel=1e-9)
    assert square - mean**2 == pytest.approx(1.0 - 0.8968057562 / alpha, rel=1e-9)


@pytest.mark.parametrize("alpha", [1.6, 2.5])
def test_far_away_the_area_grows_with_the_pressure(alpha: float) -> None:
    """The area approaches the asymptote as 1/h^2."""
    surface = {"separation": np.array([8.0, 16.0, 32.0]), "effective_modulus": 3.0, "m0": 1.0, "m2": 1.0, "m4": alpha}
    pressure = rm.theory.bush_gibson_thomas(**surface)
    area = rm.theory.bush_gibson_thomas(variable="contact_fraction", **surface)
    short = 1.0 - area / rm.theory.bush_gibson_thomas_asymptote(
        pressure=pressure, effective_modulus=3.0, rms_slope=math.sqrt(2.0)
    )
    assert 0.0 < short[2] < 1e-3
    assert short[:2] / short[1:] == pytest.approx([4.0, 4.0], abs=0.3)


def test_circles_in_place_of_ellipses_cost_a_few_per_cent() -> None:
    h = np.linspace(0.0, 5e-7, 26)
    for variable in ("pressure", "contact_fraction"):
        ellipses, circles = (law(separation=h, variable=variable, **SURFACE) for law in LAWS.values())
        part = circles / ellipses - 1.0
        assert np.abs(part).max() < 0.06
        assert np.abs(part).min() > 0.003
    number = [law(separation=h, variable="contact_density", **SURFACE) for law in LAWS.values()]
    np.testing.assert_allclose(number[0], number[1], rtol=1e-13)


@pytest.mark.large
@given(h=st.floats(-3.0, 6.0), size=st.floats(1e-9, 1e9), steeper=st.floats(1e-3, 1e3))
@settings(deadline=None, max_examples=15)
def test_the_laws_hold_at_every_size(h: float, size: float, steeper: float) -> None:
    """Heights times size times steeper, widths times size: pressures times steeper."""
    other = {
        "effective_modulus": SURFACE["effective_modulus"],
        "m0": SURFACE["m0"] * (size * steeper) ** 2,
        "m2": SURFACE["m2"] * steeper**2,
        "m4": SURFACE["m4"] * (steeper / size) ** 2,
    }
    for law in LAWS.values():
        here, there = law(separation=h * 1e-7, **SURFACE), law(separation=h * 1e-7 * size * steeper, **other)
        assert float(there) == pytest.approx(steeper * float(here), rel=1e-11)


@pytest.mark.large
@given(h=st.floats(-1e3, 1e3), excess=st.floats(1e-12, 1e12))
@settings(deadline=None, max_examples=30)
def test_numbers_are_finite_and_fall_with_separation(h: float, excess: float) -> None:
    surface = {"effective_modulus": 1.0, "m0": 1.0, "m2": 1.0, "m4": 1.5 + excess}
    for variable in ("pressure", "contact_fraction", "contact_density"):
        near, far = LAWS["elliptic"](separation=[h, h + 0.1], variable=variable, **surface)
        assert np.isfinite(near)
        assert 0.0 <= far <= near * (1.0 + 1e-13)


@pytest.mark.parametrize("law", LAWS.values())
@pytest.mark.parametrize(
    ("name", "value"),
    [("effective_modulus", 0.0), ("m0", -1.0), ("m2", math.nan), ("m4", math.inf), ("separation", "near"), ("m4", 1e8)],
)
def test_wrong_arguments_are_refused(law: object, name: str, value: object) -> None:
    with pytest.raises(rm.OutOfRange, match="alpha" if value == 1e8 else name):
        law(**{"separation": 0.0, **SURFACE, name: value})


def test_shapes_are_kept() -> None:
    law = rm.theory.bush_gibson_thomas
    assert law(separation=0.0, **SURFACE).shape == ()
    assert law(separation=[], **SURFACE).shape == (0,)
    with pytest.raises(rm.RoughmdrError, match="variable"):
        law(separation=0.0, variable="area", **SURFACE)
    with pytest.raises(rm.OutOfRange, match="representable"):
        law(separation=-1e308, **SURFACE)
    assert rm.theory.bush_gibson_thomas_asymptote(pressure=0.0, effective_modulus=1.0, rms_slope=1.0) == 0.0
    with pytest.raises(rm.OutOfRange, match="pressure"):
        rm.theory.bush_gibson_thomas_asymptote(pressure=-1.0, effective_modulus=1.0, rms_slope=1.0)
