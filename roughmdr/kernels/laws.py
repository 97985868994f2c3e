"""Which kernels compute which shape, with and without adhesion. A new shape or adhesion joins by one line here."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.errors import OutOfRange
from roughmdr.kernels import elastic, jkr_cone, jkr_paraboloid, jkr_power

Kernel = Callable[..., float]


class Law(NamedTuple):
    """The kernels of one asperity: scalars in, scalars out, reduced by the natural scales of the contact.

    ``x`` is the distance to the onset of contact over the natural depth (without adhesion delta/depth, with it
    1 - delta/delta_c); ``form`` is the third number of ``Shape.stretch``.
    """

    name: str
    adhesive: bool
    natural: Callable[..., tuple[tuple[float, float], float, float, float]]
    """(modulus, work, width, rise, form) -> depth (hi, lo), radius, force, stiffness."""
    natural_force: Callable[..., tuple[tuple[float, float], float]]
    """(modulus, work, width, rise, form) -> the force (hi, lo) that force control is reduced by, and its radius."""
    state: Kernel
    """(x, form) -> the state on the branch that a retraction follows."""
    radius_of_force: Kernel
    """(x, form) -> a over the radius of ``natural_force``; x is the distance to the onset under dead load."""
    state_of_radius: Kernel
    """(a over natural radius, form) -> the state."""
    distance: Kernel
    """(state, form) -> x."""
    radius: Kernel
    """(state, form) -> a over natural radius."""
    force: Kernel
    """(state, form) -> P over natural force."""
    stiffness: Kernel
    """(state, form) -> k over natural stiffness."""
    energy: Kernel
    """(state, form) -> elastic and surface energy over natural force times natural depth."""


def _elastic(name: str, natural: Callable[..., Any], state: Kernel, force: Kernel, energy: Kernel) -> Law:
    return Law(
        name=f"elastic_{name}",
        adhesive=False,
        natural=natural,
        natural_force=elastic.natural_force,
        state=state,
        radius_of_force=elastic.radius_of_force,
        state_of_radius=elastic.state_of_radius,
        distance=elastic.distance,
        radius=elastic.radius,
        force=force,
        stiffness=elastic.stiffness,
        energy=energy,
    )


_ELASTIC = {
    "paraboloid": _elastic(
        "paraboloid",
        elastic.natural_paraboloid,
        elastic.state_paraboloid,
        elastic.force_paraboloid,
        elastic.energy_paraboloid,
    ),
    "cone": _elastic("cone", elastic.natural_cone, elastic.state_cone, elastic.force_cone, elastic.energy_cone),
    "power_law": _elastic(
        "power_law", elastic.natural_power, elastic.state_power, elastic.force_power, elastic.energy_power
    ),
}
_JKR = {
    name: Law(
        name=f"jkr_{name}",
        adhesive=True,
        natural=kernels.natural,
        natural_force=kernels.natural_force,
        state=kernels.state,
        radius_of_force=kernels.radius_of_force,
        state_of_radius=kernels.state_of_radius,
        distance=kernels.distance,
        radius=kernels.radius,
        force=kernels.force,
        stiffness=kernels.stiffness,
        energy=kernels.energy,
    )
    for name, kernels in (("paraboloid", jkr_paraboloid), ("cone", jkr_cone), ("power_law", jkr_power))
}


def choose(shape: str, work: float, form: Floats) -> Law:
    """The law of asperities of one shape under a work of adhesion [J/m2].

    OutOfRange where adhesion and exponent do not go together: below 1/2 only a metastable branch exists, at 1/2 the
    two springs' laws are parallel.
    """
    if work == 0.0:
        return _ELASTIC[shape]
    lowest = float(np.min(form, initial=np.inf))
    if not lowest > 0.5:
        raise OutOfRange(f"exponent is {lowest:g}; with adhesion (work > 0) it must be above 1/2")
    return _JKR[shape]
