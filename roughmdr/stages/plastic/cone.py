"""Cones that yield: without a length, their mean pressure is the same at every depth.

A cone of slope S is elastic for good while its mean pressure E* S/2 is at most that of flow. Else it flows from first
touch on, under the pressure of a cavity that expands (K. L. Johnson, Contact Mechanics, Cambridge 1985, section 6.3,
with 2/3 Y between core and contact; equation 1 of D. Durban, R. Masri, Eur. J. Mech. A 27 (2008) 210),

    p/Y = 2/3 {2 + ln[(E S/Y + 4 (1 - 2 nu))/(6 (1 - nu))]},  E = (1 - nu^2) E*,

at least 1/2, where yielding begins, and at most the limit of a flat punch. The surface sinks in elastically
(W. C. Oliver, G. M. Pharr, J. Mater. Res. 7 (1992) 1564), so that b = d/(S + (pi - 2) p/E*): from 2 d/(pi S) of elastic
cones to d/S of rigid and plastic ones. Force and radius have no jump in the slope. Dents are those of ``mdr``.
"""

import math

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit, once, specialise
from roughmdr.stages.plastic import mdr
from roughmdr.stages.plastic.body import BEFORE, LIMIT, NO_MARK, RADIUS, SQUARE, Body, Mark, PlasticKernels, State
from roughmdr.stages.plastic.punch import LIMIT_PRESSURE

_SLOPE, _WIDTH, _HEIGHT = RADIUS, SQUARE, BEFORE
"""Rows of a cone: its slope; contact radius and height of its dent over the indentation [1]."""
_FIRST_YIELD = 0.5  # least mean pressure of yielding, over Y: Johnson 1985, section 6.2
_FROM_TOUCH = 1e-250  # indentation [m] at which cones yield that flow from first touch on: some dents are as deep
_SHARE = 2.0 / 3.0  # mean pressure above that of the core, over Y: the deviator at its edge
_PILED_UP = 0.8  # d/(S b) of rigid cones: the flow that gives spheres b^2 = 1.45 (2 R d), Biwa and Storakers 1995

kernel = PlasticKernels("kernel")
"""Stands for the kernels in ``_prepare``."""


def _prepare(asperity: Floats, body: Body) -> None:
    """Fill in where the cone yields, and the contact radius and the height of its dent over the indentation."""
    slope, modulus, poisson = asperity[_SLOPE], body.effective_modulus / body.yield_strength, body.poisson
    strain = (1.0 - poisson * poisson) * modulus * slope
    core = 2.0 / 3.0 * (1.0 + math.log((strain + 4.0 * (1.0 - 2.0 * poisson)) / (6.0 * (1.0 - poisson))))
    pressure = min(max(core + kernel.share, _FIRST_YIELD), LIMIT_PRESSURE)
    asperity[LIMIT] = math.inf if 0.5 * modulus * slope <= pressure else _FROM_TOUCH
    asperity[_WIDTH] = 1.0 / (kernel.rigid * slope + (math.pi - 2.0 * kernel.rigid) * pressure / modulus)
    asperity[_HEIGHT] = 2.0 * pressure / modulus * asperity[_WIDTH]


@njit
def _mark(deepest: float, asperity: Floats, body: Body) -> Mark:
    """b [m] and H [m] of the dent; no mark in an elastic cone."""
    if deepest <= asperity[LIMIT]:
        return NO_MARK
    return Mark(asperity[_WIDTH] * deepest, asperity[_HEIGHT] * deepest, 1.0)


@njit
def _state(indentation: float, rise: float, mark: Mark, asperity: Floats, body: Body) -> State:
    """The contact after the flat has risen from the deepest indentation."""
    if mark.first == 0.0:
        radius = max(2.0 * indentation / (math.pi * asperity[_SLOPE]), 0.0)
        force = body.effective_modulus * radius * indentation
        return State(force, radius, 2.0 * body.effective_modulus * radius, force * indentation / 3.0)
    dent = mdr.state(indentation, rise, mark, asperity, body)
    return dent if rise > 0.0 else State(dent.force, dent.radius, 2.0 * dent.force / indentation, dent.stored)


@njit
def _lost(deepest: float, mark: Mark, asperity: Floats, body: Body) -> float:
    """Energy [J] that yielding has taken: the work, a third of force times depth, less what is stored."""
    dent = _state(deepest, 0.0, mark, asperity, body)
    return dent.force * deepest / 3.0 - dent.stored


@once
def kernels(*, adhesive: bool = False, name: str = "cone", share: float = _SHARE, rigid: float = 1.0) -> PlasticKernels:
    """Return the kernels: ``share`` is the mean pressure above the core's over Y, ``rigid`` d/(S b) of rigid cones."""
    found = PlasticKernels(name)
    vars(found).update(parameter="slope", round=False, share=share, rigid=rigid)
    found.adhesive, found.kinks, found.prepare = adhesive, (math.inf,), specialise(_prepare, found)
    found.mark, found.ends, found.state, found.lost = _mark, mdr.ends, _state, _lost
    return found


def rivals() -> tuple[PlasticKernels, ...]:
    """Return kernels of other estimates: under the pressure of the core alone, and with edges that pile up."""
    return kernels(name="cone_core", share=0.0), kernels(name="cone_piled_up", rigid=_PILED_UP)
