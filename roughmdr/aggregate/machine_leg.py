"""A leg of a machine: where the flat stands at each of its steps."""

import math

from roughmdr.aggregate.machine_jumps import record, through_jumps
from roughmdr.aggregate.machine_stand import Jumps, Search, Stand, stand_at
from roughmdr.aggregate.passage import passage, sink
from roughmdr.aggregate.response import stand
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit


@njit
def arrive(target: float, search: Search, jumps: Jumps, step: int) -> Stand:
    """Return where a flat from afar comes to, at most just above first touch; inf under a dead load that pulls.

    Without any load it is pulled down at first touch.
    """
    if search.machine.weight > 0.0 and target > search.first_touch:
        return Stand(target, target, 1.0, 1.0, True, math.nan, math.nan)
    if search.machine.weight == 0.0 and target > 0.0:
        return Stand(math.inf, math.inf, 0.0, 0.0, True, math.nan, math.nan)
    at: Stand = stand_at(search.first_touch + search.beside, search)
    stand(search.asperities)
    if search.events.size and not at.demand > target:
        beyond: Stand = stand_at(search.first_touch - search.beside, search)
        stand(search.asperities)
        if beyond.demand > target:
            snapped: Stand = sink(beyond, target, search)
            record(jumps, step, target, at.h, snapped.h)
            return snapped
        at = stand_at(search.first_touch, search)
        stand(search.asperities)
    return at


@njit
def follow(h: float, demand: Floats, search: Search, separation: Floats, jumps: Jumps) -> None:
    """Fill in the separations [m] of a leg that begins at h [m], inf from afar; inf where a dead load pulls off.

    NaN where a natural scale is not representable. Jumps are recorded where there is room for them.
    """
    at = Stand(h, math.inf, 0.0, 0.0, True, math.nan, math.nan)
    if h < math.inf:
        at = stand_at(h, search)
    for step in range(demand.size):
        target = demand[step]
        if at.h == math.inf and search.falls:
            at = arrive(target, search, jumps, step)
        separation[step] = math.inf
        if at.h < math.inf:
            if jumps.limits.size:
                at = through_jumps(at, target, search, jumps, step)
            at, separation[step] = passage(at, target, search)
        if search.asperities.ready[0] < 0:
            separation[:] = math.nan
            return
