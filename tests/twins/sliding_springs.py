"""Contacts under a lateral displacement, slow and plain: rows of springs that slide, followed step by step.

By the method of dimensionality reduction a contact of indentation delta and MDR profile g is a row of springs at x,
each pressed by E* (delta - g(x)) dx and sheared with G* dx, which slides where its shear would exceed mu times its
pressure. Nothing else is known here: no difference of normal contacts, no rule for turning points. Units: SI.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def follow(
    contacts: Sequence[tuple[float, float, Callable[[Floats], Floats]]],
    displacement: Floats,
    *,
    moduli: tuple[float, float],
    friction: float,
    springs: int,
) -> tuple[Floats, Floats]:
    """Return the tangential force [N] and the energy lost [J] at each displacement [m], from rest at 0.

    A contact is its radius [m], its indentation [m] and g; ``moduli`` are E* and G* [Pa]; each contact has so many
    ``springs`` on either side, in the middle of equal parts.
    """
    normal, lateral = moduli
    force, lost = np.zeros(displacement.size), np.zeros(displacement.size)
    for radius, indentation, g in contacts:
        dx = radius / springs
        x = dx * (np.arange(springs, dtype=np.float64) + 0.5)
        most = friction * normal * (indentation - g(x)) * dx
        shear, before, spent = np.zeros(springs), 0.0, 0.0
        for step, here in enumerate(displacement.tolist()):
            tried = shear + lateral * dx * (here - before)
            shear = np.clip(tried, -most, most)
            spent += float(np.sum(most * np.abs(tried - shear))) / (lateral * dx)
            force[step] += 2.0 * float(np.sum(shear))
            lost[step] += 2.0 * spent
            before = here
    return force, lost
