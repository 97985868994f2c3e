"""The stable branches under adhesion with a range: where the controlled quantity grows along the equilibria.

The slope is evaluated in growing steps of the state, and where the profile turns softer or stiffer, since contacts
may be stable there only; its sign changes are solved for. Notation of ``layout``.
"""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, FOLD, MAX_BRANCHES, ONSET, RANGE, UNIT
from roughmdr.numerics.arguments import Floats

_FIRST = 2.0**-24  # first state that is tried; contact begins at 1
_FIRST_STEP = 2.0**-8  # least step beyond the begin of contact
_STEP_ON_FLAT = 1.0 / 16.0
_THIN_ZONE = 0.1  # m/a: with a thinner zone a contact is as in JKR, and has no further branch
_LARGEST = 1e140  # largest state; its square is a float
_RTOL = 4e-16
_MAX_ITERATIONS = 200
_NEAR_END = 1.0 - 1e-9  # largest a, over the end of the profile: beyond, c and a are the same float


def next_trial(s: float, params: Floats) -> float:
    """The next state to try."""
    if s < 1.0:
        return max(2.0 * s, _FIRST)
    if kernel.flat and s < 2.0:
        return s + _STEP_ON_FLAT
    begin = 2.0 if kernel.flat else 1.0
    trial = begin + max(kernel.stride * (s - begin), _FIRST_STEP)
    for i in range(kernel.softening_count(params)):
        for t in kernel.softening_interval(i, params):
            turn = begin + t / params[UNIT]
            trial = turn if s < turn < trial else trial
    return trial


def slope_root(low: float, high: float, params: Floats) -> float:
    """Where the slope changes its sign between low and high, on the side where it is positive.

    By secants (the Illinois method) and halves, since the slope may jump.
    """
    at_low, at_high = kernel.control_at(low, params)[1], kernel.control_at(high, params)[1]
    rising, side = at_high > 0.0, 0
    for i in range(_MAX_ITERATIONS):
        if high - low <= _RTOL * high:
            break
        middle = 0.5 * (low + high)
        if i % 4 != 3 and abs(at_low) < math.inf and abs(at_high) < math.inf:
            middle = low - at_low * (high - low) / (at_high - at_low)
            middle = min(max(middle, low + 0.5 * _RTOL * high), high - 0.5 * _RTOL * high)
        slope = kernel.control_at(middle, params)[1]
        if (slope > 0.0) == rising:
            high, at_high, at_low, side = middle, slope, at_low * (0.5 if side > 0 else 1.0), 1
        else:
            low, at_low, at_high, side = middle, slope, at_high * (0.5 if side < 0 else 1.0), -1
    return high if rising else low


def find_branches(params: Floats) -> None:
    """Fill in the stable branches and the depth; COUNT = 0 where they are not found."""
    params[COUNT], params[FOLD], params[DEPTH], params[ONSET] = 0.0, 0.0, 1.0, 0.0
    if not kernel.find_junction(params):
        return
    edge_count = kernel.breakpoint_count(params)
    beyond = 2.0 * kernel.breakpoint(edge_count - 1, params)[0] if edge_count > 0 else 0.0
    count, s, foot, m, m_before = 0, 0.0, 0.0, 0.0, 0.0
    stable = kernel.control_at(s, params)[1] > 0.0
    while True:
        before, was = s, stable
        s = kernel.next_trial(s, params)
        if (
            s > 1.0
            and kernel.end < math.inf
            and kernel.mdr_profile((s - 1.0) * params[UNIT], params)[0] > _NEAR_END * kernel.end
        ):
            if stable:
                break
            return
        a = 0.0
        if s > 1.0:
            near = m * (m / m_before) if m_before > 0.0 else 0.0  # extrapolated as a power law in growing steps
            edges = kernel.zone_edge_near(s, near, params)
            a, m, m_before = edges[1], edges[2], m
            _, _, rise, _, growth = kernel.state_between(edges, params)
            stable = (rise if params[CONTROL] == 0.0 else growth) > 0.0
        else:
            stable = kernel.control_at(s, params)[1] > 0.0
        if stable and not was:
            foot = kernel.slope_root(before, s, params)
        elif was and not stable:
            count = kernel.note_branch(count, foot, kernel.slope_root(before, s, params), params)
        if stable and m < _THIN_ZONE * a and a > beyond:
            break
        if not s < _LARGEST or count >= MAX_BRANCHES:
            return
    kernel.measure_branches(kernel.note_branch(count, foot, math.inf, params), params)
    params[ONSET] = 1.0 - params[RANGE] / params[DEPTH]
