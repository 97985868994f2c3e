"""The power law in sums: x^(1/n) against many digits, and sums against single contacts."""

import math

import mpmath as mp
import numpy as np
import pytest
from forms import large_where_compiled
from hypothesis import given, settings, strategies as st

import roughmdr as rm
from roughmdr.kernels.closed.power_of_x import root

_ROUNDING = 2.0**-53


@settings(deadline=None, max_examples=300)
@given(
    x=st.floats(0.0, 1e308, exclude_min=True) | st.floats(0.5, 2.0) | st.floats(1e-3, 1e3),
    n=st.floats(0.05, 1000.0) | st.floats(1.0, 4.0),
)
def test_root_is_within_a_few_roundings(x: float, n: float) -> None:
    with mp.workdps(40):
        exact = mp.mpf(x) ** (1 / mp.mpf(n))
        log = mp.log(exact)
        if -707.0 < log < 708.0:
            assert abs(mp.mpf(root(x, n)) / exact - 1) <= (2.0 + 1.0 / n) * _ROUNDING
        else:
            assert root(x, n) in (0.0, math.inf) or abs(root(x, n) / exact - 1) <= (2.0 + 1.0 / n) * _ROUNDING


def test_the_ends_of_the_root() -> None:
    assert root(0.0, 2.5) == 0.0
    assert root(1.0, 0.37) == 1.0
    assert root(1e308, 0.1) == math.inf
    assert root(1e-308, 0.1) == 0.0
    assert root(5e-324, 2.0) == pytest.approx(math.sqrt(5e-324), rel=4 * _ROUNDING)


@large_where_compiled
@pytest.mark.few(1)
@pytest.mark.parametrize("length", [1e-9, 1e-6, 1.0])
def test_a_sum_is_that_of_its_contacts(length: float) -> None:
    table = rm.generate(
        {
            "source": "random",
            "shape": "power_law",
            "count": 300,
            "patch": f"{100.0 * length} m",
            "height": {"distribution": "normal", "std": 0.3 * length},
            "exponent": {"distribution": "uniform", "loc": 0.6, "scale": 8.4},
            "width": 2.0 * length,
            "rise": 0.5 * length,
        },
        seed=3,
    )
    separation = np.array([0.4, 0.0, -0.5]) * length
    names = ["force", "stiffness"]
    law = rm.load_separation(table, separation=separation, effective_modulus=3e6, variables=["contact_area", *names])
    heights, exponents = table["height"].values, table["exponent"].values
    for step, h in enumerate(separation):
        touching = [
            rm.indent(rm.PowerLaw(n, width=2.0 * length, rise=0.5 * length), effective_modulus=3e6, indentation=[z - h])
            for z, n in zip(heights.tolist(), exponents.tolist(), strict=True)
            if z > h
        ]
        for name in names:
            assert float(law[name][step]) == pytest.approx(
                math.fsum(float(one[name][0]) for one in touching), rel=1e-13
            )
        area = math.fsum(math.pi * float(one["contact_radius"][0]) ** 2 for one in touching)
        assert float(law["contact_area"][step]) == pytest.approx(area, rel=1e-13)
