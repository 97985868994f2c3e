"""The jumps of a flat on a machine, one by one: from a peak of the demand to where the demand is as large again.

On the way up each detachment comes after a peak of the demand, where the stiffness of the contacts is minus that of the
machine; a punch that lets go at once has its peak at its detachment. On the way down jumps begin at touches that pull.
"""

import math

from roughmdr.aggregate.machine_stand import Jumps, Search, Stand, next_below, past_next, stand_at
from roughmdr.aggregate.passage import rise, sink
from roughmdr.aggregate.response import stand
from roughmdr.numerics.jit import njit

_MAX_JUMPS = 10_000_000
_MAX_ITERATIONS = 100
_RTOL = 1e-13  # width of an interval with a peak that is narrow enough, over the distance from last stand to detachment


@njit
def record(jumps: Jumps, step: int, demand: float, before: float, after: float) -> None:
    """Record a jump, where there is room for it."""
    number = jumps.number[0]
    if number < jumps.step.size:
        jumps.step[number], jumps.demand[number] = step, demand
        jumps.limits[number, 0], jumps.limits[number, 1] = before, after
        jumps.number[0] = number + 1


@njit
def peak_before(at: Stand, end: float, search: Search) -> Stand:
    """Return the peak of the demand between a stand and the end of a smooth interval above it, or its end.

    The slope falls, finally as the inverse root of the distance to the detachment; so its zero is sought in that root.
    """
    if not at.h < end:
        return at
    last: Stand = stand_at(end, search)
    if last.slope >= 0.0:
        return last
    if not at.slope > 0.0:
        return at
    left, right = math.sqrt(end - at.h), 0.0  # roots of the distances
    value_left, value_right = at.slope * left, last.slope * math.sqrt(search.beside)
    best = at
    for number in range(_MAX_ITERATIONS):
        part = value_left / (value_left - value_right)
        root = left + (right - left) * (part if number % 3 < 2 and 0.0 < part < 1.0 else 0.5)
        h = end - root * root
        best = stand_at(h, search)
        value = best.slope * root
        if value > 0.0:
            value_right *= 0.5 if left - root < 0.5 * (left - right) else 1.0
            left, value_left = root, value
        else:
            value_left *= 0.5 if root - right < 0.5 * (left - right) else 1.0
            right, value_right = root, value
        if left * left - right * right <= max(_RTOL * (end - at.h), 0.25 * search.beside) or value == 0.0:
            break
    return best


@njit
def through_jumps(at: Stand, target: float, search: Search, jumps: Jumps, step: int) -> Stand:
    """Return the stand after the last jump before ``target``, and record the jumps up to there."""
    for _ in range(_MAX_JUMPS):
        if at.h == math.inf or (at.parted and not search.falls):
            break
        if search.falls:
            event = next_below(search.events, at.h)
            before, after = event + search.beside, event - search.beside
        else:
            after = past_next(search.events, search.beside, at.h)
            before = after - 2.0 * search.beside
        if abs(after) == math.inf:
            break
        peak = peak_before(at, before, search) if not search.falls else stand_at(min(before, at.h), search)
        if peak.demand <= target if search.falls else peak.demand >= target:
            break
        stand(search.asperities)
        beyond = stand_at(after, search)
        stand(search.asperities)
        if beyond.demand <= peak.demand if search.falls else beyond.demand >= peak.demand:
            at = beyond
            continue
        next_at = sink(beyond, peak.demand, search) if search.falls else rise(beyond, peak.demand, search)
        record(jumps, step, peak.demand, peak.h, next_at.h)
        at = next_at
    return at
