"""Two steps from the initial guess against a search on the branch: error, order, and for how many they suffice."""

import math
from typing import Any

import numpy as np
import pytest

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile.layout import COUNT, LAST, LAST_X
from roughmdr.kernels.profile.newton import _RTOL
from roughmdr.shapes import SHAPES

E = 3.7e9
W = 0.042
SCALED = {
    "sphere": {"radius": 8.0},
    "truncated_cone": {"slope": 0.2, "flat_radius": 1.3},
    "rounded_cone": {"slope": 0.1, "blend_radius": 2.0},
    "capped_paraboloid": {"radius": 6.0, "cap_radius": 11.0, "blend_radius": 0.7},
}


def _prepared(name: str, length: float) -> tuple[Any, Any]:
    """Return kernels and the row of an asperity with such lengths, under adhesion that scales with it."""
    shape = SHAPES[name](**{key: value if key == "slope" else value * length for key, value in SCALED[name].items()})
    adhesion = Adhesion(W * length / 1e-6)
    columns = Columns(*(np.asarray(part, dtype=np.float64)[None] for part in shape.nondimensional()))
    kernels = choose(name, adhesion, columns.params)
    return kernels, kernels.prepare(kernels.material(E, adhesion), columns, 0, 1, 0.0, math.inf)[0]


@pytest.mark.parametrize("length", [1e-9, 1e-6, 1.0])
@pytest.mark.parametrize("name", SCALED)
def test_the_error_of_two_steps_is_stated(name: str, length: float) -> None:
    kernels, params = _prepared(name, length)
    above = params[LAST_X] + np.geomspace(0.02, 3e3, 60)
    enough = 0
    for x in above.tolist():
        exact = kernels.state_on_branch(x, params[COUNT], params)
        beyond = exact - params[LAST]
        guess = kernels.initial_guess(kernels.y_of_x(x, params), params)
        found, error, _ = kernels.two_steps(guess, x, params)
        if error <= 1e-3:  # of a guess that is near
            assert abs(found - exact) <= (error + 1e-12) * beyond
        enough += error <= _RTOL
    assert enough >= 0.8 * above.size


@pytest.mark.parametrize("name", ["rounded_cone", "capped_paraboloid"])
def test_a_kink_next_to_the_state_is_not_passed_unseen(name: str) -> None:
    kernels, params = _prepared(name, 1e-6)
    kink, wrong = kernels.reduced_control(1.0, params), 0
    for way in [*np.geomspace(1e-9, 1e-2, 50), *-np.geomspace(1e-9, 1e-2, 50)]:
        x = kink * (1.0 + way)
        exact = kernels.state_on_branch(x, params[COUNT], params)
        for start in (1.0 - 1e-3, 1.0 - 1e-5, 1.0 + 1e-5, 1.0 + 1e-3):
            found, error, _ = kernels.two_steps(start, x, params)
            wrong += error <= _RTOL and abs(found - exact) > 1e-12
    assert wrong == 0


@pytest.mark.parametrize("name", ["sphere", "truncated_cone"])
def test_two_steps_are_of_fourth_order_in_the_steps(name: str) -> None:
    """The distance left falls with the sixth power of the first one, of which the second is the square."""
    kernels, params = _prepared(name, 1e-6)
    x = params[LAST_X] + 2.0
    exact = kernels.state_on_branch(x, params[COUNT], params)
    beyond = exact - params[LAST]
    left = [abs(kernels.two_steps(exact + far * beyond, x, params)[0] - exact) / beyond for far in (0.4, 0.2)]
    assert left[1] > 1e-15  # above rounding
    assert left[0] / left[1] > 2.0**5
