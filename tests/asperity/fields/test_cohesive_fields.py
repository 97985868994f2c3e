"""The fields under adhesion with a range: the half-space, the gap, the stress in the zone, and the limit of JKR."""

import math
import re
from functools import cache
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from forms import large_where_compiled
from numpy.typing import NDArray
from scipy.special import ellipkm1

import roughmdr as rm
from roughmdr.shapes import Shape

Floats = NDArray[np.float64]
E, WORK = 2e8, 0.03
B = 4e-7
SHAPES: dict[str, tuple[Shape, float, tuple[float, ...]]] = {  # Tabor number, and where the pressure is not smooth
    "paraboloid": (rm.Paraboloid(radius=7e-6), 1.3, ()),
    "short range": (rm.Paraboloid(radius=7e-6), 8.0, ()),
    "cone": (rm.Cone(slope=0.1), 0.6, ()),
    "power_law": (rm.PowerLaw(exponent=2.7, width=1e-6, rise=5e-8), 1.0, ()),
    "sphere": (rm.Sphere(radius=7e-6), 0.7, ()),
    "truncated_cone": (rm.TruncatedCone(slope=0.1, flat_radius=B), 2.0, (B,)),
    "rounded_cone": (rm.RoundedCone(slope=0.1, blend_radius=B), 1.0, (B,)),
    "flat_punch": (rm.FlatPunch(radius=B), 1.0, (B,)),
}
PARTS = (-0.3, 0.6, 1.5)
"""Indentations: minus that of detachment times these; the last is pressed in."""


def numbers_of(name: str) -> dict[str, object]:
    shape, tabor, _ = SHAPES[name]
    strength = tabor / rm.tabor(shape, effective_modulus=E, work=WORK, strength=1.0)
    return {"effective_modulus": E, "work": WORK, "adhesion": "dugdale", "strength": strength}


@cache
def indentations(name: str) -> Floats:
    low = float(rm.pull_off(SHAPES[name][0], control="displacement", **numbers_of(name)).indentation)
    return -low * np.array([-0.98, *PARTS])


def graded(ends: list[float], count: int = 36) -> tuple[Floats, Floats]:
    """Nodes and weights between the ends, with steps towards each like the sixth power."""
    x, w = np.polynomial.legendre.leggauss(count)
    x, w = 0.5 * (1.0 + x), 0.5 * w
    at, weight = [], []
    for low, high in pairwise(ends):
        half = 0.5 * (high - low)
        at += [low + half * x**6, high - half * x**6]
        weight += [6.0 * half * x**5 * w] * 2
    return np.concatenate(at), np.concatenate(weight)


every_shape = pytest.mark.parametrize("name", SHAPES)


@pytest.mark.few(14)
@every_shape
@pytest.mark.parametrize("which", range(len(PARTS) + 1))
def test_the_half_space_answers_the_pressure(name: str, which: int) -> None:
    """∫ p dA = P, and u = 4/(pi E*) ∫ p s/(r + s) K(4 r s/(r + s)^2) ds, inside, in the zone and beyond."""
    shape, _, breaks = SHAPES[name]
    numbers, delta = numbers_of(name), float(indentations(name)[which])
    if name == "flat_punch" and delta > 0.0:
        return  # as without adhesion
    state = rm.indent(shape, indentation=delta, **numbers)
    a, c, strength = float(state.contact_radius), float(state.cohesive_radius), float(numbers["strength"])
    field = {"indentation": delta, **numbers}
    r = np.array([0.0, 0.4 * a, 0.9 * a, a + 0.3 * (c - a), a + 0.8 * (c - a), c, 1.01 * c, 2.5 * c, 40.0 * c])
    ends = sorted({0.0, a, c, *(edge for edge in breaks if edge < c), *r[r < c].tolist()})
    s, ds = graded(ends)
    keep = (s > 0.0) & (s < c) & ~np.isin(s, ends)
    s, ds = s[keep], ds[keep]
    p = rm.pressure(shape, r=s, **field).to_numpy()
    assert (p[s > a] == -strength).all()
    assert (p > -strength * (1.0 + 1e-12)).all()
    assert (rm.pressure(shape, r=[1.0000001 * c, 3.0 * c], **field) == 0.0).all()
    scale = 2.0 * math.pi * float(np.sum(np.abs(p) * s * ds))
    assert 2.0 * math.pi * np.sum(p * s * ds) == pytest.approx(float(state.force), abs=1e-10 * scale)
    total = r[:, None] + s
    kernel = ellipkm1(np.maximum(((r[:, None] - s) / total) ** 2, 1e-300)) * s / total
    expected = 4.0 / (math.pi * E) * np.sum(p * kernel * ds, axis=1)
    u = rm.surface_displacement(shape, r=r, **field).to_numpy()
    size = strength * c / E
    np.testing.assert_allclose(u, expected, rtol=0, atol=2e-9 * max(size, abs(delta)))
    gap = -delta + float(u[5]) + (0.0 if name == "flat_punch" else float(shape.f(c)))
    if name == "flat_punch":
        assert gap <= WORK / strength * (1.0 + 1e-12)
    else:
        assert gap == pytest.approx(WORK / strength, rel=1e-9)


@every_shape
def test_pressure_and_displacement_are_continuous_at_the_edge_of_the_contact(name: str) -> None:
    shape, numbers = SHAPES[name][0], numbers_of(name)
    delta = float(indentations(name)[1])
    state = rm.indent(shape, indentation=delta, **numbers)
    a, c = float(state.contact_radius), float(state.cohesive_radius)
    if a == 0.0:
        return
    step = 1e-12 * (c - a)
    r = a + np.array([-step, 0.0, step])
    p = rm.pressure(shape, r=r, indentation=delta, **numbers).to_numpy()
    u = rm.surface_displacement(shape, r=r, indentation=delta, **numbers).to_numpy()
    assert p[1] == p[2] == -numbers["strength"]
    assert p[0] == pytest.approx(-numbers["strength"], rel=1e-4)
    np.testing.assert_allclose(u, u[1], rtol=0, atol=1e-9 * abs(u[1]))


@pytest.mark.parametrize("tabor", [0.3, 1.5, 40.0])
def test_the_paraboloid_has_the_integrals_of_its_springs(tabor: float) -> None:
    """P and u from u1 by quadrature of 30 digits, at a contact radius."""
    mp = mpmath.mp.clone()
    mp.dps = 30
    R = 7e-6
    tip = rm.Paraboloid(radius=R)
    strength = tabor / rm.tabor(tip, effective_modulus=E, work=WORK, strength=1.0)
    numbers = {"effective_modulus": E, "work": WORK, "adhesion": "dugdale", "strength": strength}
    a = float(rm.indent(tip, indentation=0.0, **numbers).contact_radius) * 1.1
    state = rm.indent(tip, contact_radius=a, **numbers)
    c, beta = mp.mpf(float(state.cohesive_radius)), 2 * mp.mpf(strength) / E

    def zone(x: object, square: object) -> object:
        return mp.sqrt(abs((c - x) * (c + x)) / square)

    for r in (0.3, 0.95):
        at = mp.mpf(a * r)
        depth = mp.sqrt((a - at) * (a + at))
        body = mp.mpf(2) / R * depth
        share = beta * mp.atan2(mp.sqrt((c - a) * (c + a)), depth)
        exact = E / mp.pi * (body - share)
        found = rm.pressure(tip, r=float(at), contact_radius=a, **numbers)
        assert float(found) == pytest.approx(float(exact), abs=1e-9 * strength)
    for part in (0.1, 0.5, 0.999, 1.001, 3.0):
        r = a + (float(c) - a) * part
        top = min(mp.mpf(r), c)
        delta = mp.mpf(a) ** 2 / R - beta * mp.sqrt((c - a) * (c + a))
        contact = mp.quad(lambda x, r=r, delta=delta: (delta - x * x / R) / mp.sqrt((r - x) * (r + x)), [0, a])
        end = mp.asin(top / r)
        pulled = mp.quad(lambda phi, r=r: zone(r * mp.sin(phi), 1), [mp.asin(mp.mpf(a) / r), end])
        exact = 2 / mp.pi * (contact - beta * pulled)
        found = rm.surface_displacement(tip, r=r, contact_radius=a, **numbers)
        assert float(found) == pytest.approx(float(exact), abs=1e-10 * float(beta * c))


def test_a_short_range_is_jkr() -> None:
    tip, a = rm.Paraboloid(radius=7e-6), 6e-7
    field = {"contact_radius": a, "effective_modulus": E, "work": WORK}
    r = a * np.array([0.0, 0.5, 0.8, 1.2, 5.0])
    jkr = rm.pressure(tip, r=r, **field).to_numpy()
    moved = rm.surface_displacement(tip, r=r, **field).to_numpy()
    tabor = rm.tabor(tip, effective_modulus=E, work=WORK, strength=1.0)
    errors = []
    for number in (10.0, 100.0, 1000.0):
        cohesive = {"adhesion": "dugdale", "strength": number / tabor, **field}
        p = rm.pressure(tip, r=r, **cohesive).to_numpy()
        u = rm.surface_displacement(tip, r=r, **cohesive).to_numpy()
        errors.append((np.abs(p - jkr)[:3].max() / np.abs(jkr).max(), np.abs(u - moved).max() / np.abs(moved).max()))
        assert (p[3:] == 0.0).all()
    for coarse, fine in pairwise(errors):
        assert all(better < 0.12 * worse for better, worse in zip(fine, coarse, strict=True))
    assert max(errors[-1]) < 1e-3


def test_out_of_reach_there_is_no_field() -> None:
    tip, numbers = SHAPES["paraboloid"][0], numbers_of("paraboloid")
    r = np.array([0.0, 1e-7, 1e-6])
    for field in (rm.pressure, rm.surface_displacement):
        assert (field(tip, r=r, indentation=2.0 * float(indentations("paraboloid")[0]), **numbers) == 0.0).all()
        assert field(tip, r=[], indentation=0.0, **numbers).sizes == {"r": 0}


@large_where_compiled
def test_the_zone_of_a_pressed_punch_is_closed() -> None:
    punch, numbers = SHAPES["flat_punch"][0], numbers_of("flat_punch")
    r = B * np.array([0.0, 0.7, 0.99])
    plain = rm.pressure(punch, r=r, indentation=1e-8, effective_modulus=E)
    np.testing.assert_allclose(rm.pressure(punch, r=r, indentation=1e-8, **numbers), plain, rtol=1e-14)
    with pytest.raises(rm.OutOfRange, match="the edge of the contact"):
        rm.pressure(punch, r=B, indentation=1e-8, **numbers)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda tip, numbers: rm.pressure(tip, r=0.0, contact_radius=0.0, **numbers), "contact_radius is 0 m"),
        (
            lambda tip, numbers: rm.axis_stress(tip, z=1e-8, indentation=0.0, poisson=0.3, **numbers),
            "adhesion is 'dugdale'; axis_stress takes adhesion='jkr' only",
        ),
        (
            lambda tip, numbers: rm.pressure(tip, r=0.0, indentation=0.0, **{**numbers, "strength": None}),
            "adhesion model 'dugdale' needs strength",
        ),
    ],
)
def test_what_is_refused(call: object, message: str) -> None:
    with pytest.raises(rm.RoughmdrError, match=re.escape(message)):
        call(SHAPES["paraboloid"][0], numbers_of("paraboloid"))  # type: ignore[operator]


def test_the_tip_of_a_cone_is_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="the sharp tip"):
        rm.pressure(SHAPES["cone"][0], r=0.0, indentation=3e-8, **numbers_of("cone"))
