"""Contacts without adhesion that are coupled, and the kernels that they are solved with.

Lengths are over the side L of the patch, loads over pi E* L^2. The unknown of a contact is x, the indentation at which
it would carry its load alone; below 0 the distance to first touch.
"""

from collections.abc import Callable
from typing import NamedTuple

from roughmdr.kernels.interface import Kernels
from roughmdr.numerics.arguments import Floats


class Asperities(NamedTuple):
    """Asperities in units of the patch."""

    height: Floats
    """Summit heights."""
    depth: Floats
    """Natural depths."""
    size: Floats
    """Natural radii."""
    params: Floats
    """Rows that ``Kernels.prepare`` returns."""


class Contacts(NamedTuple):
    """Contacts at a state x, one number for each asperity."""

    state: Floats
    """The state t of its kernels."""
    load: Floats
    growth: Floats
    """Slope of the load over x."""
    stiffness: Floats
    """Slope of the load over the indentation; over x, unless the edge of a tip holds the contact."""
    radius: Floats
    """0 out of contact."""
    punch: Floats
    """Radius of the punch that a close pair takes it for: that of the contact alone, but a flat in full, always."""
    lift: Floats
    """By how much its indentation exceeds x."""
    second_moment: Floats
    """M."""
    tilting: Floats
    """K, the moment of the pressure for a tilt of 1."""
    slide: Floats
    """How far the contact moves for a tilt of 1: 2 a/g'(a), but no farther than to the new top."""


Terms = tuple[float, float, float, float, float]
"""a, da/dt, g, dg/dt and ∫ x g' dx over the natural size and depth."""
Slid = tuple[float, float]
"""How much deeper a contact lies that has slid, and its ``slide``."""
Tipped = tuple[float, float, float, float]
"""How much deeper a contact lies, how far it has slid, what is to be added to 1/a, and K over 4/3 a^3."""


class CoupledKernels(Kernels):
    """Kernels of a shape without adhesion, with those of contacts on a displaced surface."""

    pinned = False
    flat = False
    edged = False
    """Whether the tip ends at an edge, that of a flat or of a cap."""
    terms: Callable[..., Terms]
    """(t, params) -> the terms at a state."""
    cubic_integral: Callable[..., float]
    """(t, params) -> ∫ x^3 g' dx to a, over natural size^3 and depth."""
    curved_state: Callable[..., float]
    """(t, ratio, params) -> the state with the load of t on a surface whose curvature adds ratio a^2 to g; negative,
    minus the radius, where the contact lies within the flat of a tip."""
    newton_state: Callable[..., float]
    """Like ``curved_state``, by iteration, where that has a closed form for some."""
    loaded_state: Callable[..., float]
    """(load, t, ratio, params) -> the state with a load on such a surface, from a guess t."""
    top: Callable[..., float]
    """(t, tilt, ratio, params) -> the radius from t on where dg/da is the tilt, over natural size."""
    bisected_top: Callable[..., float]
    """Like ``top``, by bisection."""
    slid: Callable[..., Slid]
    """(t, a, dg/da, tilt, ratio, depth, size, params) -> a contact on a tilted surface."""
    edge_curvature: Callable[..., float]
    """(ratio, params) -> the curvature of the gap between tip and surface."""
    tipped: Callable[..., Tipped]
    """(load, tilt, ratio, params) -> a contact whose load leaves part of the edge of its tip out of contact."""
    load_alone: Callable[..., None]
    respond: Callable[..., int]

    # Kernels of adhesive contacts alone:
    strain: Callable[..., float]
    """(t, params) -> ∫ (g(a) - g)^2 dx over natural size and depth^2."""
    held: Callable[..., float]
    lift: Callable[..., float]
    """(t, size, depth, params) -> lambda."""
    slide: Callable[..., tuple[float, float, float]]
    fill: Callable[..., None]
    flanks: Callable[..., None]
    edge: Callable[..., tuple[float, float, bool]]
    next_state: Callable[..., float]
    lone_load: Callable[..., float]


kernel = CoupledKernels("kernel")
"""Stands for the kernels in parts that ``specialise`` is given."""
