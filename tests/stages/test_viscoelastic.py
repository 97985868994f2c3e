"""The viscoelastic law: known contacts, the slow twin in time, its elastic limits, and sums of single asperities."""

import math
from typing import Any

import numpy as np
import pytest
from forms import large
from hypothesis import given, settings, strategies as st
from twins.viscoelastic import Triangle

from roughmdr.aggregate import LoadingPath, LoadSeparation, simulate
from roughmdr.aggregate.problem import Problem
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.stages.viscoelasticity.law import Viscoelasticity, viscoelastic_law
from roughmdr.stages.viscoelasticity.motion import FlatMotion
from roughmdr.stages.viscoelasticity.relaxation import Relaxation

MODULUS, RADIUS, SLOPE, DEPTH = 4e6, 50e-6, 0.1, 1e-6
SPHERE = 4.0 / 3.0 * MODULUS * math.sqrt(RADIUS)  # F = this delta^(3/2)
CONE = 2.0 * MODULUS / (math.pi * SLOPE)  # F = this delta^2
NAMES = ["force", "contact_area", "contact_count"]


def asperities(heights: Any, shape: str = "paraboloid", **parameters: float) -> Ensemble:
    height = np.sort(np.atleast_1d(np.asarray(heights, dtype=float)))[::-1].copy()
    columns = {name: np.full(height.size, value) for name, value in (parameters or {"radius": RADIUS}).items()}
    return Ensemble(shape, height, columns)


def body(
    terms: list[tuple[float, float]], speed: float, back: float | None = None, dwell: float = 0.0
) -> Viscoelasticity:
    shares, times = (np.array(column) for column in zip(*terms, strict=True))
    return Viscoelasticity(Relaxation(shares, times), FlatMotion(speed, speed if back is None else back, dwell))


def law(ensemble: Ensemble, separation: Floats, of: Viscoelasticity, names: list[str] = NAMES) -> LoadSeparation:
    def elastic(separation: Floats, names: list[str]) -> LoadSeparation:
        path = LoadingPath.along(separation, unload=False, adhesive=False)
        return simulate(Problem(ensemble, MODULUS, Adhesion()), path, names)

    clear = math.nextafter(float(ensemble.height.max()), math.inf)
    return viscoelastic_law(elastic, separation, names, of, clear=clear, nominal_area=ensemble.nominal_area)


def there_and_back(depth: float = DEPTH, steps: int = 12, hold: int = 0) -> Floats:
    down = -np.linspace(-0.2, 1.0, steps) * depth
    return np.concatenate([down, np.full(hold, down[-1]), down[::-1]])


def test_a_cone_pressed_at_constant_speed() -> None:
    """Its force is c v^2 ∫ phi(t - s) 2 s ds (G. A. C. Graham, Int. J. Eng. Sci. 3 (1965) 27)."""
    speed, terms = 1e-6, [(0.3, 0.05), (0.5, 2.0)]
    h = np.linspace(0.0, -DEPTH, 9)
    found = law(asperities(0.0, "cone", slope=SLOPE), h, body(terms, speed)).variables["force"]
    t = -h / speed
    memory = sum(2.0 * g * tau * (t + tau * np.expm1(-t / tau)) for g, tau in terms)
    np.testing.assert_allclose(found, CONE * speed**2 * (0.2 * t**2 + memory), rtol=1e-12)


@pytest.mark.large
@pytest.mark.parametrize(
    ("shape", "parameters", "coefficient", "exponent"),
    [("paraboloid", {"radius": RADIUS}, SPHERE, 1.5), ("cone", {"slope": SLOPE}, CONE, 2.0)],
)
@pytest.mark.parametrize(
    ("terms", "speed", "back", "dwell"),
    [
        ([(0.6, 0.3)], 1e-6, 1e-6, 0.0),
        large([(0.2, 0.01), (0.7, 2.0)], 1e-6, 3e-6, 0.4),
        ([(1.0, 0.5)], 2e-6, 0.2e-6, 0.1),
    ],
)
def test_pressed_and_released_as_the_slow_twin(
    shape: str,
    parameters: dict[str, float],
    coefficient: float,
    exponent: float,
    terms: Any,
    speed: float,
    back: float,
    dwell: float,
) -> None:
    separation, of = there_and_back(steps=7, hold=1), body(terms, speed, back, dwell)
    found = law(asperities(0.0, shape, **parameters), separation, of)
    touch = 0.2 * DEPTH / speed
    times = of.motion.time(separation) - touch
    twin = Triangle(DEPTH, speed, back, dwell, terms)
    truth = [float(twin.force(t, coefficient, exponent)) if t > 0.0 else 0.0 for t in times.tolist()]
    np.testing.assert_allclose(found.variables["force"], truth, rtol=0.0, atol=1e-12 * max(truth))
    radius = np.sqrt(found.variables["contact_area"] / math.pi)
    depths = [speed * float(twin.contact_time(t)) if t > 0.0 else 0.0 for t in times.tolist()]
    of_depth = (
        np.sqrt(RADIUS * np.array(depths)) if shape == "paraboloid" else 2.0 / (math.pi * SLOPE) * np.array(depths)
    )
    np.testing.assert_allclose(radius, of_depth, rtol=0.0, atol=1e-12 * of_depth.max())
    assert found.variables["contact_count"].tolist() == [float(depth > 0.0) for depth in depths]


def test_a_sudden_step_relaxes_as_the_modulus_and_its_area_stays() -> None:
    terms, dwell = [(0.3, 0.1), (0.4, 3.0)], 5.0
    separation = np.concatenate([[0.0], np.full(21, -DEPTH)])
    found = law(asperities(0.0), separation, body(terms, 1.0, dwell=dwell))
    t = np.linspace(0.0, dwell, 21)
    relaxed = 1.0 - sum(g * -np.expm1(-t / tau) for g, tau in terms)
    np.testing.assert_allclose(
        found.variables["force"][1:], SPHERE * DEPTH**1.5 * relaxed, rtol=1e-5
    )  # in 1 um / (1 m/s)
    assert np.ptp(found.variables["contact_area"][1:]) == 0.0


def test_without_a_share_it_is_elastic() -> None:
    ensemble, separation = asperities(np.random.default_rng(0).normal(0.0, 1e-6, 50)), there_and_back()
    found = law(ensemble, separation, body([(0.0, 1.0)], 1e-6, dwell=0.3))
    path = LoadingPath.along(separation, unload=False, adhesive=False)
    elastic = simulate(Problem(ensemble, MODULUS, Adhesion()), path, NAMES)
    for name in NAMES:
        np.testing.assert_allclose(found.variables[name], elastic.variables[name], rtol=1e-13, atol=0.0)


@pytest.mark.parametrize(("fast", "modulus", "order"), [(True, 1.0, 1.0), (False, 0.4, 1.0)])
def test_fast_and_slow_motion_meet_the_instantaneous_and_the_long_term_modulus(
    fast: bool, modulus: float, order: float
) -> None:
    ensemble, separation = asperities([0.0, -0.2e-6, -0.5e-6]), there_and_back()
    elastic = law(ensemble, separation, body([(0.0, 1.0)], 1.0)).variables["force"]

    def off(speed: float) -> float:
        force = law(ensemble, separation, body([(0.6, 1.0)], speed)).variables["force"]
        return float(np.abs(force / modulus - elastic).max() / elastic.max())

    speeds = [1e-2, 1e-1] if fast else [1e-9, 1e-10]
    first, second = map(off, speeds)
    assert second < 1e-3
    assert math.log10(first / second) == pytest.approx(order, abs=0.1)
    assert off(1e6 if fast else 1e-18) < 1e-9


def test_an_ensemble_is_the_sum_of_its_asperities() -> None:
    heights = np.random.default_rng(3).normal(0.0, 0.5e-6, 40)
    separation = np.concatenate([np.linspace(1.5e-6, -0.3e-6, 15), np.linspace(-0.3e-6, 1.5e-6, 15)])
    of = body([(0.5, 0.2), (0.3, 3.0)], 1e-6, 2e-6, 0.1)
    found = law(asperities(heights), separation, of)
    singles = [law(asperities(height), separation, of).variables for height in heights]
    truth = np.sum([each["force"] for each in singles], axis=0)
    assert np.abs(found.variables["force"] - truth).max() <= found.numerical_error * truth.max() + 1e-12 * truth.max()
    assert found.numerical_error < 2e-9
    for name in ("contact_area", "contact_count"):
        np.testing.assert_allclose(found.variables[name], np.sum([each[name] for each in singles], axis=0), rtol=1e-12)


@st.composite
def bodies(draw: st.DrawFn) -> Viscoelasticity:
    decades = st.floats(-6.0, 6.0).map(lambda exponent: 10.0**exponent)
    times = draw(st.lists(decades, min_size=1, max_size=3))
    shares = [draw(st.floats(0.0, 1.0)) / len(times) for _ in times]
    speed, back = (DEPTH * draw(decades) for _ in range(2))
    return body(list(zip(shares, times, strict=True)), speed, back, draw(st.sampled_from([0.0, 1e-3, 10.0])))


@pytest.mark.large
@settings(deadline=None, max_examples=20)
@given(bodies())
def test_unloading_bears_less_than_loading_and_relaxation_less_than_elasticity(of: Viscoelasticity) -> None:
    separation, steps = there_and_back(), 12
    force = law(asperities([0.0, -0.3e-6]), separation, of)
    loading, unloading = force.variables["force"][:steps], force.variables["force"][steps:][::-1]
    elastic = law(asperities([0.0, -0.3e-6]), separation, body([(0.0, 1.0)], 1.0)).variables["force"][:steps]
    rounding = 1e-12 * elastic.max()
    assert (loading >= 0.0).all()
    assert (unloading >= 0.0).all()
    assert (unloading <= loading + rounding).all()
    assert (loading <= elastic + rounding).all()
    assert (loading >= of.relaxation.long_term * elastic - rounding).all()
    area = force.variables["contact_area"]
    assert (np.diff(area[:steps]) >= 0.0).all()
    assert (np.diff(area[steps:]) <= 0.0).all()


@pytest.mark.parametrize("unit", [2.0**-30, 2.0**20])
def test_it_does_not_depend_on_the_units(unit: float) -> None:
    separation, second = there_and_back(), 2.0**13
    one = law(asperities(0.0), separation, body([(0.5, 0.3)], 1e-6, 2e-6, 0.2)).variables["force"]
    of = body([(0.5, 0.3 * second)], 1e-6 * unit / second, 2e-6 * unit / second, 0.2 * second)
    other = law(asperities(0.0, radius=RADIUS * unit), separation * unit, of).variables["force"]
    np.testing.assert_allclose(other, one * unit**2, rtol=1e-13)


def test_where_nothing_touches_there_is_nothing() -> None:
    found = law(asperities(-5e-6), there_and_back(), body([(0.5, 1.0)], 1e-6))
    assert not found.variables["force"].any()
    assert not found.variables["contact_count"].any()
    assert found.numerical_error == 0.0
