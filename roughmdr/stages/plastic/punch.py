"""Flat punches on an elastic and perfectly plastic body: F = 2 E* b d up to the limit load, then flow, with adhesion.

The limit load is that of a smooth punch, pi b^2 5.69 k with Y = 2 k (R. T. Shield, Proc. R. Soc. A 233 (1955) 267).
Contacts unload along the elastic line: a dent stays as deep as the flow was. Adhesion lets go at the stretch
sqrt(2 pi b w/E*) of the springs (K. Kendall, J. Phys. D 4 (1971) 1186).
"""

import math
from typing import Any

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit, once, specialise
from roughmdr.stages.plastic.body import LIMIT, NO_MARK, RADIUS, Body, Mark, PlasticKernels, State

LIMIT_PRESSURE = 2.845
"""Mean pressure over Y under a smooth flat punch that sinks in [1]: Shield's 5.69 k."""
_ROUGH_PRESSURE = 3.025  # the same under a rough one: 6.05 k, G. Eason, R. T. Shield, ZAMP 11 (1960) 33

kernel = PlasticKernels("kernel")
"""Stands for the kernels in ``_prepare``."""


def _prepare(asperity: Floats, body: Body) -> None:
    """Fill in the indentation at the limit load."""
    asperity[LIMIT] = 0.5 * math.pi * kernel.pressure * body.yield_strength / body.effective_modulus * asperity[RADIUS]


@njit
def _mark(deepest: float, asperity: Floats, body: Body) -> Mark:
    """b [m], and how deep [m] the elastic part of a contact is that flows; no mark before."""
    return Mark(asperity[RADIUS], asperity[LIMIT], 1.0) if deepest > asperity[LIMIT] else NO_MARK


@njit
def _ends(deepest: float, mark: Mark, asperity: Floats, body: Body) -> tuple[float, float]:
    """Rises of the flat [m] at which contact is made again, and lost; deepest > 0."""
    made = min(deepest, asperity[LIMIT])
    return made, made + math.sqrt(2.0 * math.pi * asperity[RADIUS] * body.work / body.effective_modulus)


@njit
def _state(indentation: float, rise: float, mark: Mark, asperity: Floats, body: Body) -> State:
    """The contact after the flat has risen from the deepest indentation."""
    radius, depth = asperity[RADIUS], indentation if mark.first == 0.0 else mark.second - rise
    if depth <= 0.0 and body.work == 0.0:
        return State(0.0, 0.0, 0.0, 0.0)
    stiffness = 2.0 * body.effective_modulus * radius
    stored = 0.5 * stiffness * depth * depth - math.pi * body.work * radius * radius
    return State(stiffness * depth, radius, stiffness if mark.first == 0.0 or rise > 0.0 else 0.0, stored)


@njit
def _lost(deepest: float, mark: Mark, asperity: Floats, body: Body) -> float:
    """Energy [J] that flow has taken: limit load times flow."""
    return float(2.0 * body.effective_modulus * mark.first * mark.second * (deepest - mark.second))


@njit
def _saturated_state(indentation: float, rise: float, mark: Mark, asperity: Floats, body: Body) -> State:
    """The contact where no pressure exceeds the limit, which a ring at the edge reaches at once; no energy is told.

    Springs bear 2 p sqrt(b^2 - x^2) in that ring, E* d inside it; they unload along the elastic line.
    """
    radius, limit, whole = asperity[RADIUS], LIMIT_PRESSURE * body.yield_strength, 2.0 * body.effective_modulus
    sine = min(0.5 * body.effective_modulus * (indentation + rise) / (limit * radius), 1.0)
    cosine = math.sqrt(1.0 - sine * sine)
    force = 2.0 * limit * radius * radius * (math.asin(sine) + sine * cosine) - whole * radius * rise
    if force <= 0.0:
        return State(0.0, 0.0, 0.0, 0.0)
    return State(force, radius, whole * radius * (1.0 if rise > 0.0 else cosine), 0.0)


@once
def kernels(
    *, adhesive: bool, name: str = "flat_punch", pressure: float = LIMIT_PRESSURE, state: Any = _state
) -> PlasticKernels:
    """Return the kernels for a limit pressure over Y."""
    found = PlasticKernels(f"{name}_adhesive" if adhesive else name)
    vars(found).update(round=False, pressure=pressure)
    found.adhesive, found.kinks, found.prepare = adhesive, (math.inf,), specialise(_prepare, found)
    found.mark, found.ends, found.state, found.lost = _mark, _ends, state, _lost
    return found


def rivals() -> tuple[PlasticKernels, ...]:
    """Return kernels of other estimates: a rough punch, and one whose edge yields at once."""
    rough = kernels(adhesive=False, name="flat_punch_rough", pressure=_ROUGH_PRESSURE)
    return rough, kernels(adhesive=False, name="flat_punch_saturated", state=_saturated_state)
