"""The stable branches of one asperity: where each begins (its foot, a fold or a corner, where the contact detaches),
and where it ends.

A branch is stable where the controlled quantity grows with a: where 2 sqrt(a) g'(a) > tension under fixed grips, and
> 3 tension under dead load (H 32, 40). Notation of ``layout``.
"""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import (
    CONTROL,
    CORNER,
    COUNT,
    DEPTH,
    FOLD,
    FOOT,
    FOOT_X,
    LAST,
    LAST_X,
    MAX_BRANCHES,
    NEAR,
    ONSET,
    TENSION,
    TOP,
    TOP_X,
)
from roughmdr.numerics.arguments import Floats

_LARGEST = 1e140  # largest t; its square is a float
_RTOL = 1e-15
_HALVED = 12  # every so many steps the interval is halved
_LEAST = 0.1  # least factor on the value at an end
# Nearer than _NEAR to a foot, relative to t, the controlled quantity above the foot is the integral of its slope, since
# the difference has lost too many digits. Where its terms are above _SWING times the depth that distance is larger in
# proportion, but at most _FARTHEST: up to there Gauss's rule is exact to rounding.
_NEAR, _SWING, _FARTHEST = 4e-3, 8.0, 0.1
_NEXT = 2.0**-52


def steepness(t: float, params: Floats) -> float:
    """2 sqrt(a) g'(a)."""
    a, da, _, dg = kernel.mdr_profile(t, params)
    return 2.0 * math.sqrt(a) * dg / da if da > 0.0 else math.inf


def log_excess(t: float, tension: float, params: Floats) -> float:
    """ln(steepness/tension), within bounds."""
    steepness = kernel.steepness(t, params)
    return math.log(steepness / tension) if 0.0 < steepness < math.inf else (500.0 if steepness > 0.0 else -500.0)


def steepness_crossing(low: float, high: float, tension: float, params: Floats) -> float:
    """The t between low (or 0) and high (or inf) where the steepness passes the tension; inf where none is found.

    By secants in ln t, in which the steepness is nearly a power law, with the factor of N. Anderson and A. Björck (BIT
    13 (1973) 253) on an end that stays, and now and then by halves.
    """
    rising, factor = True, 16.0
    if high == math.inf:
        low, high = max(low, 1e-3), max(low, 1.0)
        while not kernel.steepness(high, params) >= tension:
            if high > _LARGEST:
                return math.inf
            low, high, factor = high, high * factor, min(factor * factor, 1e20)
    else:
        rising = kernel.steepness(high, params) >= tension
    if low == 0.0 or (kernel.steepness(low, params) >= tension) == rising:
        low, factor = min(0.5 * high, 1.0), 16.0
        while (kernel.steepness(low, params) >= tension) == rising:
            if low < 1.0 / _LARGEST:
                return math.inf
            high, low, factor = low, low / factor, min(factor * factor, 1e20)
    z_low, z_high = math.log(low), math.log(high)
    e_low, e_high = kernel.log_excess(low, tension, params), kernel.log_excess(high, tension, params)
    z, side = z_high, 0
    for i in range(200):
        z = z_low - e_low * (z_high - z_low) / (e_high - e_low) if i % _HALVED > 0 else 0.5 * (z_low + z_high)
        if not z_low < z < z_high:
            z = 0.5 * (z_low + z_high)
        excess = kernel.log_excess(math.exp(z), tension, params)
        if abs(excess) < _RTOL or not z_low < z < z_high:
            break
        if (excess > 0.0) == (e_high > 0.0):
            e_low *= max(1.0 - excess / e_high, _LEAST) if side > 0 else 1.0
            z_high, e_high, side = z, excess, 1
        else:
            e_high *= max(1.0 - excess / e_low, _LEAST) if side < 0 else 1.0
            z_low, e_low, side = z, excess, -1
    return math.exp(z)


def note_branch(count: int, foot: float, top: float, params: Floats) -> int:
    """Add a branch to the list, if there is room; return the new count."""
    if count < MAX_BRANCHES:
        params[FOOT + count], params[TOP + count] = foot, top
    return count + 1


def list_branches(tension: float, params: Floats) -> int:
    """Fill in where the stable branches begin and end; return their number, 0 where it is not found."""
    count, low, foot, stable = 0, 0.0, 0.0, False
    for i in range(kernel.softening_count(params)):
        peak, dip = kernel.softening_interval(i, params)
        if not stable and peak > low and kernel.steepness(peak, params) >= tension:
            foot, stable = kernel.steepness_crossing(low, peak, tension, params), True
        elif not stable and params[CORNER] > 0.0:
            foot, stable = peak, True
        if stable and kernel.steepness(dip, params) < tension:
            beyond = peak * (1.0 + _NEXT) if params[CORNER] > 0.0 else peak
            count = kernel.note_branch(count, foot, kernel.steepness_crossing(beyond, dip, tension, params), params)
            stable = False
        low = dip
    if not stable:
        foot = kernel.steepness_crossing(low, math.inf, tension, params)
    count = kernel.note_branch(count, foot, math.inf, params)
    return count if count <= MAX_BRANCHES and foot < math.inf else 0


def find_branches(params: Floats) -> None:
    """Fill in the stable branches and the depth; COUNT = 0 where they are not found."""
    params[COUNT], params[FOLD], params[DEPTH], params[ONSET], params[NEAR] = 0.0, 0.0, 1.0, 1.0, _NEAR
    if params[TENSION] == 0.0:
        params[FOOT], params[TOP], params[FOOT_X], params[TOP_X], params[COUNT] = 0.0, math.inf, 0.0, math.inf, 1.0
        params[LAST], params[LAST_X] = 0.0, 0.0
        return
    kernel.measure_branches(kernel.list_branches(params[TENSION] * (1.0 + 2.0 * params[CONTROL]), params), params)
    if params[COUNT] > 0.0:
        a = kernel.mdr_profile(params[FOLD], params)[0]
        swing = 2.0 * params[TENSION] * math.sqrt(a) * (a if params[CONTROL] > 0.0 else 1.0) / params[DEPTH]
        params[NEAR] = min(_NEAR * max(swing / _SWING, 1.0), _FARTHEST)


def measure_branches(count: int, params: Floats) -> None:
    """Fill in the depth and the distances of the ``count`` branches that are listed."""
    params[DEPTH] = -math.inf
    for j in range(count):
        depth = -kernel.control_at(params[FOOT + j], params)[0]
        if depth > params[DEPTH]:
            params[FOLD], params[DEPTH] = params[FOOT + j], depth
    if not 0.0 < params[DEPTH] < math.inf:
        return
    for j in range(count):
        params[FOOT_X + j] = kernel.control_at(params[FOOT + j], params)[0] / params[DEPTH] + 1.0
        params[TOP_X + j] = (
            kernel.control_at(params[TOP + j], params)[0] / params[DEPTH] + 1.0 if j < count - 1 else math.inf
        )
    params[COUNT], params[LAST], params[LAST_X] = float(count), params[FOOT + count - 1], params[FOOT_X + count - 1]
