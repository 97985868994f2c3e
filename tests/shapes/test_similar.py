"""Shapes of which width and rise say all: asperities that differ in nothing else share one row in the sum."""

import numpy as np
import pytest

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.shapes import SHAPES

SIMILAR = [name for name, shape in SHAPES.items() if shape.similar]


def test_which_shapes_are_similar() -> None:
    assert set(SIMILAR) == {"truncated_cone", "truncated_paraboloid", "rounded_cone", "rounded_punch", "sphere"}


@pytest.mark.parametrize("name", SIMILAR)
def test_no_parameter_tells_two_of_them_apart(name: str) -> None:
    rng = np.random.default_rng(41)
    parameters = {key: rng.lognormal(0.0, 5.0, 50) for key in SHAPES[name].units}
    _, _, params = SHAPES[name].nondimensionalise(parameters)
    assert (params == params[0]).all()


def test_only_sums_without_adhesion_have_kernels_of_one_row() -> None:
    params = np.zeros(2)
    assert choose("sphere", Adhesion(), params).in_sums is not None
    assert choose("sphere", Adhesion(0.05), params).in_sums is None
    assert choose("capped_paraboloid", Adhesion(), np.full(2, 0.5)).in_sums is None
