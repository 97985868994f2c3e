"""Loops over the contacts of a block that need the profile of their shape, each in one call.

``contacts`` is [row, contact], over natural scales. Loops take the rows out first, so that they become vector code.
"""

from typing import Any

from roughmdr.kernels.interface import kernel
from roughmdr.numerics.arguments import Floats

# Rows of ``contacts``. Radius, force and stiffness are filled where the kernels find them together with the state.
STATE, RADIUS, FORCE, STIFFNESS, STATE_ERROR, IN_CONTACT, BEFORE, TERM = range(8)
"""STATE_ERROR is filled where the kernels approach the state by steps; after that the row holds terms of a sum.
IN_CONTACT is 1 in contact, else 0, with several branches the number of the branch. BEFORE is IN_CONTACT at the step
before. TERM holds x until the contacts are found, then terms of a sum.
"""
CONTACT_ROWS = 8


def find_by_steps(count: int, contacts: Floats, params: Any) -> None:
    """Find the first ``count`` contacts from guesses of their states by a fixed number of steps, with bounds of the
    errors of the states.
    """
    state, error, x = contacts[STATE], contacts[STATE_ERROR], contacts[TERM]
    for i in range(count):
        state[i], error[i], _ = kernel.approach(state[i], x[i], kernel.params_of(params, i))
    kernel.evaluate_all(count, contacts, params)


def find_near(count: int, contacts: Floats, params: Any) -> None:
    """Find the first ``count`` contacts from the values at good guesses of their states, with about the squares of the
    distances.
    """
    state, a, force, stiffness = contacts[STATE], contacts[RADIUS], contacts[FORCE], contacts[STIFFNESS]
    error, x = contacts[STATE_ERROR], contacts[TERM]
    for i in range(count):
        state[i], a[i], force[i], stiffness[i], error[i] = kernel.contact_near(
            state[i], x[i], kernel.params_of(params, i)
        )


def evaluate_all(count: int, contacts: Floats, params: Any) -> None:
    """Fill in a, P and k of the first ``count`` contacts."""
    for i in range(count):
        contacts[RADIUS, i], contacts[FORCE, i], contacts[STIFFNESS, i] = kernel.radius_force_stiffness(
            contacts[STATE, i], kernel.params_of(params, i)
        )
