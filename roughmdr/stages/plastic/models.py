"""Models of contacts that yield, and how much they differ."""

import math
from typing import Any

import numpy as np

from roughmdr.aggregate.totals import AREA, FORCE, RADIUS as RADIUS_SUM, STIFFNESS
from roughmdr.model_error.parts import PLASTIC_AT_FORCE, Yielding
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise
from roughmdr.stages.plastic import cone, empirical, mdr, punch
from roughmdr.stages.plastic.body import JUST_RISEN, NO_MARK, RADIUS, ROWS, Body, PlasticKernels

MODELS = ("mdr", "jackson-green", "kogut-etsion")
"""Names of the models in scenes."""
_FLOWING: dict[str, Any] = {"cone": cone, "flat_punch": punch}
"""Shapes that yield by similarity or at a limit load, by "mdr" alone."""
_USUAL_POISSON = 0.3
"""Poisson's ratio of metals, for models beside the one asked for where the scene does not tell it [1]."""

kernel = PlasticKernels("kernel")
"""Stands for the kernels of a model in ``_add_up``."""
_compiled = once(specialise)
_LIGHTEST = 0.1
"""Force over the largest from which models are compared at equal force: of less the first few contacts may tell."""
_LOADS = 64  # forces at which they are
_DEEPER = 1.25
"""Root of the depth to which other models are pressed, over that of the closest approach, to find the same forces."""


def kernels_of(model: str, body: Body, shape: str = "paraboloid") -> PlasticKernels:
    """Return the kernels of a model for bodies that adhere or do not, and a shape of asperities."""
    family = _FLOWING.get(shape, mdr)
    found: PlasticKernels = family.kernels(adhesive=body.work > 0.0) if model == "mdr" else empirical.kernels(model)
    return found


def compare(model: str, body: Body, shape: str, height: Floats, parameter: Floats, separation: Floats) -> Yielding:
    """Return how much other models differ from one, for asperities with heights [m] and a shape parameter, along
    separations [m]. Adhesion, which few models have, is left out. 0 where there is no force.
    """
    poisson = _USUAL_POISSON if math.isnan(body.poisson) else body.poisson
    dry = body._replace(work=0.0, poisson=poisson)
    others = (kernels_of(name, dry) for name in MODELS if name != model)
    compared = kernels_of(model, dry, shape), *(_FLOWING[shape].rivals() if shape in _FLOWING else others)

    def totals(separation: Floats) -> Floats:
        found = np.zeros((len(compared), STIFFNESS + 1, separation.size))
        for kernels, total in zip(compared, found, strict=True):
            _compiled(_add_up, kernels)(height, parameter, separation, dry, total)
        return found

    along = totals(separation)
    own, largest = along[0], float(along[0, FORCE].max(initial=0.0))
    differs = np.abs(along[:, FORCE] - own[FORCE]).max(axis=0) / (largest if largest > 0.0 else 1.0)
    if body.work > 0.0:
        return Yielding(differs, np.ones(separation.size), (math.nan,) * len(PLASTIC_AT_FORCE))
    elastic = 2.0 * body.effective_modulus * own[RADIUS_SUM]
    slope = np.divide(own[STIFFNESS], elastic, out=np.ones_like(elastic), where=elastic > 0.0)
    if largest == 0.0:
        return Yielding(differs, np.minimum(slope, 1.0), (0.0,) * len(PLASTIC_AT_FORCE))
    top = float(height.max())
    deep = (top - float(separation.min())) * np.linspace(0.0, _DEEPER, round(_DEEPER * _LOADS) + 1)[1:] ** 2
    return Yielding(differs, np.minimum(slope, 1.0), _at_force(totals(top - deep)))


@np.errstate(all="ignore")  # logarithms of 0 where contacts flow under a limit load
def _at_force(totals: Floats) -> tuple[float, ...]:
    """Return the largest errors of area, stiffness and radii of a model at given force, over those of another, from the
    totals [model, row, depth], of the model itself first.
    """
    logs = np.log(totals)
    force = logs[0, FORCE]
    told = (np.arange(force.size) < _LOADS) & (force >= force[_LOADS - 1] + math.log(_LIGHTEST))
    found = []
    for row in (AREA, STIFFNESS, RADIUS_SUM):
        others = [np.interp(force, np.maximum.accumulate(each[FORCE]), each[row], right=math.nan) for each in logs]
        off = np.abs(np.expm1(np.array(others) - logs[0, row]))[:, told]
        found.append(float(np.nanmax(1.0 / (1.0 + 1.0 / off), initial=0.0)))
    return tuple(found)


def _add_up(height: Floats, parameter: Floats, separation: Floats, body: Body, total: Floats) -> None:
    """Add force, radius, area and stiffness of asperities to their totals along separations [m]."""
    asperity = np.zeros(ROWS)
    for i in range(height.size):
        asperity[RADIUS] = parameter[i]
        kernel.prepare(asperity, body)
        lowest, mark = math.inf, NO_MARK
        for step in range(separation.size):
            h = separation[step]
            rise = max(h - lowest, 0.0 if h < lowest else JUST_RISEN)
            if h < lowest:
                lowest, mark = h, kernel.mark(height[i] - h, asperity, body)
            if height[i] > h:
                contact = kernel.state(height[i] - h, rise, mark, asperity, body)
                total[FORCE, step] += contact.force
                total[RADIUS_SUM, step] += contact.radius
                total[AREA, step] += math.pi * contact.radius * contact.radius
                total[STIFFNESS, step] += contact.stiffness
