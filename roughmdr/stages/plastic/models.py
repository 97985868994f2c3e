"""Models of contacts that yield, and how much their forces differ."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise
from roughmdr.stages.plastic import cone, empirical, mdr, punch
from roughmdr.stages.plastic.body import NO_MARK, RADIUS, ROWS, Body, PlasticKernels

MODELS = ("mdr", "jackson-green", "kogut-etsion")
"""Names of the models in scenes."""
_FLOWING: dict[str, Any] = {"cone": cone, "flat_punch": punch}
"""Shapes that yield by similarity or at a limit load, by "mdr" alone."""
_USUAL_POISSON = 0.3
"""Poisson's ratio of metals, for models beside the one asked for where the scene does not tell it [1]."""

kernel = PlasticKernels("kernel")
"""Stands for the kernels of a model in ``_forces``."""


def kernels_of(model: str, body: Body, shape: str = "paraboloid") -> PlasticKernels:
    """Return the kernels of a model for bodies that adhere or do not, and a shape of asperities."""
    family = _FLOWING.get(shape, mdr)
    found: PlasticKernels = family.kernels(adhesive=body.work > 0.0) if model == "mdr" else empirical.kernels(model)
    return found


def spread(model: str, body: Body, shape: str, height: Floats, parameter: Floats, separation: Floats) -> Floats:
    """Return the largest difference of the forces of other models from that of one, over its largest, at each step [1].

    The forces are those of asperities with heights [m] and a shape parameter along separations [m]. Adhesion, which
    few models have, is left out. 0 where there is no force.
    """
    poisson = _USUAL_POISSON if math.isnan(body.poisson) else body.poisson
    dry = body._replace(work=0.0, poisson=poisson)
    others = (kernels_of(name, dry) for name in MODELS if name != model)
    compared = kernels_of(model, dry, shape), *(_FLOWING[shape].rivals() if shape in _FLOWING else others)
    own, *forces = (_compiled(kernels)(height, parameter, separation, dry) for kernels in compared)
    largest = float(own.max(initial=0.0))
    return np.asarray(np.abs(forces - own).max(axis=0) / (largest if largest > 0.0 else 1.0))


def _forces(height: Floats, parameter: Floats, separation: Floats, body: Body) -> Floats:
    """Return the force [N] of asperities along separations [m]."""
    asperity, force = np.zeros(ROWS), np.zeros_like(separation)
    for i in range(height.size):
        asperity[RADIUS] = parameter[i]
        kernel.prepare(asperity, body)
        lowest, mark = math.inf, NO_MARK
        for step in range(separation.size):
            h = separation[step]
            if h < lowest:
                lowest, mark = h, kernel.mark(height[i] - h, asperity, body)
            if height[i] > h:
                force[step] += kernel.state(height[i] - h, h - lowest, mark, asperity, body).force
    return force


@once
def _compiled(kernels: PlasticKernels) -> Callable[..., Floats]:
    """Return the loop compiled for some kernels."""
    return specialise(_forces, kernels)
