"""A curved body on a rough layer: half-space, Hertz, JKR, rigid bulk, a twin by ring kernels, units, properties."""

import math
from typing import Any

import numpy as np
import pytest
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import scene
from twins.curved_body import force_at

import roughmdr as rm
from roughmdr import expected
from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.ensemble import Source
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import read
from roughmdr.shapes import FlatPunch, Paraboloid, Shape, Sphere, TruncatedCone, TruncatedParaboloid
from roughmdr.stages import curved
from roughmdr.stages.curved.bulk import displacement_matrix, row_load
from roughmdr.stages.curved.law import pull_off_of
from roughmdr.stages.curved.refine import Layer, solve
from roughmdr.stages.curved.rings import Rings

EVERY = ["force", "contact_area", "contact_count", "contact_radius_sum", "stiffness", "nominal_contact_radius"]
E, R, STD, RADIUS, DENSITY = 1e9, 0.01, 1e-7, 2e-7, 1e12


def source(std: float = STD, radius: Any = RADIUS, density: float = DENSITY, **height: Any) -> Source:
    section = {
        "source": "random", "shape": "paraboloid", "density": density, "patch": 100.0 / math.sqrt(density),
        "height": {"distribution": "normal", "std": std, **height}, "radius": radius,
    }  # fmt: skip
    return read(scene(asperities=section, adhesion=None, path={"separation": [0.0]})).asperities


def law(
    separation: Floats, *, shape: Shape | None = None, modulus: float = E, work: float = 0.0, error: float = 1e-4,
    of: Source | None = None, unload: bool = False,
) -> LoadSeparation:  # fmt: skip
    layer = Layer(of or source(), modulus, Adhesion(work))
    path = LoadingPath.along(separation, unload=unload, adhesive=work > 0.0)
    return curved.compute(layer, shape or Paraboloid(radius=R), path, error=error, variables=EVERY)


def hertz_error(elements: int) -> tuple[float, float]:
    """Errors of u inside and outside Hertz's contact of radius 1, over the largest u, on equal elements."""
    rings = Rings.between(np.linspace(0.0, 2.0, elements + 1))
    r = rings.radius
    u = (displacement_matrix(rings, 1.0) * np.sqrt(np.maximum(1.0 - r * r, 0.0))).sum(axis=1)
    inside, outside = r[r < 0.8], r[r > 1.2]
    exact = 0.25 * math.pi * (2.0 - inside**2)
    beyond = 0.5 * ((2.0 - outside**2) * np.arcsin(1.0 / outside) + np.sqrt(outside**2 - 1.0))
    errors = (np.abs(u[r < 0.8] - exact).max(), np.abs(u[r > 1.2] - beyond).max())
    return errors[0] / exact.max(), errors[1] / exact.max()


def test_the_half_space_under_hertz_pressure_converges_inside_and_outside() -> None:
    coarse, fine = hertz_error(32), hertz_error(128)
    for before, after in zip(coarse, fine, strict=True):  # a pressure as sqrt(1 - r) has order 3/2
        assert after < 4.0**-1.4 * before
        assert after < 5e-4


def smooth_error(elements: int) -> float:
    """Error of u under p = exp(-2 r^2), whose q is sqrt(pi/2) exp(-2 x^2); u is by a Bessel function."""
    from scipy.special import ive

    rings = Rings.between(np.linspace(0.0, 4.0, elements + 1))
    r, modulus = rings.radius, 2.0
    p = np.exp(-2.0 * r * r)
    np.testing.assert_allclose(
        row_load(rings.radius) @ p, math.sqrt(0.5 * math.pi) * p, atol=0.2 * (8.0 / elements) ** 3
    )
    exact = math.sqrt(0.5 * math.pi) / modulus * ive(0, r * r)
    return float(np.abs((displacement_matrix(rings, modulus) * p).sum(axis=1) - exact).max() / exact[0])


def test_the_half_space_under_a_smooth_pressure_has_order_three_or_more() -> None:
    errors = [smooth_error(elements) for elements in (16, 32, 64)]
    assert errors[1] < errors[0] / 2.0**2.9
    assert errors[2] < errors[1] / 2.0**2.9


def test_the_load_of_the_springs_is_that_of_the_pressure() -> None:
    rings = Rings.between(np.linspace(0.0, 1.0, 40) ** 2)
    p = np.cos(3.0 * rings.radius) * (1.0 - rings.radius**2) ** 2  # of both signs
    along = 2.0 * float((row_load(rings.radius) @ p * rings.weights).sum())
    assert along == pytest.approx(float((rings.area_weights * p).sum()), rel=1e-4)


@pytest.mark.parametrize("sigmas", [2.0, large(0.5)])
def test_it_is_the_twin_by_ring_kernels(sigmas: float) -> None:
    found = law(np.array([5.0, sigmas]) * STD, error=1e-6)
    force, radius = force_at(sigmas * STD, R, E, RADIUS, STD, DENSITY, points=24)
    assert found.variables["force"][-1] == pytest.approx(force, rel=1e-6)
    assert found.variables["nominal_contact_radius"][-1] == pytest.approx(radius, rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("error", [1e-3, 1e-5])
def test_the_stated_error_holds(error: float) -> None:
    separation = np.linspace(4.0, -8.0, 7) * STD
    found, exact = law(separation, error=error), law(separation, error=1e-7)
    off = np.abs(found.variables["force"] - exact.variables["force"]).max() / exact.variables["force"].max()
    assert off <= found.numerical_error <= 2.0 * error


@pytest.mark.few(1)
@pytest.mark.parametrize("slope", [0.1, 0.5])
@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("tip", [1e-9, 2e-9, 3e-9])
def test_the_stated_error_holds_where_a_profile_has_a_kink(tip: float, slope: float, error: float) -> None:
    """p falls as exp(-s/m) under exponential heights of mean m; so small a body leaves the half-space flat."""
    mean, h = 1e-9, 5e-9
    section = {
        "source": "random", "shape": "paraboloid", "density": DENSITY, "patch": 1e-4,
        "height": {"distribution": "exponential", "scale": mean}, "radius": 1e-7,
    }  # fmt: skip
    of = read(scene(asperities=section, adhesion=None, path={"separation": [0.0]})).asperities
    pressure = DENSITY * 4.0 / 3.0 * E * math.sqrt(1e-7) * math.gamma(2.5) * mean**1.5 * math.exp(-h / mean)
    width = mean / slope
    cone = pressure * math.pi * (tip**2 + 2.0 * (tip + width) * width)
    paraboloid = pressure * math.pi * (tip**2 + 2.0 * mean * 1e-8 / slope)
    bodies = {
        TruncatedCone(slope=slope, flat_radius=tip): cone,
        TruncatedParaboloid(radius=1e-8 / slope, flat_radius=tip): paraboloid,
    }
    for shape, exact in bodies.items():
        found = law(np.array([3.0 * h, h]), shape=shape, error=error, of=of)
        off = abs(float(found.variables["force"][-1]) / exact - 1.0)
        assert off <= found.numerical_error + 5e-6
        assert found.numerical_error <= 2.0 * error


@pytest.mark.large
def test_a_smooth_layer_is_hertz_to_the_first_order_of_its_roughness() -> None:
    approach, off = 1e-6, []
    for std in (1e-7, 1e-8, 1e-9):
        layer = source(std, 2.0 * std, 0.005 / std**2)
        found = {name: values[-1] for name, values in law(np.array([5.0 * std, -approach]), of=layer).variables.items()}
        radius = math.cbrt(3.0 * found["force"] * R / (4.0 * E))
        off.append(
            (
                found["force"] / (4.0 / 3.0 * E * math.sqrt(R) * approach**1.5) - 1.0,
                found["nominal_contact_radius"] / radius - 1.0,
                found["stiffness"] / (2.0 * E * radius) - 1.0,
            )
        )
    for first, second, third in zip(*off, strict=True):
        assert abs(first) < 0.1
        assert abs(second) < 0.2 * abs(first)
        assert abs(third) < 0.2 * abs(second)


def pressures(of: Source, s: Floats, modulus: float) -> Floats:
    path = LoadingPath.along(s[::-1], unload=False, adhesive=False)
    given: dict[str, Any] = {"effective_modulus": modulus, "adhesion": Adhesion(), "variables": ["pressure"]}
    return expected.compute(of, path, **given).variables["pressure"][::-1]


def test_a_rigid_bulk_bears_the_sum_of_its_asperities() -> None:
    of = source(1e-6, 1e-6, 1e7)  # so few that the half-space hardly gives way
    s = np.linspace(0.0, 1e-5, 2001)
    values = pressures(of, s, 1e9)
    simpson = np.full(s.size, 2.0)
    simpson[1::2], simpson[[0, -1]] = 4.0, 1.0
    rigid = 2.0 * math.pi * 1e-5 * float((values * simpson).sum()) * (s[1] - s[0]) / 3.0
    found = law(np.array([5e-6, 0.0]), shape=Paraboloid(radius=1e-5), of=of, error=1e-6)
    assert found.variables["force"][-1] == pytest.approx(rigid, rel=2e-3)


def test_a_wide_flat_punch_feels_the_flat_layer_and_its_own_half_space() -> None:
    """A punch much softer layer than bulk: F = p(h) pi b^2."""
    of, b = source(1e-6, 1e-6, 1e7), 1e-4
    found = law(np.array([5e-6, 0.0]), shape=FlatPunch(radius=b), of=of, error=1e-6)
    assert found.variables["force"][-1] == pytest.approx(math.pi * b * b * pressures(of, np.zeros(2), 1e9)[0], rel=0.02)


def test_the_stiffness_is_the_slope_of_the_force() -> None:
    h, step = -2.0 * STD, 1e-4 * STD
    for work in (0.0, 0.05):
        found = law(np.array([5.0 * STD, h + step, h, h - step]), work=work, error=1e-6, modulus=1e7)
        force, stiffness = found.variables["force"], found.variables["stiffness"]
        assert stiffness[2] == pytest.approx((force[3] - force[1]) / (2.0 * step), rel=1e-5)


@pytest.mark.large
@pytest.mark.parametrize(("alpha", "low", "high"), [(0.04, 0.93, 1.0), (1.0, 0.4, 0.75)])
@pytest.mark.parametrize("mu", [4.0, large(17.0)])
def test_the_peak_pressure_after_greenwood_and_tripp(alpha: float, low: float, high: float, mu: float) -> None:
    """Hertz's within 7 % where alpha = sigma R/a0^2 < 0.05, whatever mu is (K. L. Johnson, Contact Mechanics, 13.5)."""
    asperity = 1e-6
    of = source(STD, asperity, 3.0 * mu / (8.0 * STD * math.sqrt(2.0 * R * asperity)))
    layer = Layer(of, E, Adhesion())

    def at(h: float) -> tuple[float, float, float]:
        """alpha, p0 over Hertz's at equal load, and a* over Hertz's radius."""
        solution = solve(layer, Paraboloid(radius=R), np.array([5.0 * STD, h]), 1e-5)
        place = solution.places[-1]
        force = float(solution.body.force([place])[0])
        radius = math.cbrt(3.0 * force * R / (4.0 * E))
        peak = float(place.state.pressure[0]) / (1.5 * force / (math.pi * radius**2))
        return STD * R / radius**2, peak, solution.body.contact_radius(place) / radius

    begin, end = 3.0 * STD, -60.0 * STD
    for _ in range(30):
        middle = 0.5 * (begin + end)
        begin, end = (middle, end) if at(middle)[0] > alpha else (begin, middle)
    reached, peak, radius = at(end)
    assert reached == pytest.approx(alpha, rel=1e-2)
    assert low < peak < high
    assert 1.0 < radius < 2.5


def effective_work(modulus: float, deepest: float) -> float:
    """The work that tears the layer from the flat, down to which it has been pressed [J/m^2]."""
    s = np.linspace(deepest, 12.0 * STD, 4001)
    path = LoadingPath.along(s[::-1], unload=True, adhesive=True)
    given: dict[str, Any] = {"effective_modulus": modulus, "adhesion": Adhesion(0.05), "variables": ["pressure"]}
    tension = -expected.compute(source(), path, **given).variables["pressure"][s.size :]
    return float(np.maximum(tension, 0.0).sum() * (s[1] - s[0]))


@pytest.mark.large
def test_pull_off_lies_between_those_of_jkr_and_of_a_rigid_bulk() -> None:
    """-3/2 pi w R where the bulk is compliant over the range of the layer; w its own work of separation."""
    modulus, down = 1e6, np.linspace(20.0, -20.0, 30) * STD
    path = np.append(down, down[::-1])
    solution = solve(Layer(source(), modulus, Adhesion(0.05)), Paraboloid(radius=R), path, 1e-2)
    found = pull_off_of(solution.body, solution.places, path, 1e-2)
    work = effective_work(modulus, min(float(place.state.s.min()) for place in solution.places))
    assert -2.0 * math.pi * work * R < found.force < -1.4 * math.pi * work * R
    assert found.separation > STD


@pytest.mark.parametrize("work", [0.0, 0.05])
def test_a_drawn_radius_takes_few_nodes(work: float) -> None:
    """Gauss's rule as of a flat layer, whose pressure depends smoothly on the radius; and far fewer than its panels."""
    radius = {"distribution": "lognormal", "mean": RADIUS, "std": 0.1 * RADIUS}
    layer = Layer(source(radius=radius), E, Adhesion(work))
    solution = solve(layer, Paraboloid(radius=R), np.array([1.0, 0.0]) * STD, 1e-4)
    assert len(solution.body.half.law.nodes) <= 27
    assert solution.rule_error < 1e-6


@pytest.mark.large
def test_adhesion_has_hysteresis_and_detaches() -> None:
    found = law(np.linspace(6.0, -3.0, 25) * STD, modulus=1e7, work=0.05, error=1e-3, unload=True)
    force = found.variables["force"]
    loading, unloading = force[:25], force[25:][::-1]
    assert (unloading <= loading + 1e-3 * force.max()).all()
    assert found.pull_off.force <= force.min() < 0.0
    assert abs(force[-1]) < 1e-3 * abs(found.pull_off.force)
    assert (found.variables["nominal_contact_radius"] >= 0.0).all()


def test_unloading_with_adhesion_remembers_and_reloads_alike() -> None:
    """Until contacts are lost, a ring goes back and forth on one branch."""
    turn = np.array([5.0, 0.0, -1.0, -0.9, -1.0]) * STD
    force = law(turn, work=0.05, modulus=1e7, error=1e-3).variables["force"]
    assert force[4] == pytest.approx(force[2], rel=1e-9)


@pytest.mark.large
def test_roughness_lowers_pull_off() -> None:
    tension = []
    for std in (0.5e-7, 1e-7, 2e-7):
        path = np.linspace(8.0 * std, -3.0 * std, 20)
        tension.append(-law(path, of=source(std), modulus=1e7, work=0.05, error=1e-3, unload=True).pull_off.force)
    assert tension[0] > 2.0 * tension[1] > 4.0 * tension[2] > 0.0


def test_the_physics_does_not_depend_on_the_units() -> None:
    separation = np.array([4.0, 0.0, -5.0]) * STD
    here = law(separation, work=0.05)
    for length in (1e-3, 1e6):
        there = law(
            separation * length, shape=Paraboloid(radius=R * length), work=0.05 * length,
            of=source(STD * length, RADIUS * length, DENSITY / length**2),
        )  # fmt: skip
        np.testing.assert_allclose(there.variables["force"], length**2 * here.variables["force"], rtol=1e-9)
        np.testing.assert_allclose(there.variables["stiffness"], length * here.variables["stiffness"], rtol=1e-9)


def test_a_sphere_is_a_paraboloid_where_it_is_flat() -> None:
    separation = np.array([4.0, -2.0]) * STD
    sphere, paraboloid = law(separation, shape=Sphere(radius=R)), law(separation)
    np.testing.assert_allclose(sphere.variables["force"], paraboloid.variables["force"], rtol=1e-4)


def test_a_contact_beyond_the_end_of_a_sphere_is_refused() -> None:
    with pytest.raises(rm.OutOfRange, match="reaches the end of the sphere"):
        law(np.array([4.0, -1.0]) * STD, shape=Sphere(radius=STD))


def test_far_away_there_is_no_force() -> None:
    found = law(np.array([30.0, 20.0]) * STD)
    assert all((values == 0.0).all() for name, values in found.variables.items())
    assert found.numerical_error == 0.0


FAMILIES = [{"distribution": "normal"}, {"distribution": "uniform"}, {"distribution": "expon"}]


@pytest.mark.large
@settings(deadline=None, max_examples=25)
@given(
    st.sampled_from(FAMILIES),
    st.floats(-9.0, 0.0),
    st.floats(0.0, 6.0),
    st.floats(-3.0, 2.0),
    st.floats(-4.0, 3.0),
    st.floats(0.5, 200.0),
)
def test_the_force_is_finite_and_rises(
    family: dict[str, str], size: float, body: float, crowd: float, ratio: float, depth: float
) -> None:
    """Random layers without adhesion: force and area grow with approach, and the rings are at rest."""
    std = 10.0**size
    of = source(std, std * 10.0**ratio, 1e-2 * 10.0**crowd / (std * std * 10.0**ratio), **family)
    separation = std * np.linspace(5.0, -depth, 6)
    shape = Paraboloid(radius=std * 10.0 ** (body + 2.0))
    try:
        found = law(separation, shape=shape, of=of)
    except rm.OutOfRange:
        return  # too much contact for independent asperities
    for name in ("force", "contact_area", "contact_count", "stiffness"):
        values = found.variables[name]
        assert np.isfinite(values).all()
        assert (np.diff(values) >= -2e-4 * values.max()).all(), name
    solution = solve(Layer(of, E, Adhesion()), shape, separation, 1e-3)
    for place in solution.places:
        assert np.abs(place.state.residual).max() <= 1e-7 * std + 1e-13 * np.abs(place.state.s).max()
