"""Moments: the same bits however realisations are cut up and ordered, and right to the last digits."""

import math
import random
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.batch.moments import Moments, MomentTree, block_moments, dyadic_blocks, moments_of

ORDINARY = st.floats(-1e3, 1e3, allow_subnormal=False)
EXTREME = st.one_of(
    st.sampled_from([0.0, 1e-300, -1e-300, 1e300, -1e300, 1.7e308, -1.7e308]),
    st.floats(allow_nan=False, allow_infinity=False, allow_subnormal=False),
)


def bits(moments: Moments) -> tuple[int, ...]:
    return moments.size, *(np.asarray(array).tobytes() for array in moments[1:])  # type: ignore[return-value]


def gathered(values: np.ndarray, cuts: list[int], order: random.Random, *, singles: bool) -> MomentTree:
    """Realisations cut into ranges, which come as singles or as moments, in some order."""
    edges = sorted({0, len(values), *(cut % len(values) for cut in cuts)})
    pieces: list[tuple[int, Moments]] = []
    for number, (first, last) in enumerate(pairwise(edges)):
        if singles and number % 2:
            pieces += [(place, Moments.of(values[place])) for place in range(first, last)]
        else:
            pieces += block_moments(first, values[first:last])
    order.shuffle(pieces)
    tree = MomentTree()
    for first, moments in pieces:
        tree.add(first, moments)
    return tree


@pytest.mark.large
@settings(deadline=None, max_examples=150)
@given(
    values=st.lists(EXTREME, min_size=1, max_size=70),
    cuts=st.lists(st.integers(0, 70), max_size=8),
    order=st.randoms(use_true_random=False),
    singles=st.booleans(),
)
def test_the_bits_depend_on_no_cut_and_no_order(
    values: list[float], cuts: list[int], order: random.Random, singles: bool
) -> None:
    array = np.array(values)[:, None] * [1.0, -0.5]
    whole = gathered(array, cuts, order, singles=singles).total(len(array))
    assert whole is not None
    assert bits(whole) == bits(moments_of(array))


@pytest.mark.large
@settings(deadline=None, max_examples=100)
@given(values=st.lists(st.one_of(ORDINARY, EXTREME), min_size=1, max_size=40))
def test_they_are_right_to_the_last_digits(values: list[float]) -> None:
    """Against sums of fractions, which are exact; without a warning of numpy's."""
    with np.errstate(all="raise", under="ignore"):
        found = moments_of(np.array(values)[:, None])
    exact = [Fraction(value) for value in values]
    mean = sum(exact) / len(exact)
    variance = sum((value - mean) ** 2 for value in exact) / len(exact)
    with mpmath.workdps(50):
        spread = mpmath.sqrt(mpmath.mpf(variance.numerator) / variance.denominator)
        scale = max(spread, mpmath.mpf(1e-300))
        assert abs(mpmath.mpf(float(found.spread[0])) - spread) <= 4e-15 * scale
    largest = max(abs(value) for value in exact)
    assert abs(Fraction(float(found.mean[0])) - mean) <= Fraction(2e-15) * largest + Fraction(5e-324)
    assert found.minimum[0] == min(values)
    assert found.maximum[0] == max(values)
    if len(values) > 1:
        expected = float(found.spread[0]) / math.sqrt(len(values) - 1)
        assert found.standard_error[0] == expected


@pytest.mark.large
@settings(deadline=None, max_examples=100)
@given(offset=st.sampled_from([1e3, -1e6, 1e9]), seed=st.integers(0, 1000), count=st.integers(2, 300))
def test_a_small_spread_about_a_large_mean_keeps_its_digits(offset: float, seed: int, count: int) -> None:
    """The error is of the size of a rounding of the values, not of their squares."""
    values = offset + np.random.default_rng(seed).standard_normal(count)
    found = moments_of(values[:, None])
    exact = [Fraction(value) for value in values.tolist()]
    mean = sum(exact) / count
    spread = math.sqrt(sum((value - mean) ** 2 for value in exact) / count)
    assert float(found.mean[0]) == pytest.approx(float(mean), rel=1e-15)
    assert float(found.spread[0]) == pytest.approx(spread, abs=4e-16 * abs(offset) + 4e-15 * spread)


@settings(deadline=None, max_examples=60)
@given(value=EXTREME, count=st.integers(1, 200))
def test_realisations_that_are_all_equal_have_no_spread(value: float, count: int) -> None:
    found = moments_of(np.full((count, 1), value))
    assert found.size == count
    for array in (found.mean, found.minimum, found.maximum):
        assert array[0] == value
    assert found.spread[0] == 0.0


def test_one_realisation_has_no_standard_error() -> None:
    single = moments_of(np.array([[1.0, -2.0]]))
    assert single.size == 1
    assert single.mean.tolist() == [1.0, -2.0]
    assert single.spread.tolist() == [0.0, 0.0]
    assert np.isnan(single.standard_error).all()


@settings(deadline=None, max_examples=60)
@given(count=st.integers(1, 40), missing=st.integers(0, 39))
def test_there_is_no_total_where_one_is_missing(count: int, missing: int) -> None:
    missing %= count
    values = np.arange(float(count))[:, None]
    tree = MomentTree()
    for first in sorted(set(range(count)) - {missing}):
        tree.add(first, Moments.of(values[first]))
    assert tree.total(count) is None
    assert tree.total(count + 1) is None
    tree.add(missing, Moments.of(values[missing]))
    assert (whole := tree.total(count)) is not None
    assert whole.size == count
    assert tree.total(count + 1) is None


@pytest.mark.parametrize("last", [1, 2, 255, 256, 1000])
def test_few_blocks_are_held(last: int) -> None:
    """There are as many as the number has binary digits, where realisations come in order."""
    tree = MomentTree()
    for count in range(1, last + 1):
        tree.add(count - 1, Moments.of(np.array([float(count)])))
        assert len(tree.blocks) == count.bit_count() <= math.log2(count) + 1
        assert sum(moments.size for moments in tree.blocks.values()) == count


@settings(deadline=None)
@given(first=st.integers(0, 10**6), size=st.integers(0, 10**6))
def test_the_places_fill_a_stretch_and_never_overlap(first: int, size: int) -> None:
    last = first + size
    at = first
    for begin, count in dyadic_blocks(first, last):
        assert begin == at
        assert count.bit_count() == 1
        assert begin % count == 0
        at += count
    assert at == last
