"""Knots of tables: within their tolerance, as few as there can be, and the same on every scale."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

from roughmdr.errors import StoreError
from roughmdr.report.export.table import RELATIVE_FROM, knots, tolerances
from roughmdr.report.export.text import rounded_up
from roughmdr.report.export.units import UnitSystem

Floats = NDArray[np.float64]


def off(x: Floats, y: Floats, kept: NDArray[np.int64]) -> Floats:
    return np.abs(np.interp(x, x[kept], y[kept]) - y)


def fewest(x: Floats, y: Floats, tolerance: Floats) -> int:
    """All choices of points, the smallest first."""
    inner = range(1, x.size - 1)
    for count in range(x.size - 1):
        for chosen in itertools.combinations(inner, count):
            if (off(x, y, np.array([0, *chosen, x.size - 1])) <= tolerance * (1.0 + 1e-12)).all():
                return count + 2
    return x.size


@settings(deadline=None, max_examples=60)
@given(
    steps=st.lists(st.floats(0.1, 3.0), min_size=2, max_size=9),
    seed=st.integers(0, 999),
    error=st.sampled_from([0.0, 0.02, 0.1, 0.5]),
)
def test_no_fewer_knots_would_do(steps: list[float], seed: int, error: float) -> None:
    x = np.concatenate([[0.0], np.cumsum(steps)])
    y = np.cumsum(np.random.default_rng(seed).uniform(0.0, 1.0, x.size))
    tolerance = error * np.linspace(1.0, 0.5, x.size)
    kept = knots(x, y, tolerance)
    assert kept[0] == 0
    assert kept[-1] == x.size - 1
    assert (off(x, y, kept) <= tolerance * (1.0 + 1e-9) + 1e-12 * y.max()).all()
    assert kept.size <= fewest(x, y, tolerance)


@pytest.mark.few(1)
@pytest.mark.parametrize("scale", [(1e-9, 1e12), (1.0, 1.0), (1e3, 1e-9)])
@pytest.mark.parametrize("error", [1e-2, 1e-4])
def test_a_curve_between_its_points_is_as_near_as_was_asked(scale: tuple[float, float], error: float) -> None:
    """An exponential over five decades, which the points only sample; the same knots on any scale."""

    def curve(t: Floats) -> Floats:
        return np.expm1(12.0 * t)

    t = np.linspace(0.0, 1.0, 1500)
    x, y = scale[0] * t, scale[1] * curve(t)
    between = scale[1] * 144.0 / 8.0 * np.exp(12.0 * (t + t[1])) * t[1] ** 2  # by the second derivative
    kept = knots(x, y, tolerances(y, error) - between)
    fine = np.linspace(0.0, 1.0, 100_001)
    exact = scale[1] * curve(fine)
    found = np.interp(scale[0] * fine, x[kept], y[kept])
    assert (np.abs(found - exact) <= error * np.maximum(exact, RELATIVE_FROM * exact[-1]) * 1.01).all()
    np.testing.assert_array_equal(kept, knots(t, curve(t), tolerances(curve(t), error) - between / scale[1]))


@pytest.mark.large
def test_knots_grow_as_the_inverse_root_of_the_error() -> None:
    t = np.linspace(0.0, 1.0, 4000)
    counts = [knots(t, np.exp(5.0 * t), tolerances(np.exp(5.0 * t), error)).size for error in (1e-2, 1e-3, 1e-4, 1e-5)]
    orders = np.log(np.array(counts[:-1]) / counts[1:]) / np.log(10.0)
    np.testing.assert_allclose(orders, -0.5, atol=0.08)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("", ("m", "N", "Pa")),
        ("mm,N,MPa", ("mm", "N", "MPa")),
        (" MPa , mm", ("mm", "N", "MPa")),
        ("N,um", ("um", "N", "TPa")),
        ("uN,um,MPa,K", ("um", "uN", "MPa")),
        ("cm,N", ("cm", "N", "N/cm^2")),
    ],
)
def test_units_in_any_order_make_a_system(text: str, names: tuple[str, ...]) -> None:
    system = UnitSystem.read(text)
    assert (system.length.name, system.force.name, system.stress.name) == names
    assert system.stress.size * system.length.size**2 == pytest.approx(system.force.size, rel=1e-15)
    conductance = system.of("W/m2/K")
    assert conductance.size == pytest.approx(system.power.size / system.length.size**2)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("mm,N,Pa", "N over mm squared is MPa, not Pa"),
        ("mm,inch", "'inch' is no unit of length, force or stress"),
        ("mm,um", "both units of length"),
    ],
)
def test_units_that_make_none_are_refused(text: str, says: str) -> None:
    with pytest.raises(StoreError, match=says):
        UnitSystem.read(text)


@settings(deadline=None)
@given(st.floats(1e-12, 1e12))
def test_a_stated_error_is_not_below_the_error_and_has_two_digits(error: float) -> None:
    assert error <= float(rounded_up(error)) <= 1.1 * error * (1.0 + 1e-12)
    assert rounded_up(float(rounded_up(error))) == rounded_up(error)
