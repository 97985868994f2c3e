"""The elementary functions and mpmath. Bounds are relative; beside each is the largest error of 4000 draws."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given, settings, strategies as st
from oracles.multiprecision import Number, mp

from roughmdr.numerics import vector_math
from roughmdr.numerics.jit import compiled

UNIT = 2.0**-53


def decades(lowest: float, highest: float) -> st.SearchStrategy[float]:
    return st.builds(lambda d, m: m * 10.0**d, st.floats(lowest, highest), st.floats(1.0, 2.0))


FUNCTIONS: dict[str, tuple[Callable[[float], float], Callable[[Number], Number], st.SearchStrategy[float], float]] = {
    "atan": (vector_math.atan, mp.atan, decades(-300.0, 300.0), 4.0),  # 2.1
    "expm1": (vector_math.expm1, mp.expm1, st.floats(-50.0, 709.0), 4.0),  # 1.5
    "expm1 near 0": (vector_math.expm1, mp.expm1, decades(-300.0, 0.0), 4.0),  # 1.5
    "tanh": (vector_math.tanh, mp.tanh, decades(-300.0, 300.0), 5.0),  # 2.7
    "log": (vector_math.log, mp.log, decades(-307.0, 307.0), 4.0),  # 1.6
    "log near 1": (vector_math.log, mp.log, decades(-15.0, -0.4).map(lambda d: 1.0 + d), 5.0),  # 2.6
    "log1p": (vector_math.log1p, mp.log1p, decades(-300.0, 300.0), 5.0),  # 2.8
    "q minus atan": (vector_math.q_minus_atan, lambda q: q - mp.atan(q), decades(-50.0, 100.0), 60.0),  # 39 at 0.42
    "atan minus cubic": (
        vector_math.atan_minus_cubic,
        lambda q: q**3 / 3 - (q - mp.atan(q)),
        decades(-50.0, 100.0),
        500.0,  # 370 at 0.42
    ),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_to_a_few_roundings(name: str) -> None:
    function, exact, numbers, roundings = FUNCTIONS[name]
    kernel = compiled(function)

    @given(numbers)
    @settings(deadline=None, max_examples=200)
    def check(x: float) -> None:
        with mp.workdps(400):  # enough for what cancels
            wanted = exact(mp.mpf(x))
            assert abs(mp.mpf(kernel(x)) - wanted) <= roundings * UNIT * abs(wanted)

    check()


@given(decades(-50.0, 2.5))
@settings(deadline=None, max_examples=200)
def test_t_minus_tanh(t: float) -> None:
    with mp.workdps(400):
        x = float(mp.tanh(mp.mpf(t)))
        # The difference for the rounded tanh: where it is near 1 it has no more of t to give.
        wanted = mp.atanh(mp.mpf(x)) - mp.mpf(x) if x < 0.4 else mp.mpf(t) - mp.mpf(x)
        assert abs(mp.mpf(compiled(vector_math.t_minus_tanh)(t, x)) - wanted) <= 30.0 * UNIT * abs(wanted)  # 13


@pytest.mark.parametrize("split", [0, 5])
@given(decades(-300.0, 300.0))
@settings(deadline=None, max_examples=200)
def test_a_binade_cell_and_the_position_in_it_are_the_number(split: int, y: float) -> None:
    cell, position = compiled(vector_math.binade_cell)(y, split)
    whole, within = cell >> split, cell & ((1 << split) - 1)
    assert 0.0 <= position < 1.0
    assert math.ldexp(1.0 + (within + position) * 2.0**-split, whole) == y


def test_the_ends() -> None:
    assert compiled(vector_math.expm1)(800.0) == math.inf
    assert compiled(vector_math.expm1)(-1e300) == -1.0
    assert compiled(vector_math.expm1)(0.0) == 0.0
    assert compiled(vector_math.atan)(0.0) == 0.0
    assert compiled(vector_math.tanh)(1e300) == 1.0
    assert compiled(vector_math.log)(1.0) == 0.0
    for x in (math.nan, 0.0, -1.0, math.inf, 5e-324):
        assert math.isnan(compiled(vector_math.log)(x))
    for function in (vector_math.atan, vector_math.expm1, vector_math.tanh):
        assert math.isnan(compiled(function)(math.nan))
