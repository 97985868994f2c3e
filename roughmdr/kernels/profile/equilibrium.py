"""Equilibrium of one asperity at a state t: indentation, force, stiffness and energy (H 25, 32-33, 40-41).

Notation of ``layout``. All in units of the shape's width and rise.
"""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import CONTROL, DEPTH, ROUNDINGS, TENSION
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import ROUNDING
from roughmdr.numerics.gauss import unit_gauss

_NODES, _WEIGHTS = unit_gauss(20)


def indentation_at(t: float, params: Floats) -> tuple[float, float]:
    """The indentation at t > 0, and its derivative by t."""
    a, da, g, dg = kernel.mdr_profile(t, params)
    root, tension = math.sqrt(a), params[TENSION]
    return g - tension * root, dg - 0.5 * tension * da / root


def control_at(t: float, params: Floats) -> tuple[float, float]:
    """The controlled quantity, indentation or force, and its derivative by t."""
    tension = params[TENSION]
    if params[CONTROL] == 0.0 and tension > 0.0:
        return kernel.indentation_at(t, params)
    a, da, g, dg = kernel.mdr_profile(t, params)
    if params[CONTROL] == 0.0:
        return g, dg
    root = math.sqrt(a)
    slope = dg - 1.5 * tension * da / root if tension > 0.0 else dg
    return kernel.reduced_load(t, params) - tension * a * root, a * slope


def reduced_control(t: float, params: Floats) -> float:
    """x: the controlled quantity above the lowest foot over DEPTH; without adhesion above first touch."""
    value = kernel.control_at(t, params)[0]
    return (value + params[DEPTH]) / params[DEPTH] if params[TENSION] > 0.0 else value


def radius(t: float, params: Floats) -> float:
    """a over width."""
    return kernel.mdr_profile(t, params)[0]


def radius_force_stiffness(t: float, params: Floats) -> tuple[float, float, float]:
    """a over width, P over 2 E* width rise, and k over 2 E* width: a (a g' - 3/2 dl)/(a g' - 1/2 dl)."""
    a, da, _, dg = kernel.mdr_profile(t, params)
    root, tension = math.sqrt(a), params[TENSION]
    rising, pull = root * dg, 0.5 * tension * da
    k = a * (rising - 3.0 * pull) / (rising - pull) if tension > 0.0 else a
    return a, kernel.reduced_load(t, params) - tension * a * root, k


def force(t: float, params: Floats) -> float:
    """P over 2 E* width rise."""
    return kernel.radius_force_stiffness(t, params)[1]


def stiffness(t: float, params: Floats) -> float:
    """k over 2 E* width, infinite at a smooth fold."""
    return kernel.radius_force_stiffness(t, params)[2]


def adhesion_terms(a: float, params: Floats) -> tuple[float, float]:
    """dl over rise, and a dl over width rise."""
    stretch = params[TENSION] * math.sqrt(a)
    return stretch, a * stretch


def relative_errors(params: Floats) -> tuple[float, float]:
    """Errors of the force and of the indentation, from the roundings of the profile and of dl."""
    error = ROUNDING * params[ROUNDINGS]
    return error, error


def elastic_integral(t: float, params: Floats) -> float:
    """2 ∫ g' ∫ x g' dx dx, panel by panel, in the fourth root of the position, as g' may begin like a root."""
    total, low = 0.0, 0.0
    while low < t:
        high = min(1.0 if low < 1.0 else 2.0 * low, t)
        for i in range(_NODES.size):
            z, weight = _NODES[i], _WEIGHTS[i]
            at = low + (high - low) * z * z * z * z
            width = 8.0 * (high - low) * weight * z * z * z
            total += width * kernel.mdr_profile(at, params)[3] * kernel.reduced_load(at, params)
        low = high
    return total


def energy(t: float, params: Floats) -> float:
    """U over 2 E* width rise^2 DEPTH: from ∫_0^a (g(a) - g(x))^2 dx = 2 ∫ g' ∫ x g' dx dx and the springs' stretch."""
    tension = params[TENSION]
    a = kernel.mdr_profile(t, params)[0]
    stretch = tension * math.sqrt(a)
    work = kernel.elastic_integral(t, params) - 2.0 * stretch * kernel.reduced_load(t, params)
    return (work + 0.5 * stretch * stretch * a) / (2.0 * params[DEPTH])
