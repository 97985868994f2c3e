"""One asperity on slow approach from infinity: where contact begins, and the branches that it then follows."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.asperity.contact import Contact, Results
from roughmdr.kernels.profile.layout import COUNT, FOOT, TOP, TOP_X
from roughmdr.numerics.arguments import Floats


class Branch(NamedTuple):
    """A branch that is stable under fixed grips, from its foot to its top, or the part of it that a path follows."""

    foot: float
    """The state where it begins."""
    top: float
    """The state where it ends; inf for the last."""


def branches_of(contact: Contact) -> list[Branch]:
    """Return the branches that are stable under fixed grips, outwards."""
    kernels, params = contact.kernels, contact.params
    if not kernels.iterative or contact.shape.pinned:
        return [Branch(float(kernels.state(0.0, params)), math.inf)]
    return [Branch(float(params[FOOT + j]), float(params[TOP + j])) for j in range(int(params[COUNT]))]


def approached(contact: Contact) -> list[Branch]:
    """Return the parts of branches that a contact with adhesion is on, one after another, as the surfaces approach.

    They jump from the top of one to the next.
    """
    kernels, params, all_branches = contact.kernels, contact.params, branches_of(contact)
    x = float(contact.reduced(np.array([contact.onset]), contact.depth)[0])
    if not kernels.branched:
        return [Branch(float(kernels.state(x, params)), math.inf)]
    number = kernels.branch(x, 0.0, True, params)
    if number == 0.0:  # attraction begins without a jump
        parts, number = [all_branches[0]], 1.0
    else:
        parts = [Branch(float(kernels.state_on_branch(x, number, params)), all_branches[int(number) - 1].top)]
    while int(number) < len(all_branches):
        x = float(params[TOP_X + int(number) - 1])
        number = kernels.branch(math.nextafter(x, math.inf), number, True, params)
        parts.append(Branch(float(kernels.state_on_branch(x, number, params)), all_branches[int(number) - 1].top))
    return parts


def at_indentation(contact: Contact, delta: Floats) -> Results:
    """Return the contact as on approach to each indentation [m]; zeros where the surfaces do not attract yet."""
    kernels, params = contact.kernels, contact.params
    if not kernels.adhesive:
        return contact.at_indentation(delta)
    near = delta >= contact.onset
    if not kernels.branched:
        found = contact.at_indentation(np.where(near, delta, 0.0))
        return {name: np.where(near, numbers, 0.0) for name, numbers in found.items()}
    distances = contact.reduced(np.where(near, delta, 0.0), contact.depth).tolist()
    numbers = [kernels.branch(x, 0.0, True, params) for x in distances]
    first = branches_of(contact)[0].foot
    states = [
        kernels.state_on_branch(x, number, params) if number > 0.0 else first
        for x, number in zip(distances, numbers, strict=True)
    ]
    results = contact.at_states(near & (np.array(numbers) > 0.0), np.array(states, dtype=np.float64))
    return {name: results[name] for name in results if name != "indentation"}
