"""Partial slip against Mindlin's closed forms, rows of sliding springs, and the energy that a loop loses."""

import math

import numpy as np
import pytest
from forms import large
from hypothesis import given, settings, strategies as st
from oracles.multiprecision import mp
from twins.sliding_springs import follow

from roughmdr import OutOfRange
from roughmdr.aggregate import LoadingPath, LoadSeparation, simulate
from roughmdr.aggregate.problem import Problem
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.masing import Masing
from roughmdr.loading.pull_off import WITHOUT_TENSION
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.material import dundurs_beta, stiffness_ratio
from roughmdr.stages.slip import FirstCurve, SlipConstants, partial_slip

E, RATIO, MU = 4e9, 0.8, 0.3
FORCE, STIFFNESS, LOSS = "tangential_force", "tangential_stiffness", "friction_energy"
UNITS = ((1e-9, 1e3), (1e-6, 4e9), (1.0, 1e12))  # lengths [m] and E* [Pa]


def law_of(
    asperities: Ensemble, u: Floats, *names: str, h: float = 0.0, mu: float = MU, modulus: float = E
) -> list[Floats]:
    """Variables of an ensemble along a lateral path."""

    def normal(separation: Floats, names: list[str]) -> LoadSeparation:
        path = LoadingPath.along(separation, unload=False, adhesive=False)
        return simulate(Problem(asperities, modulus, Adhesion()), path, names)

    found = partial_slip(normal, h, Masing.along(u), SlipConstants(modulus, RATIO, mu), list(names))
    return [found.variables[name] for name in names]


def sphere(indentation: float, radius: float) -> Ensemble:
    return Ensemble("paraboloid", np.array([indentation]), {"radius": np.array([radius])})


def rough(length: float = 1e-6) -> Ensemble:
    rng = np.random.default_rng(5)
    heights = -np.sort(-rng.normal(0.0, length, 30))  # from the highest, in an array like all others
    return Ensemble("paraboloid", heights, {"radius": rng.uniform(20.0, 80.0, 30) * length})


@pytest.mark.parametrize(("length", "modulus"), UNITS)
def test_a_sphere_is_mindlins(length: float, modulus: float) -> None:
    """T/(mu P) = 1 - (1 - u/u_max)^(3/2), and full slip beyond u_max = mu (E*/G*) delta."""
    delta, radius = length, 50.0 * length
    most = MU / RATIO * delta
    u = np.linspace(0.0, 1.3 * most, 201)
    force, stiffness = law_of(sphere(delta, radius), u, FORCE, STIFFNESS, modulus=modulus)
    stick = np.sqrt(np.maximum(1.0 - u / most, 0.0))
    load = 4.0 / 3.0 * modulus * math.sqrt(radius * delta) * delta
    np.testing.assert_allclose(force / (MU * load), 1.0 - stick**3, rtol=0.0, atol=1e-12)
    sticking = 2.0 * RATIO * modulus * math.sqrt(radius * delta)
    np.testing.assert_allclose(stiffness / sticking, stick, rtol=0.0, atol=1e-7)  # its square is right to 1e-14


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_the_loop_of_a_sphere_loses_what_mindlin_and_deresiewicz_found(share: float) -> None:
    """J. Appl. Mech. 20 (1953) 327; Johnson, Contact Mechanics, eq. 7.58, with 4/G* for the sum of (2 - nu)/G."""
    delta, radius = 1e-6, 5e-5
    most = MU / RATIO * delta
    end = most * (1.0 - (1.0 - share) ** (2.0 / 3.0))
    u = np.array([0.0, end, -end, end, -end, end])
    force, lost = law_of(sphere(delta, radius), u, FORCE, LOSS)
    a = math.sqrt(radius * delta)
    load = 4.0 / 3.0 * E * a * delta
    np.testing.assert_allclose(force, MU * load * share * np.array([0.0, 1.0, -1.0, 1.0, -1.0, 1.0]), rtol=1e-12)
    with mp.workdps(30):
        s = mp.mpf(share)
        brackets = 1 - (1 - s) ** (mp.mpf(5) / 3) - 5 * s / 6 * (1 + (1 - s) ** (mp.mpf(2) / 3))
        loop = float(18 * MU**2 * load**2 / (5 * a * RATIO * E) * brackets)
    np.testing.assert_allclose(np.diff(lost), loop * np.array([0.25, 0.5, 0.5, 0.5, 0.5]), atol=1e-13 * MU * load * end)
    assert lost[-1] == pytest.approx(2.25 * loop, rel=1e-9 if share > 0.1 else 1e-7)


def test_a_loop_loses_the_integral_of_its_force() -> None:
    """By Gauss's rule on each branch, which knows nothing of energies; no contact parts, so that T is smooth there."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    asperities = Ensemble("paraboloid", np.array([2.0, 1.5, 1.0]) * 1e-6, {"radius": np.array([3e-5, 5e-5, 8e-5])})
    end = 0.8 * MU / RATIO * 1e-6
    forward = end * nodes
    u = np.concatenate([0.5 * end * (1.0 + nodes), [end], -forward, [-end], forward, [end]])
    force, lost = law_of(asperities, u, FORCE, LOSS)
    (turn, low, last), count = np.array([1, 2, 3]) * (nodes.size + 1) - 1, nodes.size
    down, up = force[turn + 1 : turn + 1 + count], force[low + 1 : low + 1 + count]
    loop = end * float(weights @ (up - down))
    assert lost[last] - lost[turn] == pytest.approx(loop, rel=1e-10)
    work = 0.5 * end * float(weights @ force[:count])
    assert 0.0 < lost[turn] < work
    assert lost[turn] == pytest.approx(0.25 * loop, rel=1e-10)


@settings(deadline=None, max_examples=20)
@given(steps=st.lists(st.integers(-30, 30), min_size=1, max_size=20))
def test_any_path_is_that_of_sliding_springs(steps: list[int]) -> None:
    """Which converge to it: the error falls as the square of their length, but at the edge of contact and of slip."""
    asperities, h = rough(), 0.5e-6
    u = np.array(steps, dtype=float) * 2e-8
    force, lost, load = law_of(asperities, u, FORCE, LOSS, "force", h=h) if any(steps) else (0.0 * u, 0.0 * u, 0.0 * u)
    touching = [
        (math.sqrt(radius * (z - h)), z - h, lambda x, radius=radius: x * x / radius)
        for z, radius in zip(asperities.height.tolist(), asperities.parameters["radius"].tolist(), strict=True)
        if z > h
    ]
    way = float(np.abs(np.diff(u, prepend=0.0)).sum()) + 1e-30
    errors = []
    for springs in (50, 400):
        slow, spent = follow(touching, u, moduli=(E, RATIO * E), friction=MU, springs=springs)
        scale = MU * float(load[0]) + 1e-30
        errors.append((np.abs(slow - force).max() / scale, np.abs(spent - lost).max() / (scale * way)))
    assert max(errors[1]) < 2e-4
    assert errors[1][0] <= max(0.2 * errors[0][0], 1e-6)


@pytest.mark.large
def test_nothing_is_lost_where_contacts_stick_or_slide_at_once() -> None:
    """Flat punches of one height: T = 2 G* b u up to mu F, then mu F, and no loss but the work of sliding."""
    radii = np.array([1e-6, 3e-6])
    punches = Ensemble("flat_punch", np.zeros(2), {"radius": radii})
    depth = 1e-8
    most = MU / RATIO * depth
    u = np.linspace(0.0, 2.0 * most, 9)
    force, lost = law_of(punches, u, FORCE, LOSS, h=-depth)
    sticking = 2.0 * RATIO * E * radii.sum()
    np.testing.assert_allclose(force, sticking * np.minimum(u, most), rtol=1e-12)
    np.testing.assert_allclose(lost, sticking * most * np.maximum(u - most, 0.0), atol=1e-13 * sticking * most * most)


@pytest.mark.parametrize("shape", ["paraboloid", large("cone")])
def test_with_much_friction_contacts_stick(shape: str) -> None:
    """T -> 2 G* a u, the sooner the more friction: the rest falls as its inverse."""
    parameter = {"paraboloid": {"radius": np.full(3, 5e-5)}, "cone": {"slope": np.full(3, 0.1)}}[shape]
    asperities = Ensemble(shape, np.array([3.0, 2.0, 1.0]) * 1e-6, parameter)
    u = np.array([1e-8])
    rest = []
    for mu in (1.0, 10.0, 100.0):
        force, radii = law_of(asperities, u, FORCE, "contact_radius_sum", mu=mu)
        rest.append(float(1.0 - force[0] / (2.0 * RATIO * E * radii[0] * u[0])))
    assert 0.0 < rest[2] < 1e-4
    np.testing.assert_allclose(np.divide(rest[:2], rest[1:]), 10.0, rtol=0.02)


def test_digits_that_rounding_takes_are_refused_or_right() -> None:
    assert law_of(sphere(1e-6, 5e-5), np.zeros(2), FORCE)[0].tolist() == [0.0, 0.0]
    with pytest.raises(OutOfRange, match="friction 1e\\+12 is so large, or the displacement so small"):
        law_of(sphere(1e-6, 5e-5), np.array([1e-9]), FORCE, mu=1e12)
    with pytest.raises(OutOfRange, match="not representable"):
        law_of(sphere(1e-6, 5e-5), np.array([1e300]), FORCE, mu=1e-300)
    (full,) = law_of(sphere(1e-6, 5e-5), np.array([1.0, -1.0]), FORCE, mu=1e-6)
    assert full[0] == -full[1] == pytest.approx(1e-6 * 4.0 / 3.0 * E * math.sqrt(5e-5) * 1e-9, rel=1e-14)


@settings(deadline=None)
@given(
    moduli=st.tuples(st.floats(1e-3, 1e15), st.floats(1e-3, 1e15)),
    poisson=st.tuples(st.floats(-0.999, 0.5), st.floats(-0.999, 0.5)),
)
def test_the_ratio_of_stiffnesses_is_that_of_its_definition(
    moduli: tuple[float, float], poisson: tuple[float, float]
) -> None:
    with mp.workdps(40):
        bodies = [(mp.mpf(e), mp.mpf(nu)) for e, nu in zip(moduli, poisson, strict=True)]
        shear = [e / (2 * (1 + nu)) for e, nu in bodies]
        normal = sum((1 - nu**2) / e for e, nu in bodies)
        lateral = sum((2 - nu) / (4 * g) for g, (_, nu) in zip(shear, bodies, strict=True))
        coupled, sums = (
            sum(sign * (1 - k * nu) / g for sign, g, (_, nu) in zip(signs, shear, bodies, strict=True))
            for k, signs in ((2, (1, -1)), (1, (1, 1)))
        )
        ratio, beta = float(normal / lateral), float(coupled / (2 * sums))
    given = (moduli[0], poisson[0], moduli[1], poisson[1])
    assert stiffness_ratio(*given) == pytest.approx(ratio, rel=1e-13)
    assert dundurs_beta(*given) == pytest.approx(beta, abs=1e-14)
    assert 2.0 / 3.0 - 1e-15 <= ratio <= 4.0 / 3.0 + 1e-15


def test_special_pairs_of_bodies() -> None:
    for nu in (-0.5, 0.0, 0.3, 0.5):
        assert stiffness_ratio(1e9, nu) == pytest.approx(2.0 * (1.0 - nu) / (2.0 - nu), rel=1e-15)
        assert stiffness_ratio(1e9, nu, 1e9, nu) == pytest.approx(stiffness_ratio(1e9, nu), rel=1e-15)
        assert dundurs_beta(1e9, nu, 1e9, nu) == 0.0
        assert dundurs_beta(1e9, nu) == pytest.approx((1.0 - 2.0 * nu) / (2.0 * (1.0 - nu)), rel=1e-15)


@pytest.mark.parametrize("unit", [1e-9, 1.0])
@pytest.mark.parametrize(
    ("force", "way", "fits"),
    [
        ([2.0, 2.0 - 1e-8], 1e-3, True),
        ([2.0, 2.0 - 1e-10], 1e-3, False),
        ([2.0, 2.0], 1e-3, False),
        ([2.0, 1.0], 1e-9, True),
        ([2.0, 1.0], 1e-11, False),
        ([2.0, 0.0], 1e-11, True),
        ([0.0, 0.0], 1e-11, True),
    ],
)
def test_six_digits_must_be_left_but_of_full_slip(force: list[float], way: float, fits: bool, unit: float) -> None:
    first = FirstCurve(
        {"force": unit * np.array(force)}, unit * np.array([1.0, 1.0 + way]), SlipConstants(E, RATIO, MU)
    )
    if fits:
        first.check_digits()
        return
    with pytest.raises(OutOfRange, match="less than six digits of the tangential force"):
        first.check_digits()


def test_a_lateral_path_has_no_pull_off() -> None:
    path = LoadingPath.along(np.array([0.0]), unload=False, adhesive=False)
    law = simulate(Problem(rough(), E, Adhesion()), path, ["force"])

    def normal(separation: Floats, names: list[str]) -> LoadSeparation:
        force = np.linspace(1.0, 0.0, separation.size)
        return law._replace(variables={"force": force}, pull_off=WITHOUT_TENSION)

    path = Masing.along(np.array([1e-6, 2e-6]))
    found = partial_slip(normal, 0.0, path, SlipConstants(E, RATIO, MU), [FORCE]).pull_off
    assert math.isnan(found.force)
