"""The fields of one contact against the half-space itself, closed forms, and what they refuse."""

import math
import re
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.special import ellipk, ellipkm1

import roughmdr as rm
from roughmdr.shapes import Shape

Floats = NDArray[np.float64]
E, WORK, NU = 1e9, 0.05, 0.3

R_TABLE = np.array([0.0, 0.4, 0.9, 1.5, 3.0]) * 1e-6
SHAPES: dict[str, tuple[Shape, float]] = {  # each with an indentation
    "paraboloid": (rm.Paraboloid(radius=1e-5), 1e-7),
    "cone": (rm.Cone(slope=0.1), 1e-7),
    "power_law": (rm.PowerLaw(exponent=2.7, width=1e-6, rise=5e-8), 1e-7),
    "blunt power_law": (rm.PowerLaw(exponent=0.8, width=1e-6, rise=5e-8), 1e-7),
    "flat_punch": (rm.FlatPunch(radius=1e-6), 1e-7),
    "sphere": (rm.Sphere(radius=4e-6), 3e-7),
    "truncated_cone": (rm.TruncatedCone(slope=0.1, flat_radius=7e-7), 1e-7),
    "truncated_paraboloid": (rm.TruncatedParaboloid(radius=1e-5, flat_radius=7e-7), 1e-7),
    "rounded_cone": (rm.RoundedCone(slope=0.1, blend_radius=3e-7), 1e-7),
    "capped_paraboloid": (rm.CappedParaboloid(radius=1e-5, cap_radius=3e-5, blend_radius=5e-7), 1e-7),
    "rounded_punch": (rm.RoundedPunch(flat_radius=5e-7, edge_radius=5e-6), 3e-8),
    "power_series": (rm.PowerSeries(terms={1.0: 0.01, 2.0: 4e4, 4.5: 1e18}), 1e-7),
    "tabulated": (rm.Tabulated(r=R_TABLE, f=R_TABLE**2 / 1e-5 + 0.01 * R_TABLE), 1e-7),
    "mdr_table": (rm.MdrTable(a=R_TABLE[1:], g=[1e-8, 7e-8, 1.2e-7, 5e-7]), 1e-7),
}
BREAKS = {  # where the pressure is not smooth
    "truncated_cone": [7e-7],
    "truncated_paraboloid": [7e-7],
    "rounded_cone": [3e-7],
    "capped_paraboloid": [5e-7],
    "rounded_punch": [5e-7],
    "tabulated": list(R_TABLE[1:]),
    "mdr_table": list(R_TABLE[1:]),
}
every_shape = pytest.mark.parametrize("name", SHAPES)
every_work = pytest.mark.parametrize("work", [0.0, WORK], ids=["elastic", "jkr"])


class Sampled(NamedTuple):
    """A pressure at the nodes of a quadrature over s that is exact to about 1e-13."""

    shape: Shape
    indentation: float
    state: Any
    inside: Floats
    s: Floats
    ds: Floats
    p: Floats


def nodes(breaks: list[float], a: float, count: int = 36) -> tuple[Floats, Floats]:
    """Nodes s and weights from 0 to a in s = a sin(theta): steps towards each break like the sixth power."""
    x, w = np.polynomial.legendre.leggauss(count)
    x, w = 0.5 * (1.0 + x), 0.5 * w
    theta = np.arcsin(np.array([0.0, *sorted(b for b in breaks if b < a), a]) / a)
    at, weight = [], []
    for low, high in pairwise(theta):
        half = 0.5 * (high - low)
        at.append(low + half * x**6)
        weight.append(6.0 * half * x**5 * w)
        power = 1 if high == theta[-1] else 6  # the edge is smooth in theta
        at.append(high - half * x**power)
        weight.append(power * half * x ** (power - 1) * w)
    angle = np.concatenate(at)
    return a * np.sin(angle), np.concatenate(weight) * a * np.cos(angle)


@cache
def sampled(name: str, work: float) -> Sampled:
    shape, depth = SHAPES[name]
    state = rm.indent(shape, effective_modulus=E, work=work, indentation=depth)
    a = float(state.contact_radius)
    inside = a * np.array([0.23, 0.81])
    s, ds = nodes([*BREAKS.get(name, []), *inside], a)
    keep = (s > 0.0) & (s < a) & ~np.isin(s, [*BREAKS.get(name, []), *inside])
    s, ds = s[keep], ds[keep]
    p = rm.pressure(shape, r=s, indentation=depth, effective_modulus=E, work=work).to_numpy()
    return Sampled(shape, depth, state, inside, s, ds, p)


@pytest.mark.few(12)
@every_shape
@every_work
def test_the_pressure_integrates_to_the_force(name: str, work: float) -> None:
    one = sampled(name, work)
    scale = abs(2.0 * math.pi * np.sum(np.abs(one.p) * one.s * one.ds))
    assert 2.0 * math.pi * np.sum(one.p * one.s * one.ds) == pytest.approx(float(one.state.force), abs=3e-12 * scale)


@every_shape
@every_work
def test_the_pressure_bends_the_half_space_to_the_profile(name: str, work: float) -> None:
    """u(r) = 4/(pi E*) ∫ p s/(r + s) K(4 r s/(r + s)^2) ds: delta - f inside, what the package says outside."""
    one = sampled(name, work)
    a = float(one.state.contact_radius)
    r = np.concatenate([[0.0], one.inside, a * np.array([1.2, 3.0, 50.0])])
    total = r[:, None] + one.s
    kernel = ellipkm1(((r[:, None] - one.s) / total) ** 2) * one.s / total
    expected = 4.0 / (math.pi * E) * np.sum(one.p * kernel * one.ds, axis=1)
    u = rm.surface_displacement(one.shape, r=r, indentation=one.indentation, effective_modulus=E, work=work).to_numpy()
    np.testing.assert_allclose(u[:3], one.indentation - one.shape.f(r[:3]), rtol=1e-15)
    np.testing.assert_allclose(u, expected, atol=1e-11 * one.indentation, rtol=0)


@pytest.mark.parametrize("name", ["paraboloid", "cone", "flat_punch", "truncated_cone", "rounded_punch", "tabulated"])
@every_work
def test_the_stress_on_the_axis_is_boussinesqs(name: str, work: float) -> None:
    one = sampled(name, work)
    z = float(one.state.contact_radius) * np.array([0.4, 1.0, 7.0])
    found = rm.axis_stress(one.shape, z=z, indentation=one.indentation, effective_modulus=E, work=work, poisson=NU)
    depth, R = z[:, None], np.hypot(z[:, None], one.s)
    pressed = one.p * one.s * one.ds
    zz = -3.0 * np.sum(pressed * depth**3 / R**5, axis=1)
    rr = 0.5 * np.sum(pressed * ((1.0 - 2.0 * NU) * depth / R**3 - 3.0 * depth * one.s**2 / R**5), axis=1)
    scale = E * one.indentation / float(one.state.contact_radius)
    np.testing.assert_allclose(found.sigma_zz, zz, atol=1e-11 * scale, rtol=0)
    np.testing.assert_allclose(found.sigma_rr, rr, atol=1e-11 * scale, rtol=0)
    np.testing.assert_allclose(found.shear, 0.5 * np.abs(zz - rr), atol=1e-11 * scale, rtol=0)


R, A = 1e-5, 1e-6
RADII = A * np.array([0.0, 1e-9, 0.1, 0.5, 0.99, 1.0 - 1e-9])
BEYOND = A * np.array([1.0 + 1e-12, 1.001, 2.0])


def jkr_radius(work: float) -> float:
    return float(rm.indent(rm.Paraboloid(radius=R), effective_modulus=E, work=work, indentation=0.0).contact_radius)


def test_hertz() -> None:
    p0 = 2.0 * E * A / (math.pi * R)
    p = rm.pressure(rm.Paraboloid(radius=R), r=RADII, contact_radius=A, effective_modulus=E)
    np.testing.assert_allclose(p, p0 * np.sqrt((A - RADII) * (A + RADII)) / A, rtol=1e-13)
    x = A / BEYOND
    expected = A * A / (math.pi * R) * ((2.0 - x**-2) * np.arcsin(x) + np.sqrt((1.0 - x) * (1.0 + x)) / x)
    u = rm.surface_displacement(rm.Paraboloid(radius=R), r=BEYOND, contact_radius=A, effective_modulus=E)
    np.testing.assert_allclose(u, expected, rtol=1e-13)


def test_the_shear_under_hertz_is_largest_where_johnson_has_it() -> None:
    """0.310 p0 at z = 0.48 a for a Poisson's ratio of 0.3 (K. L. Johnson, Contact Mechanics, 1985, section 4.2)."""
    p0 = 2.0 * E * A / (math.pi * R)

    def stresses(z: Any, nu: float) -> tuple[Any, Any]:
        zz = -1.0 / (1.0 + z * z)
        return zz, -(1.0 + nu) * (1.0 - z * np.arctan2(1.0, z)) - 0.5 * zz

    z = np.array([0.0, 1e-6, 0.3, 1.0, 5.0])
    found = rm.axis_stress(rm.Paraboloid(radius=R), z=A * z, contact_radius=A, effective_modulus=E, poisson=NU)
    zz, rr = stresses(z, NU)
    np.testing.assert_allclose(found.sigma_zz / p0, zz, rtol=1e-13)
    np.testing.assert_allclose(found.sigma_rr / p0, rr, rtol=1e-11)
    np.testing.assert_allclose(found.shear / p0, 0.5 * np.abs(zz - rr), rtol=1e-12)
    assert float(found.largest_shear) == pytest.approx(0.3100205 * p0, rel=1e-6)
    assert float(found.largest_shear_depth) == pytest.approx(0.4808645 * A, rel=1e-6)
    bounded: Any = {"bounds": (0.1, 1.0), "method": "bounded", "options": {"xatol": 1e-9}}
    best = minimize_scalar(lambda z: -0.5 * abs(np.subtract(*stresses(z, NU))), **bounded)
    assert float(found.largest_shear) == pytest.approx(-best.fun * p0, rel=1e-12)


def test_sneddons_cone() -> None:
    p = rm.pressure(rm.Cone(slope=0.1), r=RADII[1:], contact_radius=A, effective_modulus=E)
    np.testing.assert_allclose(p, 0.5 * E * 0.1 * np.arccosh(A / RADII[1:]), rtol=3e-8)  # arccosh of 1 + 1e-9
    np.testing.assert_allclose(p[:-1], 0.5 * E * 0.1 * np.arccosh(A / RADII[1:-1]), rtol=1e-13)
    x = BEYOND / A
    expected = 0.1 * A * (np.arcsin(1.0 / x) - x + np.sqrt((x - 1.0) * (x + 1.0)))
    u = rm.surface_displacement(rm.Cone(slope=0.1), r=BEYOND, contact_radius=A, effective_modulus=E)
    np.testing.assert_allclose(u, expected, rtol=1e-12)


def test_the_flat_punch() -> None:
    punch, depth = rm.FlatPunch(radius=A), 3e-8
    p = rm.pressure(punch, r=RADII, indentation=depth, effective_modulus=E)
    np.testing.assert_allclose(p, E * depth / math.pi / np.sqrt((A - RADII) * (A + RADII)), rtol=1e-14)
    r = np.array([0.0, A, *BEYOND])
    u = rm.surface_displacement(punch, r=r, indentation=depth, effective_modulus=E)
    np.testing.assert_allclose(u, 2.0 / math.pi * depth * np.arcsin(np.minimum(1.0, A / np.maximum(r, A))), rtol=1e-9)
    np.testing.assert_allclose(u[[0, 1, 3, 4]], np.append([depth, depth], 2 / math.pi * depth * np.arcsin(A / r[3:])))
    z = A * np.array([0.0, 0.5, 2.0])
    found = rm.axis_stress(punch, z=z, indentation=depth, effective_modulus=E, poisson=NU)
    factor = -E * depth / math.pi * A / (A * A + z * z) ** 2
    np.testing.assert_allclose(found.sigma_zz, factor * (A * A + 3.0 * z * z), rtol=1e-14)
    np.testing.assert_allclose(found.sigma_rr, 0.5 * factor * (1.6 * A * A - 0.4 * z * z), rtol=1e-14)
    assert float(found.largest_shear_depth) == pytest.approx(A * math.sqrt((2.5 + NU) / (3.5 - NU)), rel=1e-12)
    pulled = rm.pressure(punch, r=0.0, indentation=-1e-9, effective_modulus=E, work=WORK)
    assert float(pulled) == pytest.approx(-E * 1e-9 / math.pi / A, rel=1e-14)


def test_jkr() -> None:
    a = jkr_radius(WORK)
    r = a * RADII / A
    root = np.sqrt((a - r) * (a + r))
    stretch = math.sqrt(2.0 * math.pi * a * WORK / E)
    for control in ({"contact_radius": a}, {"indentation": 0.0}):
        p = rm.pressure(rm.Paraboloid(radius=R), r=r, effective_modulus=E, work=WORK, **control)
        np.testing.assert_allclose(
            p[:-1], (2.0 * E / (math.pi * R) * root - E * stretch / math.pi / root)[:-1], rtol=1e-12
        )
        np.testing.assert_allclose(p, 2.0 * E / (math.pi * R) * root - E * stretch / math.pi / root, rtol=1e-6)


class Twin:
    """The fields as printed (H 42), from f' and g by numbers with 30 digits."""

    def __init__(self, name: str) -> None:
        self.name = name

    def g(self, x: Any) -> tuple[Any, Any]:
        """g and g' in units of the flat or the width, of a slope 1 and radii 1."""
        mp = mpmath.mp
        if self.name == "power_law":
            kappa = mp.sqrt(mp.pi) / 2 * mp.mpf(2.7) * mp.gamma(mp.mpf(1.35)) / mp.gamma(mp.mpf(1.85))
            return kappa * x ** mp.mpf(2.7), kappa * mp.mpf(2.7) * x ** mp.mpf(1.7)
        if x <= 1:
            return mp.mpf(0), mp.mpf(0)
        q = mp.sqrt((x - 1) * (x + 1))
        angle = mp.atan(q)
        if self.name == "truncated_cone":
            return x * angle, angle + 1 / q
        return x * (q - angle), q - angle + x * (q / x)

    def pressure(self, r: float, a: float) -> Any:
        """pi p/E*."""
        mp = mpmath.mp
        r, a = mp.mpf(r), mp.mpf(a)
        low = r if self.name == "power_law" else max(r, mp.mpf(1))
        way = mp.sqrt((a - low) * (a + low))
        ends = [mp.mpf(0), *(way * mp.mpf(10) ** k for k in range(-16, 1, 4))]
        if low > r:  # x^2 = low^2 + y^2
            return mp.quad(
                lambda y: self.g(mp.hypot(low, y))[1] / mp.sqrt(low**2 - r**2 + y * y) * y / mp.hypot(low, y), ends
            )
        return mp.quad(lambda y: self.g(mp.hypot(r, y))[1] / mp.hypot(r, y), ends)

    def displacement(self, r: float, a: float) -> Any:
        """pi/2 u."""
        mp = mpmath.mp
        r, a = mp.mpf(r), mp.mpf(a)
        delta = self.g(a)[0]
        ends = [mp.mpf(0), mp.asin(1 / r), mp.asin(a / r)]
        return mp.quad(lambda angle: delta - self.g(r * mp.sin(angle))[0], [end for end in ends if end <= ends[-1]])


UNIT: dict[str, Shape] = {
    "power_law": rm.PowerLaw(exponent=2.7, width=1.0, rise=1.0),
    "truncated_cone": rm.TruncatedCone(slope=1.0, flat_radius=1.0),
    "rounded_punch": rm.RoundedPunch(flat_radius=1.0, edge_radius=1.0),
}


@pytest.mark.few(4)
@pytest.mark.parametrize("name", UNIT)
@pytest.mark.parametrize("a", [1.0 + 1e-10, 1.5, 3e4])
def test_a_twin_with_many_digits(name: str, a: float) -> None:
    twin, between = Twin(name), 1.0 + 0.4 * (a - 1.0)
    r = [0.5, 1.0 - 1e-13, 1.0 + 3e-16, between, a * (1.0 - 1e-12)]
    r = [value for value in r if 0.0 < value < a]
    with mpmath.mp.workdps(30):
        expected = np.array([float(twin.pressure(value, a)) for value in r])
        sunk = np.array([float(twin.displacement(value * a, a)) for value in (1.0 + 1e-12, 1.3, 1e4)])
    p = rm.pressure(UNIT[name], r=r, contact_radius=a, effective_modulus=math.pi).to_numpy()
    np.testing.assert_allclose(p, expected, rtol=2e-12, atol=1e-13 * np.abs(expected).max())
    u = rm.surface_displacement(
        UNIT[name], r=a * np.array([1.0 + 1e-12, 1.3, 1e4]), contact_radius=a, effective_modulus=1.0
    )
    np.testing.assert_allclose(0.5 * math.pi * u, sunk, rtol=2e-12)


@pytest.mark.few(12)
@every_shape
@every_work
def test_far_away_the_contact_is_a_force(name: str, work: float) -> None:
    shape, depth = SHAPES[name]
    state = rm.indent(shape, effective_modulus=E, work=work, indentation=depth)
    a = float(state.contact_radius)
    far = rm.surface_displacement(shape, r=1e8 * a, indentation=depth, effective_modulus=E, work=work)
    assert math.pi * E * 1e8 * a * float(far) == pytest.approx(float(state.force), rel=1e-12)
    deep = rm.axis_stress(shape, z=1e8 * a, indentation=depth, effective_modulus=E, work=work, poisson=NU)
    expected = -3.0 * float(state.force) / (2.0 * math.pi * (1e8 * a) ** 2)
    assert float(deep.sigma_zz) == pytest.approx(expected, rel=1e-12)


@large_where_compiled
@every_work
@pytest.mark.parametrize("unit", [2.0**-30, 2.0**30])
def test_the_unit_of_length_does_not_matter(work: float, unit: float) -> None:
    for name in ("truncated_cone", "rounded_punch", "capped_paraboloid"):
        shape = SHAPES[name][0]
        lengths = {key: value if key == "slope" else unit * value for key, value in shape.parameters.items()}
        other = type(shape)(**lengths)
        a = 1.5e-6
        r = np.array([0.0, 3e-7, 1.2e-6])
        p = rm.pressure(shape, r=r, contact_radius=a, effective_modulus=E, work=work)
        scaled = rm.pressure(
            other, r=unit * r, contact_radius=unit * a, effective_modulus=8.0 * E, work=8.0 * unit * work
        )
        np.testing.assert_allclose(scaled, 8.0 * p, rtol=1e-13)
        u = rm.surface_displacement(shape, r=3 * r, contact_radius=a, effective_modulus=E, work=work)
        sunk = rm.surface_displacement(
            other, r=3 * unit * r, contact_radius=unit * a, effective_modulus=E, work=unit * work
        )
        np.testing.assert_allclose(sunk, unit * u, rtol=1e-13)


@large_where_compiled
@settings(deadline=None, max_examples=40)
@given(
    log_flat=st.floats(-9.0, 0.0),
    ratio=st.floats(1e-12, 1e3),
    log_work=st.floats(-6.0, 1.0),
    at=st.floats(1.0 + 1e-9, 1e6),
)
def test_displacements_outside_lie_between_those_of_the_edge_and_of_a_force(
    log_flat: float, ratio: float, log_work: float, at: float
) -> None:
    flat = 10.0**log_flat
    shape, a = rm.TruncatedCone(slope=0.1, flat_radius=flat), flat * (1.0 + ratio)
    u = rm.surface_displacement(
        shape, r=[a, at * a, 1e9 * a], contact_radius=a, effective_modulus=E, work=0.0
    ).to_numpy()
    assert u[0] >= u[1] >= u[2] > 0.0
    state = rm.indent(shape, effective_modulus=E, contact_radius=a)
    assert u[2] == pytest.approx(float(state.force) / (math.pi * E * 1e9 * a), rel=1e-11)


def largest_on_a_grid(shape: Shape, nu: float, **given: Any) -> float:
    """Over depths from 1e-9 to 30 contact radii, a grid."""
    a = float(rm.indent(shape, effective_modulus=E, **given).contact_radius)
    z = a * np.geomspace(1e-8, 30.0, 160)
    return float(rm.axis_stress(shape, z=z, effective_modulus=E, poisson=nu, **given).shear.max())


@large_where_compiled
@pytest.mark.few(1)
@pytest.mark.parametrize("nu", [-0.9, 0.0, 0.5])
@pytest.mark.parametrize("work", [0.0, WORK, 1.0])
def test_the_largest_shear_is_the_largest_of_all_depths(nu: float, work: float) -> None:
    for shape in (rm.Paraboloid(radius=R), rm.PowerLaw(exponent=1.15, width=1e-6, rise=1e-7)):
        given = {"indentation": 1e-8, "work": work}
        found = rm.axis_stress(shape, z=1e-7, effective_modulus=E, poisson=nu, **given)
        seen = largest_on_a_grid(shape, nu, **given)
        assert seen <= float(found.largest_shear) * (1.0 + 1e-12)
        if float(found.largest_shear_depth) > 0.0:
            assert seen >= float(found.largest_shear) * (1.0 - 3e-3)


@large_where_compiled
def test_the_shear_below_a_sharp_tip_has_no_largest_value() -> None:
    for shape in (rm.Cone(slope=0.1), SHAPES["blunt power_law"][0], SHAPES["power_series"][0], SHAPES["tabulated"][0]):
        found = rm.axis_stress(shape, z=[1e-9, 1e-90], contact_radius=A, effective_modulus=E, poisson=NU)
        assert set(found.data_vars) == {"sigma_zz", "sigma_rr", "shear"}
        assert found.shear[1] > found.shear[0]


@large_where_compiled
def test_out_of_contact_nothing_is_pressed() -> None:
    for shape, _ in SHAPES.values():
        for control in ({"indentation": -1e-6}, {"indentation": -1e-6, "work": WORK}, {"contact_radius": 0.0}):
            if "contact_radius" in control and isinstance(shape, rm.FlatPunch):
                continue
            r = np.array([0.0, 1e-7])
            assert not rm.pressure(shape, r=r, effective_modulus=E, **control).any()
            assert not rm.surface_displacement(shape, r=r, effective_modulus=E, **control).any()
            found = rm.axis_stress(shape, z=r, effective_modulus=E, poisson=NU, **control)
            assert not any(found[name].any() for name in ("sigma_zz", "sigma_rr", "shear", "largest_shear"))


def test_what_goes_in_and_comes_out() -> None:
    shape = rm.Paraboloid(radius=R)
    r = np.array([3e-7, 0.0, 2e-6, 1e-6])
    for field, unit in ((rm.pressure, "Pa"), (rm.surface_displacement, "m")):
        found = field(shape, r=r, contact_radius=A, effective_modulus=E)
        assert (found.name, found.dims, found.attrs["units"]) == (field.__name__, ("r",), unit)
        np.testing.assert_array_equal(found.r, r)
        for i, value in enumerate(r):
            one = field(shape, r=value, contact_radius=A, effective_modulus=E)
            assert one.dims == ()
            assert float(one) == float(found[i])
        assert field(shape, r=[], contact_radius=A, effective_modulus=E).sizes == {"r": 0}
    stress = rm.axis_stress(shape, z=r, contact_radius=A, effective_modulus=E, poisson=NU)
    assert {name: stress[name].dims for name in stress.data_vars} == {
        "sigma_zz": ("z",),
        "sigma_rr": ("z",),
        "shear": ("z",),
        "largest_shear": (),
        "largest_shear_depth": (),
    }
    assert rm.axis_stress(shape, z=0.0, contact_radius=A, effective_modulus=E, poisson=NU).sigma_zz.dims == ()
    with pytest.warns(rm.LimitWarning, match="slopes of up to 1") as caught:
        steep = rm.pressure(rm.Cone(slope=1.0), r=1e-7, contact_radius=A, effective_modulus=E)
    assert caught[0].filename == __file__
    assert "slopes" in steep.attrs["warnings"]


SINGULAR: list[tuple[str, dict[str, Any], float, str]] = [
    ("paraboloid", {"contact_radius": A, "work": WORK}, A, "edge of the contact"),
    ("flat_punch", {"indentation": 1e-8}, A, "edge of the contact"),
    ("cone", {"contact_radius": A}, 0.0, "sharp tip"),
    ("blunt power_law", {"contact_radius": A}, 0.0, "sharp tip"),
    ("power_series", {"contact_radius": A}, 0.0, "sharp tip"),
    ("tabulated", {"contact_radius": A}, 0.0, "sharp tip"),
    ("truncated_cone", {"contact_radius": A}, 7e-7, "corner"),
    ("truncated_paraboloid", {"contact_radius": A}, 7e-7, "corner"),
    ("capped_paraboloid", {"contact_radius": A}, 5e-7, "corner"),
]


@pytest.mark.parametrize(("name", "given", "r", "place"), SINGULAR)
def test_no_pressure_where_it_is_infinite(name: str, given: dict[str, Any], r: float, place: str) -> None:
    shape = SHAPES[name][0]
    with pytest.raises(rm.OutOfRange, match=re.escape(f"r is {r:g} m, the {place}").replace("the", "(the|a)")):
        rm.pressure(shape, r=[1e-8, r], effective_modulus=E, **given)
    beside = rm.pressure(
        shape, r=[np.nextafter(r, 0.0), np.nextafter(r, 1.0)] if r else [1e-300], effective_modulus=E, **given
    )
    assert np.isfinite(beside).all()
    assert np.isfinite(rm.surface_displacement(shape, r=r, effective_modulus=E, **given))
    if r == 0.0:
        with pytest.raises(rm.OutOfRange, match=r"z is 0 m, the sharp tip"):
            rm.axis_stress(shape, z=[1e-7, 0.0], effective_modulus=E, poisson=NU, **given)


@large_where_compiled
def test_pressures_that_are_finite() -> None:
    edge = rm.pressure(rm.Paraboloid(radius=R), r=A, contact_radius=A, effective_modulus=E)
    assert float(edge) == 0.0
    for name, r in (("rounded_cone", 3e-7), ("rounded_punch", 5e-7), ("tabulated", 9e-7)):
        p = rm.pressure(
            SHAPES[name][0], r=r * np.array([1.0 - 1e-9, 1.0, 1.0 + 1e-9]), contact_radius=A, effective_modulus=E
        )
        np.testing.assert_allclose(p, p[1], rtol=1e-6)
    even = rm.CappedParaboloid(radius=R, cap_radius=R, blend_radius=5e-7)
    p = rm.pressure(even, r=[0.0, 5e-7], contact_radius=A, effective_modulus=E)
    np.testing.assert_allclose(p, 2.0 * E / (math.pi * R) * np.sqrt(A**2 - np.array([0.0, 5e-7]) ** 2), rtol=1e-13)
    blunt = rm.PowerLaw(exponent=1.02, width=1.0, rise=0.1)
    p0 = rm.pressure(blunt, r=[0.0, 1e-300], contact_radius=A, effective_modulus=E)
    kappa_c = float(blunt.g(A)) / A
    assert float(p0[0]) == pytest.approx(E / math.pi * 1.02 / 0.02 * kappa_c, rel=1e-12)
    smooth = rm.Tabulated(r=R_TABLE, f=R_TABLE**2 / (2.0 * R))
    p0 = rm.pressure(smooth, r=[0.0, 1e-12], contact_radius=A, effective_modulus=E)
    np.testing.assert_allclose(p0, 2.0 * E * A / (math.pi * R), rtol=1e-9)


REFUSED: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({}, rm.RoughmdrError, "got none; a field takes exactly one of contact_radius, indentation"),
    ({"contact_radius": A, "indentation": 0.0}, rm.RoughmdrError, "got contact_radius and indentation"),
    ({"contact_radius": [A, A]}, rm.OutOfRange, "contact_radius has 1 dimensions; it must be one number"),
    ({"contact_radius": -A}, rm.OutOfRange, "contact_radius is -1e-06 m; it must be at least 0"),
    ({"contact_radius": math.nan}, rm.OutOfRange, "contact_radius is nan; it must be finite"),
    ({"contact_radius": A, "r": -1.0}, rm.OutOfRange, "r is -1 m; it must be finite and at least 0"),
    ({"contact_radius": A, "r": [[0.0]]}, rm.OutOfRange, "r has 2 dimensions"),
    ({"contact_radius": A, "r": "far"}, rm.OutOfRange, "r is 'far': expected a number in m"),
    ({"contact_radius": A, "effective_modulus": 0.0}, rm.OutOfRange, "modulus is 0 Pa"),
    ({"contact_radius": A, "work": -1.0}, rm.OutOfRange, "work is -1 J/m"),
    ({"contact_radius": A, "shape": rm.FlatPunch(radius=A)}, rm.ShapeError, "does not determine the state"),
    ({"contact_radius": A, "shape": "cone"}, rm.ShapeError, "shape is 'cone'"),
    ({"indentation": 1e-4, "shape": rm.Sphere(radius=R)}, rm.OutOfRange, "needs more digits than a float has"),
]


@pytest.mark.parametrize(("given", "error", "message"), REFUSED)
@pytest.mark.parametrize("field", [rm.pressure, rm.surface_displacement], ids=lambda field: field.__name__)
def test_what_is_refused(field: Any, given: dict[str, Any], error: type[Exception], message: str) -> None:
    r = 2.0 * R if field is rm.surface_displacement else 0.0
    with pytest.raises(error, match=re.escape(message)):
        field(**{"shape": rm.Paraboloid(radius=R), "r": r, "effective_modulus": E, **given})


@pytest.mark.parametrize("poisson", [-1.0, 0.51, math.nan, [0.3], "0.3x"])
def test_impossible_ratios_are_refused(poisson: Any) -> None:
    with pytest.raises(rm.OutOfRange, match="poisson"):
        rm.axis_stress(rm.Paraboloid(radius=R), z=0.0, contact_radius=A, effective_modulus=E, poisson=poisson)


def test_the_elliptic_integral_of_the_tests_is_the_one_of_scipy() -> None:
    assert ellipkm1(0.3) == pytest.approx(ellipk(0.7), rel=1e-15)
