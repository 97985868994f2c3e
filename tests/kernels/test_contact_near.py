"""Contacts without adhesion found from the values at a guess, against a search and the kernels at its state."""

from typing import Any

import numpy as np
import pytest
from forms import large_where_compiled

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile.newton import _RTOL
from roughmdr.shapes import SHAPES

SIMILAR = [name for name, shape in SHAPES.items() if shape.similar]


def prepared(name: str) -> tuple[Any, Any]:
    """Return the kernels of sums and the one row that all such asperities share, whatever their parameters."""
    shape = SHAPES[name](**SHAPES[name].example())
    columns = Columns(*(np.asarray(part, dtype=np.float64)[None] for part in shape.nondimensional()))
    kernels: Any = choose(name, Adhesion(), columns.params).in_sums
    return kernels, kernels.prepare(kernels.material(2e9, Adhesion()), columns, 0, 1, 0.0, np.inf)[0]


def searched(x: float, kernels: Any, params: Any) -> np.ndarray[Any, Any]:
    state = kernels.state_on_branch(x, 1.0, params)
    return np.array([state, *kernels.radius_force_stiffness(state, params)])


@large_where_compiled
@pytest.mark.parametrize("name", SIMILAR)
def test_those_that_are_certain_are_right(name: str) -> None:
    kernels, params = prepared(name)
    x = np.random.default_rng(5).permutation(np.geomspace(1e-7, 0.9 if name == "sphere" else 1e3, 400))
    certain = 0
    for each in x.tolist():
        guess = kernels.initial_guess(kernels.y_of_x(each, params), params)
        *found, error = kernels.contact_near(guess, each, params)
        if error <= _RTOL:
            certain += 1
            np.testing.assert_allclose(found, searched(each, kernels, params), rtol=4e-14)
    assert certain >= 0.97 * x.size


@pytest.mark.parametrize("name", [name for name in SIMILAR if name != "rounded_cone"])  # such steps may pass its kink
@pytest.mark.parametrize("x", [0.08, 0.6])
def test_their_errors_are_of_second_order_and_stated(name: str, x: float) -> None:
    kernels, params = prepared(name)
    exact, errors, stated = searched(x, kernels, params), [], []
    for far in (1e-3, 1e-4):
        *found, error = kernels.contact_near(exact[0] * (1.0 + far), x, params)
        errors.append(np.abs(np.array(found) / exact - 1.0))
        stated.append(error)
    assert (errors[0] <= 4.0 * stated[0]).all()
    assert stated[0] / stated[1] == pytest.approx(100.0, rel=0.05)
    above_rounding = errors[1] > 1e-13
    assert above_rounding.any()
    assert (errors[0][above_rounding] / errors[1][above_rounding]).min() > 80.0


@large_where_compiled
def test_next_to_a_kink_none_is_certain() -> None:
    kernels, params = prepared("rounded_cone")
    kink = kernels.reduced_control(1.0, params)
    for way in (*np.geomspace(1e-9, 1e-6, 20), *-np.geomspace(1e-9, 1e-6, 20)):
        exact = searched(kink * (1.0 + way), kernels, params)
        for start in (1.0 - 1e-8, 1.0 + 1e-8):
            *found, error = kernels.contact_near(start, kink * (1.0 + way), params)
            assert error > _RTOL or np.abs(np.array(found) / exact - 1.0).max() < 2e-15
