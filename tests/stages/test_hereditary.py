"""The hereditary integral: any memory length, its order of convergence, and the error that it states."""

import mpmath
import numpy as np
import pytest

from roughmdr.numerics.arguments import Floats
from roughmdr.stages.viscoelasticity.hereditary import Fading, Force, _Panels, _remember, remembered_force


def power(exponent: float) -> Force:
    return lambda h: (np.maximum(-h, 0.0) ** exponent, 1e-16)


def exact(exponent: float, length: float, depth: float) -> float:
    """∫_0^d exp(-(d - x)/length) dx^p, a confluent hypergeometric function."""
    with mpmath.workdps(40):
        d, ratio = mpmath.mpf(float(depth)), mpmath.mpf(float(depth)) / mpmath.mpf(length)
        return float(d**exponent * mpmath.hyp1f1(1, 1 + mpmath.mpf(exponent), -ratio))


def one_memory(force: Force, at: Floats, length: float) -> Fading:
    return Fading(np.array([length]), np.ones((1, at.size)), 0.0, force(at)[0])


@pytest.mark.parametrize("exponent", [1.0, 1.1, 1.5, 2.0, 3.3])
@pytest.mark.parametrize("length", [1e-12, 1e-6, 1e-2, 0.3, 1.0, 10.0, 1e6, 1e12])
def test_a_contact_from_first_touch_on_is_right_for_any_memory_length(exponent: float, length: float) -> None:
    at = -np.linspace(0.0, 1.0, 11)
    force, error = remembered_force(power(exponent), one_memory(power(exponent), at, length), at, 0.0)
    truth = np.array([0.0, *(exact(exponent, length, -h) for h in at[1:])])
    off = np.abs(force - truth).max()
    assert off <= max(error, 1e-14 * truth.max())
    assert off <= 1e-12 * truth.max()


def test_it_does_not_depend_on_the_unit_of_length() -> None:
    at, unit = -np.linspace(0.0, 1.0, 7), 2.0**-80
    small = lambda h: power(1.5)(h / unit)  # noqa: E731
    force, _ = remembered_force(power(1.5), one_memory(power(1.5), at, 0.1), at, 0.0)
    again, _ = remembered_force(small, one_memory(small, unit * at, unit * 0.1), unit * at, 0.0)
    np.testing.assert_array_equal(force, again)


@pytest.mark.parametrize("length", [0.05, 1.0, 20.0])
def test_the_order_of_its_convergence(length: float) -> None:
    at = np.array([-1.0])

    def error(count: int) -> float:
        edges = -np.linspace(0.0, 1.0, count + 1)
        separation = np.linspace(edges[:-1], edges[1:], 9, axis=1)
        smooth = np.exp(-6.0 * separation)
        fading = Fading(np.array([length]), np.ones((1, 1)), 0.0, np.exp(-6.0 * at))
        found = _remember(_Panels(separation, smooth), fading, at)[0]
        rate = 6.0 + 1.0 / length
        return abs(found / (6.0 / rate * np.exp(6.0) * -np.expm1(-rate)) - 1.0)

    # Of degree 8: order 9, or that of the slope where less than a panel is remembered.
    assert np.log2(error(2) / error(4)) > (8.0 if length < 0.1 else 9.0)


def test_each_summit_that_is_touched_leaves_a_kink_and_the_error_is_bounded() -> None:
    summits = -np.sort(np.random.default_rng(4).random(300))
    summits[-1] = 0.0
    at = -np.linspace(0.0, 1.0, 41)[1:]

    def force(h: Floats) -> tuple[Floats, float]:
        return np.sum(np.maximum(summits[:, None] - h, 0.0) ** 1.5, axis=0), 1e-15

    for length in (0.02, 0.5):
        found, error = remembered_force(force, one_memory(force, at, length), at, 0.0)
        truth = np.array([sum(exact(1.5, length, z - h) for z in summits if z > h) for h in at[[5, 39]]])
        assert np.abs(found[[5, 39]] - truth).max() <= error
        assert error <= 1e-8 * found.max()
