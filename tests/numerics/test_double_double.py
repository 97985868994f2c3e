"""The pair arithmetic and mpmath. Bounds are relative; beside each is the largest error of 30 000 draws."""

import math

import pytest
from hypothesis import assume, given, settings, strategies as st
from oracles.multiprecision import Number, mp

from roughmdr.numerics import double_double as extended

Pair = tuple[float, float]


def floats(lowest: float, highest: float) -> st.SearchStrategy[float]:
    """Both signs, magnitudes of any decade between 10^lowest and 10^highest."""
    magnitude = st.builds(lambda d, m: m * 10.0**d, st.floats(lowest, highest), st.floats(1.0, 2.0))
    return st.builds(math.copysign, magnitude, st.sampled_from([1.0, -1.0]))


def tails() -> st.SearchStrategy[float]:
    """Up to half a digit, on a grid so coarse that a pair has 106 bits and mpmath holds it exactly."""
    return st.integers(-(2**52), 2**52).map(lambda m: m * 2.0**-53)


def pairs(lowest: float, highest: float) -> st.SearchStrategy[Pair]:
    """A float with a tail of at most half its last digit."""
    return st.builds(lambda hi, t: extended.two_sum(hi, t * math.ulp(hi)), floats(lowest, highest), tails())


def value(pair: Pair) -> Number:
    return mp.fadd(*pair, exact=True)


def relative_error(got: Pair, exact: Number) -> float:
    error = abs(value(got) - exact)
    return float(error / abs(exact)) if error else 0.0


@pytest.mark.large
@given(floats(-300.0, 300.0), floats(-300.0, 300.0))
@settings(deadline=None)
def test_two_sum_is_exact(a: float, b: float) -> None:
    got = extended.two_sum(a, b)
    assert value(got) == mp.fadd(a, b, exact=True)
    assert got[0] == a + b


@pytest.mark.large
@given(floats(-140.0, 145.0), floats(-140.0, 145.0))
@settings(deadline=None)
def test_two_product_is_exact(a: float, b: float) -> None:
    got = extended.two_product(a, b)
    assert value(got) == mp.fmul(a, b, exact=True)
    assert got[0] == a * b


@pytest.mark.large
@given(st.one_of(pairs(-1.0, 1.0), pairs(-130.0, 130.0)), pairs(-130.0, 130.0))
@settings(deadline=None)
def test_multiply(x: Pair, y: Pair) -> None:
    assert relative_error(extended.multiply(x, y), value(x) * value(y)) <= 1e-31  # 4.6e-32


@pytest.mark.large
@given(pairs(-130.0, 130.0), st.one_of(pairs(-1.0, 1.0), pairs(-130.0, 130.0)))
@settings(deadline=None)
def test_divide(x: Pair, y: Pair) -> None:
    assert relative_error(extended.divide(x, y), value(x) / value(y)) <= 2e-31  # 6.8e-32


@pytest.mark.large
@given(pairs(-20.0, 20.0), pairs(-20.0, 20.0))
@settings(deadline=None)
def test_add(x: Pair, y: Pair) -> None:
    assume(value(x) + value(y) != 0)
    assert relative_error(extended.add(x, y), value(x) + value(y)) <= 4e-32  # 2.4e-32


@given(pairs(-20.0, 20.0), st.integers(1, 51), tails())
@settings(deadline=None)
def test_add_where_the_leading_digits_cancel(x: Pair, digits: int, tail: float) -> None:
    y = extended.two_sum(-x[0] * (1.0 + 2.0**-digits), math.ulp(x[0]) * tail)
    assert relative_error(extended.add(x, y), value(x) + value(y)) <= 4e-32  # 6.1e-33


@pytest.mark.large
@given(pairs(-280.0, 308.0 - math.log10(2.0)))
@settings(deadline=None)
def test_log(x: Pair) -> None:
    x = x if x[0] > 0.0 else (-x[0], -x[1])
    assert relative_error(extended.log(x), mp.log(value(x))) <= 1.2e-31  # 5.9e-32


@pytest.mark.large
@given(floats(-15.0, -0.4), tails())
@settings(deadline=None)
def test_log_near_1(offset: float, tail: float) -> None:
    x = extended.two_sum(1.0 + offset, 2.0**-53 * tail)
    assert relative_error(extended.log(x), mp.log(value(x))) <= 1.2e-31  # 5.9e-32


@pytest.mark.parametrize("x", [5e-324, 2.3e-308, 1e-300, 1.7976931348623157e308])
def test_log_at_the_ends_of_the_range(x: float) -> None:
    assert relative_error(extended.log((x, 0.0)), mp.log(mp.mpf(x))) <= 1.2e-31


@pytest.mark.large
@given(pairs(-8.0, math.log10(300.0)))
@settings(deadline=None)
def test_exp(x: Pair) -> None:
    first_order = x[1] ** 2  # of the tail's own exponential no more than 1 + x[1] is taken
    error = relative_error(extended.exp(x), mp.exp(value(x)))
    assert error <= 1e-31 * (1.0 + abs(x[0])) + first_order  # 4e-32


def test_constants() -> None:
    for got, exact in [
        (extended.LOG_2, mp.log(2)),
        (extended.LOG_3, mp.log(3)),
        (extended.PI, +mp.pi),
    ]:
        assert relative_error(got, exact) <= 2e-32
