"""One asperity without adhesion, where ``equilibrium`` and ``initial_guess`` have a term of adhesion that is 0.

Without adhesion, asperities that differ in width and rise alone share a row: the state is a function of x.
Notation of ``layout``.
"""

import math

import numpy as np

from roughmdr.kernels.interface import Columns, Material
from roughmdr.kernels.profile.interface import kernel
from roughmdr.numerics.arguments import Floats

_PER_DEPTH = 2.0**28  # inverse of the depth at which the octaves begin
_REACH = 2.0**15  # distance, over the step, within which a kink makes the error larger: g may go as the power 3/2 there


def prepare(material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float) -> Floats:
    """Return the one row of all asperities."""
    rows = np.zeros((1, 2 - kernel.first_node))
    rows[0, 0] = columns.params[start]
    kernel.fill_params(material, columns.width[start], columns.rise[start], control, rows[0])
    kernel.fill_nodes(kernel.octaves << kernel.split, rows)
    return rows


def y_of_x(x: float, params: Floats) -> float:
    """y at x."""
    return x * _PER_DEPTH


def x_of_y(y: float, params: Floats) -> tuple[float, float]:
    """x at y, and y dx/dy."""
    return y / _PER_DEPTH, y / _PER_DEPTH


def indentation_at(t: float, params: Floats) -> tuple[float, float]:
    """g and its derivative by t (H 16)."""
    _, _, g, dg = kernel.mdr_profile(t, params)
    return g, dg


def contact_near(t: float, x: float, params: Floats) -> tuple[float, float, float, float, float]:
    """The state, a, P and k at x to first order from their values at t, about the square of their relative distance,
    inf where there is a kink near (H 10, 16, 25; units as in ``radius_force_stiffness``).
    """
    a, da, g, dg = kernel.mdr_profile(t, params)
    off = x - g
    step = off / dg
    grown, reach = da * step, _REACH * abs(step)
    left = max(abs(step) / t, abs(off) / x)
    smooth = kernel.kink_between(t - reach, t + reach, params) < 1
    load = kernel.reduced_load(t, params) + (a + 0.5 * grown) * off  # dP/dg is a
    return t + step, a + grown, load, a + grown, left * left if (x > 0.0) & smooth else math.inf


def radius_force_stiffness(t: float, params: Floats) -> tuple[float, float, float]:
    """a over width, P over 2 E* width rise, and k over 2 E* width (H 10, 25)."""
    a = kernel.mdr_profile(t, params)[0]
    return a, kernel.reduced_load(t, params), a
