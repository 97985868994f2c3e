"""Loops over the contacts of a block that need the profile of their shape, each in one call."""

from typing import Any

from roughmdr.kernels.interface import law
from roughmdr.numerics.arguments import Floats


def approach_all(count: int, x: Floats, state: Floats, error: Floats, params: Any) -> None:
    """Approach the states of the first ``count`` contacts from guesses, and fill in bounds of their errors."""
    for i in range(count):
        state[i], error[i], _ = law.approach(state[i], x[i], law.params_of(params, i))


def evaluate_all(count: int, state: Floats, radius: Floats, force: Floats, stiffness: Floats, params: Any) -> None:
    """Fill in a, P and k of the first ``count`` contacts."""
    for i in range(count):
        radius[i], force[i], stiffness[i] = law.radius_force_stiffness(state[i], law.params_of(params, i))


def near_all(
    count: int, x: Floats, state: Floats, radius: Floats, force: Floats, stiffness: Floats, error: Floats, params: Any
) -> None:
    """Fill in the states of the first ``count`` contacts from guesses, a, P and k, and their relative errors."""
    for i in range(count):
        state[i], radius[i], force[i], stiffness[i], error[i] = law.contact_near(
            state[i], x[i], law.params_of(params, i)
        )
