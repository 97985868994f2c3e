"""One flat-ended punch under adhesion with a range: the cohesive zone ends at its edge, c = b.

Between delta = 0 and -beta b the contact shrinks from a = b to 0, a^2 = b^2 - (delta/beta)^2; below, all of the punch
is pulled with the strength. It detaches where the gap at its edge is w/sigma0. The state is delta/b.
Rows as in ``profile.layout``, except for FOLD.
"""

import math

import numpy as np

from roughmdr.kernels.interface import Columns, Material
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, FOLD, ONSET, RANGE, STRENGTH, UNIT
from roughmdr.kernels.profile.rows import (
    force_scales as force_scales_of_row,
    params_of as params_of_row,
    scales as scales_of_row,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled, njit

scales, force_scales = compiled(scales_of_row), compiled(force_scales_of_row)
params_of = njit(params_of_row, inline=True)
_KERNEL_ERROR = 1e-12  # relative error of the force, as tested
_MAX_DEPTH = 2.0**26  # largest depth over beta: beyond, roundings are more than 1e-12 of a closing contact


@njit
def _angle(wanted: float, of_force: bool) -> float:
    """The angle from 0 to pi/2 where angle - sin cos, or else angle sin - 1 + cos, is ``wanted``."""
    low, high = 0.0, 0.5 * math.pi
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        sine, cosine = math.sin(middle), math.cos(middle)
        value = middle - sine * cosine if of_force else middle * sine - sine * sine / (1.0 + cosine)
        low, high = (middle, high) if value < wanted else (low, middle)


@njit
def _opening(s: float, params: Floats) -> tuple[float, float, float]:
    """a/b, m/b and the angle at the state s."""
    m = min(max(-s / params[STRENGTH], 0.0), 1.0)
    a = math.sqrt((1.0 - m) * (1.0 + m))
    return a, m, math.atan2(m, a)


@njit
def prepare(material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float) -> Floats:
    """Return a row for each of the punches from start to stop; COUNT = 0 where the range is so long that contact is
    lost in its roundings.
    """
    rows = np.zeros((stop - start, -UNIT))
    for i in range(stop - start):
        params, b = rows[i], columns.width[start + i]
        beta = 2.0 * material.strength / material.effective_modulus
        gap_limit = material.work / material.strength / b
        params[STRENGTH], params[RANGE], params[CONTROL] = beta, gap_limit, control
        if gap_limit > (1.0 - 2.0 / math.pi) * beta:
            depth, angle = gap_limit + 2.0 / math.pi * beta, 0.5 * math.pi
        else:
            angle = _angle(0.5 * math.pi * gap_limit / beta, False)
            depth = beta * math.sin(angle)
        params[COUNT] = 1.0 if depth <= _MAX_DEPTH * beta else 0.0
        params[ONSET] = 1.0 - gap_limit / depth
        angle_term = angle + math.sin(angle) * math.cos(angle)
        params[DEPTH] = depth if control == 0.0 else 0.5 * beta * angle_term
        # pi/2 - (angle + sin cos) at detachment
        params[FOLD] = 0.5 * math.pi - angle_term if angle < 0.5 * math.pi else 0.0
    return rows


@njit
def state(x: float, params: Floats) -> float:
    """delta/b at x."""
    return (x - 1.0) * params[DEPTH]


@njit
def state_on_branch(x: float, branch: float, params: Floats) -> float:
    """delta/b at x; there is one branch."""
    return state(x, params)


@njit
def state_of_radius(radius: float, size: float, params: Floats) -> float:
    """NaN: the radius does not determine the state."""
    return math.nan


@njit
def state_of_force(x: float, params: Floats) -> float:
    """delta/b at the distance x to the pull-off force, over it, of a row under dead load."""
    if x >= 1.0:
        return (x - 1.0) * params[DEPTH]
    rest = params[FOLD] + x * 2.0 * params[DEPTH] / params[STRENGTH]  # pi/2 - (angle + sin cos), angle = asin(m/b)
    return -params[STRENGTH] * math.cos(_angle(rest, True))


@njit
def reduced_control(s: float, params: Floats) -> float:
    """x(s)."""
    return s / params[DEPTH] + 1.0


@njit
def radius(s: float, params: Floats) -> float:
    """a/b."""
    return _opening(s, params)[0]


@njit
def cohesive_radius(s: float, params: Floats) -> float:
    """c/b."""
    return 1.0


@njit
def radius_force_stiffness(s: float, params: Floats) -> tuple[float, float, float]:
    """a/b, P over 2 E* b^2, and k over 2 E* b."""
    a, m, angle = _opening(s, params)
    return a, max(s, 0.0) - 0.5 * params[STRENGTH] * (angle + a * m), a


@njit
def contact_at(x: float, branch: float, params: Floats) -> tuple[float, float, float, float]:
    """delta/b, a/b, P over 2 E* b^2, and k over 2 E* b at x."""
    s = state(x, params)
    a, push, k = radius_force_stiffness(s, params)
    return s, a, push, k


@njit
def force(s: float, params: Floats) -> float:
    """P over 2 E* b^2."""
    _, push, _ = radius_force_stiffness(s, params)
    return push


@njit
def stiffness(s: float, params: Floats) -> float:
    """k over 2 E* b."""
    return radius(s, params)


@njit
def adhesion_terms(a: float, params: Floats) -> tuple[float, float]:
    """Upper bounds of the parts of adhesion in delta/b and in P over 2 E* b^2."""
    return params[STRENGTH], params[STRENGTH]


@njit
def relative_errors(params: Floats) -> tuple[float, float]:
    """The error of the force, as tested; none of the indentation, which is the state."""
    return _KERNEL_ERROR, 0.0


@njit
def energy(s: float, params: Floats) -> float:
    """U, elastic and of both surfaces, over 2 E* b^3 DEPTH."""
    beta = params[STRENGTH]
    a, m, angle = _opening(s, params)
    elastic = s * s * a - beta * s * (angle - a * m) - beta * beta * (1.0 - a) * (1.0 - a) * (2.0 + a) / 3.0
    return (elastic - 0.5 * math.pi * beta * params[RANGE]) / (2.0 * params[DEPTH])


@njit
def branch(x: float, before: float, touched: bool, params: Floats) -> float:
    """1 while the punch is attracted, else 0."""
    return 1.0 if x > 0.0 and (touched or before > 0.0) else 0.0


@njit
def jump_energy(before: float, after: float, params: Floats) -> float:
    """The energy dissipated where attraction begins, or where it ends."""
    return -energy(-params[RANGE], params) if after > before else energy(-params[DEPTH], params)
