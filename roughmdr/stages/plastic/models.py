"""Models of contacts that yield, and how much their forces differ."""

import math
from collections.abc import Callable

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise
from roughmdr.stages.plastic import empirical, mdr
from roughmdr.stages.plastic.body import NO_MARK, RADIUS, ROWS, Body, PlasticKernels

MODELS = ("mdr", "jackson-green", "kogut-etsion")
"""Names of the models in scenes."""
_USUAL_POISSON = 0.3
"""Poisson's ratio of metals, for models beside the one asked for where the scene does not tell it [1]."""

kernel = PlasticKernels("kernel")
"""Stands for the kernels of a model in ``_add_forces``."""


def kernels_of(model: str, body: Body) -> PlasticKernels:
    """Return the kernels of a model for bodies that adhere or do not."""
    return mdr.kernels(adhesive=body.work > 0.0) if model == "mdr" else empirical.kernels(model)


def spread(model: str, body: Body, height: Floats, radius: Floats, separation: Floats) -> Floats:
    """Return the largest difference of the forces of other models from that of one, over its largest, at each step [1].

    The forces are those of asperities with heights [m] and radii [m] along separations [m]. Adhesion, which one model
    alone has, is left out. 0 where there is no force.
    """
    poisson = _USUAL_POISSON if math.isnan(body.poisson) else body.poisson
    dry = body._replace(work=0.0, poisson=poisson)
    forces = np.zeros((len(MODELS), separation.size))
    for name, force in zip(MODELS, forces, strict=True):
        _compiled(kernels_of(name, dry))(height, radius, separation, dry, force)
    own = forces[MODELS.index(model)]
    largest = float(own.max(initial=0.0))
    return np.asarray(np.abs(forces - own).max(axis=0) / (largest if largest > 0.0 else 1.0))


def _add_forces(height: Floats, radius: Floats, separation: Floats, body: Body, force: Floats) -> None:
    """Add the forces [N] of asperities along separations [m]."""
    asperity = np.zeros(ROWS)
    for i in range(height.size):
        asperity[RADIUS] = radius[i]
        kernel.prepare(asperity, body)
        lowest, mark = math.inf, NO_MARK
        for step in range(separation.size):
            h = separation[step]
            if h < lowest:
                lowest, mark = h, kernel.mark(height[i] - h, asperity, body)
            if height[i] > h:
                force[step] += kernel.state(height[i] - h, h - lowest, mark, asperity, body).force


@once
def _compiled(kernels: PlasticKernels) -> Callable[..., None]:
    """Return the loop compiled for some kernels."""
    return specialise(_add_forces, kernels)
