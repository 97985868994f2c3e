"""Where the contacts of an ensemble detach under fixed grips."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.aggregate.block import prepare_of
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Columns, Kernels, Material, kernel
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise
from roughmdr.numerics.summation import BLOCK


class Detachments(NamedTuple):
    """Where adhesive contacts detach under fixed grips."""

    depth: Floats
    """Distance of detachment below first touch [m]."""
    radius: Floats
    """Contact radius at detachment [m], where adhesion has no range; 0 where it is not representable."""


def _fill(columns: Columns, material: Material, prepare: Callable[..., Any], found: Detachments) -> None:
    """Fill in where each contact detaches; ``prepare`` as in ``Kernels``."""
    depth, radius = found.depth, found.radius
    for start in range(0, depth.size, BLOCK):
        stop = min(start + BLOCK, depth.size)
        params = prepare(material, columns, start, stop, 0.0, 0.0)
        for i in range(start, stop):
            own = kernel.params_of(params, i - start)
            (depth[i], _), size, _, _ = kernel.scales(
                material.effective_modulus, material.work, columns.width[i], columns.rise[i], own
            )
            if not kernel.cohesive:
                radius[i] = size * kernel.radius(kernel.state(0.0, own), own) if depth[i] > 0.0 else 0.0


@once
def _compiled(kernels: Kernels) -> Callable[..., None]:
    return specialise(_fill, kernels)


def detachments(kernels: Kernels, columns: Columns, effective_modulus: float, adhesion: Adhesion) -> Detachments:
    """Return where each adhesive contact detaches; E* [Pa]."""
    found = Detachments(np.empty(columns.width.size), np.zeros(columns.width.size))
    material = kernels.material(effective_modulus, adhesion)
    _compiled(kernels.of_any or kernels)(columns, material, prepare_of(kernels, columns, material), found)
    return found
