"""Adhesion of finite range: its limits JKR and DMT with their rates, its change of stability, and its equations."""

import itertools
import math
from collections.abc import Callable
from typing import Any, Literal

import numba
import numpy as np
import pytest
from forms import large_where_compiled
from hypothesis import example, given, settings, strategies as st
from scipy.integrate import quad

import roughmdr as rm
from roughmdr.shapes import Shape

pytestmark = pytest.mark.skipif(
    numba.config.DISABLE_JIT, reason="the references are read with and without the compiler; this would take minutes"
)
E, W, R = 2e9, 0.07, 3e-6
SPHERE = rm.Paraboloid(radius=R)
CONE = rm.Cone(slope=0.2)
TRUNCATED = rm.TruncatedCone(slope=0.25, flat_radius=4e-8)


def strength_of(shape: Shape, tabor: float, effective_modulus: float = E, work: float = W) -> float:
    """The strength [Pa] of a Tabor number, which is proportional to it."""
    return tabor / float(rm.tabor(shape, effective_modulus=effective_modulus, work=work, strength=1.0))


def law(shape: Shape, tabor: float, effective_modulus: float = E, work: float = W) -> dict[str, Any]:
    strength = strength_of(shape, tabor, effective_modulus, work)
    return {"effective_modulus": effective_modulus, "work": work, "strength": strength, "adhesion": "dugdale"}


def rate(x: np.ndarray, error: np.ndarray) -> float:
    """The power of x that the error goes with."""
    return float(np.polynomial.polynomial.polyfit(np.log(x), np.log(error), 1)[1])


def test_tabor_numbers() -> None:
    a_c: dict[Shape, float] = {
        SPHERE: (math.pi * W * R**2 / (8.0 * E)) ** (1 / 3),
        CONE: 2.0 * W / (math.pi * 0.2**2 * E),
    }
    a_c[rm.FlatPunch(radius=3e-7)] = 3e-7
    for shape, radius in a_c.items():
        stretch = math.sqrt(2.0 * math.pi * radius * W / E)
        for strength in (1e4, 1e11):
            expected = stretch * strength / (math.pi ** (2 / 3) * W)
            assert float(rm.tabor(shape, effective_modulus=E, work=W, strength=strength)) == pytest.approx(
                expected, rel=1e-13
            )


@pytest.mark.parametrize("control", ["displacement", "force"])
@pytest.mark.parametrize(
    "shape", [SPHERE, CONE, rm.RoundedCone(slope=0.25, blend_radius=4e-8)], ids=lambda shape: shape.name
)
def test_jkr_is_the_limit_of_great_strength(shape: Shape, control: Literal["displacement", "force"]) -> None:
    """The error of pull-off goes with the strength to the power -2."""
    tabor = np.geomspace(30.0, 300.0, 4)
    jkr = rm.pull_off(shape, effective_modulus=E, work=W, control=control)
    off = [rm.pull_off(shape, **law(shape, each), control=control) for each in tabor]
    for quantity in ("force", "indentation"):
        error = np.array([abs(float(each[quantity] / jkr[quantity]) - 1.0) for each in off])
        assert error[-1] < 1e-4
        assert rate(tabor, error) == pytest.approx(-2.0, abs=0.1), (quantity, error)


def test_dmt_is_the_limit_of_little_strength() -> None:
    """-2 pi w R is met with an error that goes with the strength to the power 3/2: a is 0 but for higher orders,
    and the pull -pi sigma0 c^2 at c^2/(2 R) + beta c (1 - 2/pi) = w/sigma0 is off by beta sigma0 c (1 - 2/pi)/w.
    """
    tabor = np.geomspace(1e-5, 1e-3, 5)
    off = [float(rm.pull_off(SPHERE, **law(SPHERE, each), control="force").force) for each in tabor]
    error = np.array(off) / (-2.0 * math.pi * W * R) - 1.0
    assert (error < 0.0).all()
    assert rate(tabor, -error) == pytest.approx(1.5, abs=0.05)
    strength = strength_of(SPHERE, tabor[0])
    first = 2.0 * strength / E * strength * math.sqrt(2.0 * W * R / strength) * (1.0 - 2.0 / math.pi) / W
    assert -error[0] == pytest.approx(first, rel=0.05)


def test_from_dmt_to_jkr() -> None:
    tabor = np.geomspace(1e-3, 1e3, 25)
    laws = [law(SPHERE, each) for each in tabor]
    held = [rm.pull_off(SPHERE, **each, control="displacement") for each in laws]
    depth = -np.array([float(each.indentation) for each in held])
    pull = -np.array([float(rm.pull_off(SPHERE, **each, control="force").force) for each in laws]) / (math.pi * W * R)
    assert (np.diff(depth) < 0.0).all()
    assert (np.diff(pull) < 0.0).all()
    assert (pull > 1.5).all()
    assert (pull < 2.0).all()
    for each, deepest in zip(laws, depth, strict=True):
        contact = rm.indent(SPHERE, **each, indentation=deepest * np.geomspace(1e-6, 1e3, 40) - deepest)
        a, c = contact.contact_radius.values, contact.cohesive_radius.values
        assert (a >= 0.0).all()
        assert (c > a).all()
        assert (np.diff(a) >= 0.0).all()
        assert (np.diff(c) > 0.0).all()
        assert (contact.force.values[1:] >= -pull.max() * math.pi * W * R).all()
        assert contact.force.values[-1] > 0.0


def test_where_the_contact_lifts_before_it_lets_go() -> None:
    """The fold c = 2 beta R/pi of the branch a = 0 meets a > 0 where beta^2 R (2/pi) (1 - 1/pi) = w/sigma0, at Maugis's
    lambda = (9 pi/(16 (pi - 1)))^(1/3) = 0.938. Below it the contact lifts off (a = 0) before it lets go.
    """
    border = (math.pi * W * E**2 / (8.0 * R * (1.0 - 1.0 / math.pi))) ** (1 / 3)
    lam = 2.0 * border * (R / (math.pi * W * (4.0 * E / 3.0) ** 2)) ** (1 / 3)
    assert lam == pytest.approx((9.0 * math.pi / (16.0 * (math.pi - 1.0))) ** (1 / 3), rel=1e-14)
    for part in (0.3, 0.9, 1.0 - 1e-6):
        strength = part * border
        beta = 2.0 * strength / E
        off = rm.pull_off(
            SPHERE, effective_modulus=E, work=W, strength=strength, adhesion="dugdale", control="displacement"
        )
        c = 2.0 * beta * R / math.pi
        assert float(off.contact_radius) == 0.0
        assert float(off.cohesive_radius) == pytest.approx(c, rel=1e-12)
        assert float(off.force) == pytest.approx(-math.pi * strength * c**2, rel=1e-12)
        assert float(off.indentation) == pytest.approx(-(c**2) / (2.0 * R) - W / strength, rel=1e-12)
    radii = []
    for part in (1.0 + 1e-6, 1.01, 1.1, 2.0):
        off = rm.pull_off(
            SPHERE, effective_modulus=E, work=W, strength=part * border, adhesion="dugdale", control="displacement"
        )
        radii.append(float(off.contact_radius / off.cohesive_radius))
    assert 0.0 < radii[0] < 1e-4
    assert (np.diff(radii) > 0.0).all()


@large_where_compiled
@pytest.mark.parametrize("length", [1e-6, 1e3])
@pytest.mark.parametrize("pressure", [1e-5, 1.0])
@pytest.mark.parametrize("tabor", [0.1, 2.0])
def test_other_units_give_the_same_contact(length: float, pressure: float, tabor: float) -> None:
    there_shape = rm.TruncatedCone(slope=0.25, flat_radius=4e-8 * length)
    here = law(TRUNCATED, tabor)
    there = here | {
        "effective_modulus": E * pressure,
        "strength": here["strength"] * pressure,
        "work": W * pressure * length,
    }
    depth = -float(rm.pull_off(TRUNCATED, **here, control="displacement").indentation)
    delta = depth * np.array([-0.9, -0.2, 0.0, 0.7, 30.0])
    one = rm.indent(TRUNCATED, **here, indentation=delta)
    other = rm.indent(there_shape, **there, indentation=delta * length)
    units = {"force": length**2 * pressure, "stiffness": length * pressure}
    for quantity in ("force", "stiffness", "contact_radius", "cohesive_radius"):
        unit = units.get(quantity, length)
        np.testing.assert_allclose(other[quantity], one[quantity] * unit, rtol=1e-11, atol=0.0, err_msg=quantity)


def springs(shape: Shape, beta: float, a: float, c: float, delta: float) -> tuple[float, float]:
    """P/(2 E*) [m2] and the gap [m] at c, from u1 by plain quadrature over x = c sin(phi)."""
    kink = getattr(shape, "blend_radius", 0.0)
    edge = math.atan2(a, math.sqrt((c - a) * (c + a)))
    cuts = [0.0, *([math.asin(kink / c)] if 0.0 < kink < a else []), edge]

    def u1(phi: float) -> float:
        return delta - float(shape.g(c * math.sin(phi)))

    most = abs(delta) + float(shape.g(a)) if a > 0.0 else abs(delta)
    force, gap = 0.0, 0.0
    for lo, hi in itertools.pairwise(cuts):
        force += integral(lambda phi: u1(phi) * c * math.cos(phi), lo, hi, most * c)
        gap += integral(u1, lo, hi, most)
    force -= beta * integral(lambda phi: (c * math.cos(phi)) ** 2, edge, math.pi / 2.0, c**2)
    gap -= beta * integral(lambda phi: c * math.cos(phi), edge, math.pi / 2.0, c)
    return force, float(shape.f(c)) - delta + 2.0 / math.pi * gap


def integral(function: Callable[[float], float], low: float, high: float, most: float) -> float:
    """Right to 1e-12 of the greatest value that the function may have, since the integral itself may be next to 0."""
    return float(quad(function, low, high, epsabs=1e-12 * most, epsrel=0.0)[0])


def decades(least: float, most: float) -> st.SearchStrategy[float]:
    return st.floats(math.log10(least), math.log10(most)).map(lambda y: 10.0**y)


@st.composite
def asperities(draw: st.DrawFn, *, any_shape: bool) -> tuple[Shape, float, float]:
    """A shape, a modulus [Pa] and a work [J/m2]."""
    width, aspect, effective_modulus = draw(decades(1e-9, 1e-3)), draw(decades(1e-2, 1.0)), draw(decades(1e4, 1e12))
    rise = width * aspect
    others = [
        rm.Cone(slope=aspect),
        rm.RoundedCone(slope=aspect, blend_radius=width),
        rm.PowerLaw(exponent=draw(st.floats(1.0, 6.0)), width=width, rise=rise),
    ]
    shape: Shape = draw(st.sampled_from([rm.Paraboloid(radius=width / aspect), *(others if any_shape else [])]))
    work = (draw(decades(0.1, 10.0)) * rise) ** 2 * effective_modulus / (2.0 * math.pi * width)
    return shape, effective_modulus, work


_distances = st.floats(0.01, 0.99) | decades(1.0, 100.0)


@settings(deadline=None, max_examples=20)
@given(asperities(any_shape=False), decades(0.03, 10.0), _distances)
def test_the_equations_hold(asperity: tuple[Shape, float, float], tabor: float, distance: float) -> None:
    check_equations(asperity, tabor, distance)


@pytest.mark.large
@settings(deadline=None, max_examples=60)
@given(asperities(any_shape=True), decades(0.03, 10.0), _distances)
@example((rm.Cone(slope=0.9999997255105045), 1e4, 1.591548557191873), 0.1, 0.5)  # no stiffness at its pull-off
@example((rm.RoundedCone(slope=1.0, blend_radius=1e-3), 1e4, 0.03480678267614496), 10.0**0.625, 10.0**1.5078125)
def test_the_equations_hold_for_any_shape(asperity: tuple[Shape, float, float], tabor: float, distance: float) -> None:
    check_equations(asperity, tabor, distance)


def check_equations(asperity: tuple[Shape, float, float], tabor: float, distance: float) -> None:
    shape, effective_modulus, work = asperity
    mine = law(shape, tabor, effective_modulus, work)
    strength, beta = mine["strength"], 2.0 * mine["strength"] / effective_modulus
    depth = -float(rm.pull_off(shape, **mine, control="displacement").indentation)
    delta = depth * (distance - 1.0)
    contact = rm.indent(shape, **mine, indentation=delta)
    a, c = float(contact.contact_radius), float(contact.cohesive_radius)
    assert 0.0 <= a <= c
    assert c > 0.0
    spread = beta * math.sqrt((c - a) * (c + a))
    height = float(shape.g(a)) if a > 0.0 else 0.0
    if a > 0.0:
        assert abs(height - spread - delta) <= 1e-9 * max(height, spread)
    else:
        assert -delta >= spread * (1.0 - 1e-9)
    force, gap = springs(shape, beta, a, c, delta)
    assert abs(gap - work / strength) <= 1e-9 * max(work / strength, float(shape.f(c)), abs(delta))
    scale = max(a * height, c * spread, abs(force))
    assert abs(float(contact.force) / (2.0 * effective_modulus) - force) <= 1e-9 * scale


def test_an_attraction_that_reaches_around_a_sphere_is_refused() -> None:
    with pytest.raises(
        rm.OutOfRange, match=r"strength is 1000 Pa: its range, 7e-05 m, reaches beyond the end of Sphere"
    ):
        rm.pull_off(
            rm.Sphere(radius=R), effective_modulus=E, work=W, adhesion="dugdale", strength=1e3, control="displacement"
        )
