"""The Prony series: its values and integrals against mpmath, and the duration of an integral there and back."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.stages.viscoelasticity.relaxation import Relaxation

DECADES = st.floats(-12.0, 12.0).map(lambda exponent: 10.0**exponent)


@st.composite
def series(draw: st.DrawFn) -> Relaxation:
    """A series of up to four terms, whose shares are 1 together at most."""
    times = draw(st.lists(DECADES, min_size=1, max_size=4))
    parts = np.array(draw(st.lists(st.floats(0.0, 1.0), min_size=len(times), max_size=len(times))))
    total = draw(st.floats(0.0, 1.0))
    shares = total * parts / parts.sum() if parts.sum() > 0.0 else parts
    return Relaxation(np.minimum(shares, 1.0), np.array(times))


@settings(deadline=None)
@given(series(), DECADES, DECADES)
def test_it_is_that_of_mpmath(relaxation: Relaxation, start: float, duration: float) -> None:
    with mpmath.workdps(60):
        terms = [(mpmath.mpf(g), mpmath.mpf(tau)) for g, tau in zip(relaxation.shares, relaxation.times, strict=True)]
        left = max(1 - sum(g for g, _ in terms), mpmath.mpf(0))
        modulus = left + sum(g * mpmath.exp(-mpmath.mpf(start) / tau) for g, tau in terms)
        parts = [
            g * tau * (mpmath.exp(-start / tau) - mpmath.exp(-(start + mpmath.mpf(duration)) / tau)) for g, tau in terms
        ]
        integral = left * duration + sum(parts)
    at, over = np.array([start]), np.array([duration])
    with np.errstate(under="ignore", over="ignore"):
        # What is left in the end is a difference of shares, right to a rounding of 1; exp(-x) to x roundings.
        assert relaxation.modulus(at)[0] == pytest.approx(float(modulus), rel=1e-13, abs=2e-16)
        assert relaxation.integral(at, over)[0] == pytest.approx(float(integral), rel=1e-13, abs=2e-16 * duration)


@pytest.mark.large
@settings(deadline=None)
@given(series(), DECADES, DECADES)
def test_the_duration_of_an_integral_is_found(relaxation: Relaxation, start: float, duration: float) -> None:
    begin, over = np.array([0.0, start]), np.array([duration, duration])
    with np.errstate(under="ignore", over="ignore"):
        integral = relaxation.integral(begin, over)
        found = relaxation.duration(begin, integral, 1e13)
        rounding = 2.0**-51 * integral  # over the modulus, by which a duration is off
        assert ((found - over * (1.0 + 1e-9)) * relaxation.modulus(begin + over) <= rounding).all()
        np.testing.assert_allclose(relaxation.integral(begin, found), integral, rtol=1e-14)


def test_an_integral_out_of_reach_takes_the_longest_duration() -> None:
    liquid = Relaxation(np.array([1.0]), np.array([2.0]))
    assert liquid.duration(np.zeros(3), np.array([0.0, 2.1, 5.0]), 100.0).tolist() == [0.0, 100.0, 100.0]


def test_shares_of_one_leave_nothing() -> None:
    assert Relaxation(np.full(10, 0.1), np.ones(10)).long_term == 0.0
