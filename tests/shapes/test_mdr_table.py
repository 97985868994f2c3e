"""Profiles that are given by their MDR profile: against closed forms, their own integrals, and the equations of JKR and
Dugdale, one by one.
"""

import math
from itertools import pairwise
from typing import Any

import numba
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad

import roughmdr as rm
from roughmdr.numerics.arguments import Floats

E, W = 3e6, 0.05
UNITS = [1.0, 1e-6]


def table(seed: int, unit: float = 1.0, points: int = 12) -> rm.MdrTable:
    """A table of rises of any size."""
    rng = np.random.default_rng(seed)
    a, g = (np.cumsum(10.0 ** rng.uniform(-1.5, 0.0, points)) for _ in range(2))
    return rm.MdrTable(a=unit * a, g=0.1 * unit * g)


def between(shape: rm.MdrTable, end: float) -> Floats:
    """The radii of a table below an end, as breaks of integrals."""
    return shape.radii[shape.radii < end]


def integral(function: Any, shape: rm.MdrTable, begin: float, end: float) -> float:
    """An integral, piece by piece."""
    edges = [begin, *(x for x in between(shape, end) if x > begin), end]
    parts = [quad(function, low, high, epsabs=0.0, epsrel=1e-12)[0] for low, high in pairwise(edges)]
    return math.fsum(parts)


def f_of_g(shape: rm.MdrTable, r: float) -> float:
    """f = 2/pi ∫ g(x)/sqrt(r^2 - x^2) dx, the inverse of (H 17)."""
    breaks = [float(np.arcsin(x / r)) for x in between(shape, r)]
    edges = [0.0, *breaks, 0.5 * math.pi]
    parts = [
        quad(lambda v: float(shape.g(r * math.sin(v))), low, high, epsabs=0.0, epsrel=1e-12)[0]
        for low, high in pairwise(edges)
    ]
    return 2.0 / math.pi * math.fsum(parts)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("count", [1, 2, 15])
def test_a_table_of_a_paraboloid_is_the_paraboloid(unit: float, count: int) -> None:
    a, x = unit * np.geomspace(0.1, 3.0, count), unit * np.array([1e-9, 0.05, 0.7, 2.9, 40.0])
    true, shape = rm.Paraboloid(radius=7.0 * unit), rm.MdrTable(a=a, g=a * a / (7.0 * unit))
    for name in ("f", "df", "g", "G"):
        np.testing.assert_allclose(getattr(shape, name)(x), getattr(true, name)(x), rtol=1e-14)


@pytest.mark.parametrize("law", [{}, {"work": W}, {"work": W, "adhesion": "dugdale", "strength": 2e5}], ids=str)
def test_contacts_of_a_paraboloid_are_those_of_its_table(law: dict[str, Any]) -> None:
    a = np.geomspace(1e-7, 4e-6, 12)
    true, shape = rm.Paraboloid(radius=2e-5), rm.MdrTable(a=a, g=a * a / 2e-5)
    depth = np.array([-1e-7, 1e-9, 3e-8, 4e-7])
    one, other = (rm.indent(s, effective_modulus=E, indentation=depth, **law) for s in (shape, true))
    scale = float(abs(other.force).max())
    np.testing.assert_allclose(one.force, other.force, rtol=1e-12, atol=1e-13 * scale)
    np.testing.assert_allclose(one.contact_radius, other.contact_radius, rtol=1e-12)


# Uncompiled a table takes a tenth of a second.
@settings(deadline=None, max_examples=12 if numba.config.DISABLE_JIT else 40)
@given(seed=st.integers(0, 10**6), points=st.integers(1, 20), unit=st.sampled_from(UNITS))
def test_the_profile_rises_through_its_points(seed: int, points: int, unit: float) -> None:
    shape = table(seed, unit, points)
    np.testing.assert_allclose(shape.g(shape.radii), shape.indentations, rtol=1e-14)
    x = np.sort(np.random.default_rng(seed).uniform(0.0, 1.5 * shape.radii[-1], 200))
    for values in (shape.g(x), shape.f(x), shape.G(x)):
        assert (np.diff(values) >= -1e-15 * values[-1]).all()


@pytest.mark.few(2)
@pytest.mark.parametrize("seed", range(4))
def test_f_g_and_G_are_integrals_of_each_other(seed: int) -> None:
    shape = table(seed)
    for x in np.array([0.05, 0.4, 0.9, 1.6]) * shape.radii[-1]:
        assert float(shape.f(x)) == pytest.approx(f_of_g(shape, x), rel=1e-11)
        assert float(shape.G(x)) == pytest.approx(integral(lambda y: float(shape.g(y)), shape, 0.0, x), rel=1e-11)
        step = 1e-6 * x
        assert float(shape.df(x)) == pytest.approx(
            float(np.diff(shape.f([x - step, x + step]))[0]) / (2 * step), rel=1e-6
        )
        # (H 17), with the substitution r = x sin v: f' begins like a root at each point, so that quad does what it can.
        breaks = [float(np.arcsin(y / x)) for y in between(shape, x)]
        back = (
            x
            * quad(
                lambda v, x=x: float(shape.df(x * math.sin(v))), 0.0, 0.5 * math.pi, points=breaks or None, limit=400
            )[0]
        )
        assert back == pytest.approx(float(shape.g(x)), rel=1e-7)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("seed", range(5))
def test_contacts_with_adhesion_are_stable_equilibria(seed: int, unit: float) -> None:
    """delta = g - dl, P = 2 E* (a g - G - a dl), and the last stable contact of a retraction comes before the fold."""
    shape = table(seed, unit)
    work = 0.003 * E * float(shape.indentations[-1]) ** 2 / float(shape.radii[-1])
    off = float(rm.pull_off(shape, effective_modulus=E, work=work, control="displacement").indentation)
    depth = np.concatenate(
        [off * np.array([1.0 - 1e-6, 0.7, 0.2]), float(shape.indentations[-1]) * np.array([0.01, 0.3, 2.0])]
    )
    found = rm.indent(shape, effective_modulus=E, work=work, indentation=depth)
    a = found.contact_radius.values
    stretch = np.sqrt(2.0 * math.pi * a * work / E)
    scale = np.maximum(np.abs(depth), -off)
    assert (np.abs(shape.g(a) - stretch - depth) <= 1e-12 * scale).all()
    force = 2.0 * E * (a * shape.g(a) - shape.G(a) - a * stretch)
    np.testing.assert_allclose(found.force, force, rtol=1e-11, atol=1e-12 * float(abs(force).max()))
    lower = np.geomspace(1e-5, 3.0, 30000) * shape.radii[-1]
    least = float(np.min(shape.g(lower) - np.sqrt(2.0 * math.pi * lower * work / E)))
    assert off == pytest.approx(least, rel=1e-5)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("tabor", [0.5, 3.0])
def test_contacts_with_adhesion_of_a_range_obey_its_equations(seed: int, tabor: float) -> None:
    """delta, P and the gap at the edge of the zone, from integrals over g alone."""
    shape = table(seed, 1e-6, 5)
    size, depth = float(shape.radii[-1]), float(shape.indentations[-1])
    work = 0.01 * E * depth**2 / size
    strength = tabor * math.pi ** (2.0 / 3.0) * work / math.sqrt(2.0 * math.pi * 0.5 * size * work / E)
    found = rm.indent(
        shape,
        effective_modulus=E,
        work=work,
        adhesion="dugdale",
        strength=strength,
        indentation=depth * np.array([0.1, 0.8]),
    )
    for each in found.transpose("indentation").isel(indentation=[0, 1]).indentation.values:
        state = found.sel(indentation=each)
        a, c = float(state.contact_radius), float(state.cohesive_radius)
        assert 0.0 < a < c
        beta = 2.0 * strength / E
        assert float(shape.g(a)) - beta * math.sqrt(c * c - a * a) == pytest.approx(each, rel=1e-9, abs=1e-10 * depth)
        pressed = integral(lambda x, d=each: d - float(shape.g(x)), shape, 0.0, a)
        width = math.sqrt(c * c - a * a)
        pulled = -beta * (0.25 * math.pi * c * c - 0.5 * (a * width + c * c * math.asin(a / c)))
        assert float(state.force) == pytest.approx(2.0 * E * (pressed + pulled), rel=1e-9)
        inside = integral(lambda x, d=each, c=c: (d - float(shape.g(x))) / math.sqrt(c * c - x * x), shape, 0.0, a)
        gap = f_of_g(shape, c) - each + 2.0 / math.pi * (inside - beta * (c - a))
        assert strength * gap == pytest.approx(work, rel=1e-8)


@pytest.mark.parametrize("work", [0.0, 2e-3])
def test_work_is_the_change_of_the_energy(work: float) -> None:
    """Beside its table, an asperity alone in an ensemble: the force is -dU/dh."""
    shape = table(2, 1e-6)
    h = -np.array([0.02, 0.2, 0.9])[:, None] * shape.indentations[-1] * (1.0 + 1e-4 * np.array([-1.0, 0.0, 1.0]))
    law = rm.load_separation(
        alike([0.0], shape), separation=h.ravel(), effective_modulus=E, work=work, variables=("force", "energy")
    )
    energy, force = (law[name].values.reshape(h.shape) for name in ("energy", "force"))
    np.testing.assert_allclose(-(energy[:, 2] - energy[:, 0]) / (h[:, 2] - h[:, 0]), force[:, 1], rtol=1e-6)


def alike(height: Any, *shapes: rm.MdrTable, **positions: Any) -> xr.Dataset:
    """An ensemble of asperities with a table each."""
    columns = {
        "a": (("asperity", "point"), [shape.radii for shape in shapes]),
        "g": (("asperity", "point"), [shape.indentations for shape in shapes]),
    }
    at = {name: ("asperity", values) for name, values in positions.items()}
    return xr.Dataset({"height": ("asperity", height), **columns, **at}, attrs={"shape": "mdr_table", "patch": 0.1})


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="Python floats raise where compiled ones are NaN")
@pytest.mark.parametrize("work", [0.0, 0.02])
def test_each_asperity_of_an_ensemble_has_its_own_table(work: float, tmp_path: Any) -> None:
    shapes = [table(seed, 1e-6) for seed in range(300)]  # more than a block
    height = np.random.default_rng(1).normal(0.0, 3e-7, 300)
    rough = alike(height, *shapes)
    h = np.array([-5e-6, -2e-7, 2e-7])  # a retraction from where all are in contact
    law = rm.load_separation(rough, separation=h, effective_modulus=E, work=work)
    for step in (1, 2):
        pressed = zip(shapes, height - h[step], strict=True)
        found = [rm.indent(s, effective_modulus=E, work=work, indentation=d) for s, d in pressed]
        assert float(law.force[step]) == pytest.approx(math.fsum(float(each.force) for each in found), rel=1e-11)
        assert float(law.contact_count[step]) == sum(float(each.contact_radius) > 0.0 for each in found)
    rough.to_netcdf(tmp_path / "tables.nc")
    read = rm.generate({"source": "file", "file": str(tmp_path / "tables.nc")}, seed=0)
    again = rm.load_separation(read, separation=h, effective_modulus=E, work=work)
    xr.testing.assert_identical(again.force, law.force)


@pytest.mark.few(1)
@pytest.mark.parametrize("work", [0.0, 0.02])
def test_coupled_tables_of_paraboloids_are_coupled_paraboloids(work: float) -> None:
    rng = np.random.default_rng(3)
    radius, height = rng.uniform(1e-5, 4e-5, 9), rng.normal(0.0, 3e-7, 9)
    at = {name: rng.uniform(0.0, 1e-4, 9) for name in "xy"}
    radii = np.geomspace(1e-7, 4e-6, 10)
    tables = alike(height, *(rm.MdrTable(radii, radii**2 / r) for r in radius), **at)
    tips = xr.Dataset(
        {"height": ("asperity", height), "radius": ("asperity", radius), **{k: ("asperity", v) for k, v in at.items()}},
        attrs={"shape": "paraboloid", "patch": 0.1},
    )
    h = np.linspace(5e-7, -2e-7, 6)
    one, other = (
        rm.load_separation(e, separation=h, effective_modulus=E, work=work, unload=work > 0.0, interaction="pairwise")
        for e in (tables, tips)
    )
    np.testing.assert_allclose(one.force, other.force, rtol=1e-9, atol=1e-12 * float(abs(other.force).max()))


@pytest.mark.parametrize(
    ("a", "g", "says"),
    [
        ([1.0, 2.0], [1.0], "a holds 2 numbers and g 1"),
        ([], [], r"a has the shape \(0,\); it must be a row of at least 1"),
        ([1.0, math.nan], [1.0, 2.0], r"a\[1\] is nan; it must be finite"),
        ([0.0, 1.0], [1.0, 2.0], r"a\[0\] is 0 m; a must rise"),
        ([1.0, 2.0], [2.0, 2.0], r"g\[1\] is 2 m after 2 m; g must rise"),
        ([{}], [1.0], "it must be a list of numbers"),
        (["x"], [1.0], "a is 'x': expected a number in m or a string like"),
        ([1e-120], [1.0], "between 1e-100 and 1e100"),
    ],
)
def test_what_is_no_table_is_refused(a: Any, g: Any, says: str) -> None:
    with pytest.raises(rm.ShapeError, match=says):
        rm.MdrTable(a=a, g=g)


def test_a_wrong_table_in_an_ensemble_is_named() -> None:
    good = table(1, 1e-6, 3)
    rough = alike([0.0, 1e-7], good, good)
    rough["g"][1, 1] = 0.0
    with pytest.raises(rm.SceneError, match=r"mdr_table: g\[1\] is 0 m after .* at asperity 1"):
        rm.load_separation(rough, separation=[0.0], effective_modulus=E)
    with pytest.raises(rm.SceneError, match=r"a lies over \('point',\); it must lie over \('asperity', 'point'\)"):
        rm.load_separation(rough.assign(a=rough.a[0]), separation=[0.0], effective_modulus=E)
