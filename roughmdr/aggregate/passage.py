"""Where the flat on a machine stands: the first separation on a leg at which its demand has passed the machine's.

On the way up the demand w h - c F (``loading.machine``) has a peak before each detachment and drops there; on the way
down it climbs at each touch that pulls. Two bounds tell how far the flat can go before it may have passed:

- up, no contact stiffens, and one that is lost has pulled before: the demand grows by less than w + c (bound of the
  stiffness here) per separation;
- down, contacts stiffen: it falls by less than w + c (bound of the stiffness there).

Between two detachments or touches the demand is concave, so that Newton's method from below does not go beyond its
first root. Both together meet the first root, over any number of detachments.
"""

import math

from roughmdr.aggregate.block import DEPTH_SCALE, law
from roughmdr.aggregate.machine_stand import Jumps, Search, Stand
from roughmdr.numerics.arguments import Floats

_MAX_EVALUATIONS = 1_000_000  # on the way to one demand
_GROWTH = 2.0  # of the distance to the highest place of contact, at most in a step
_WIDE = 2.0  # times the way by the slope alone: as far as contacts are known to be far from any event
_MAX_ROUNDS = 4
_LOOKED_AT = 2.0**-25  # of the distance to the highest place of contact: there the polynomial has all digits
_FIRST_STEP = 2.0**-10  # of the natural depth, where contacts have no stiffness yet


def rise(at: Stand, target: float, search: Search) -> Stand:
    """Return the first stand from here up at which the demand is ``target``; at inf where a dead load has none."""
    for _ in range(_MAX_EVALUATIONS):
        if at.parted or not at.demand < target:
            break
        past, root = law.past_next(search, at.h), law.root_from(at, target)
        smooth = root < past
        if smooth:
            if law.is_last(at, root, search):
                at = law.moved(at, root, target)
                break
            after = root
        else:
            after = max(at.h + (target - at.demand) / at.bound, past) if at.bound > 0.0 else math.inf
            if after == math.inf:
                return Stand(math.inf, target, 0.0, 0.0, True, math.nan, math.nan)
        tried = law.stand_at(after, False, search)
        if tried.demand > target and after - at.h > search.beside:
            tried = law.root_between(at, tried, target, False, search)  # of the bend, or no bound
        elif smooth:
            tried = law.bent(tried, at)
        law.stand(search.asperities)
        at = tried
    if at.parted and target > at.demand:
        h = target if search.machine.weight > 0.0 else math.inf
        return Stand(h, target, at.slope, at.bound, True, math.nan, math.nan)
    return at


def sink(at: Stand, target: float, search: Search) -> Stand:
    """Return the first stand from here down at which the demand is ``target``."""
    deep_h, deep_bound = math.inf, 0.0  # a look further down, whose bound holds up to here
    for _ in range(_MAX_EVALUATIONS):
        excess = at.demand - target
        if not excess > 0.0:
            break
        touch = law.next_below(search, at.h)
        root = law.root_below(at, target, touch, search)
        if root > touch:
            if law.is_last(at, root, search):
                at = law.moved(at, root, target)
                break
            tried = law.bent(law.stand_at(root, True, search), at)
            if tried.demand <= target:
                at = law.root_between(tried, at, target, True, search)
                break
        else:
            safe = at.h - excess / deep_bound if deep_bound > 0.0 else -math.inf
            tried = at
            if not deep_h <= safe:
                tried = law.stand_at(root, True, search)
                deep_h, deep_bound = root, tried.bound
                safe = at.h - excess / deep_bound if deep_bound > 0.0 else -math.inf
            if safe > root:
                if safe >= touch:  # it may pass before the touch
                    if touch + search.beside < at.h:
                        tried = law.stand_at(touch + search.beside, True, search)
                        if tried.demand <= target:
                            at = law.root_between(tried, at, target, True, search)
                            break
                    safe = touch - search.beside
                tried = law.stand_at(safe, True, search)
        law.stand(search.asperities)
        at = tried
    return at


def passage(at: Stand, target: float, falls: bool, search: Search) -> Stand:
    """Return the first stand from here, in the sense of the leg, at which the demand is ``target``.

    It is sought among the contacts near an event, all others being taken from looks before, and then looked at.
    """
    far = search.asperities.far
    way = _WIDE * abs(target - at.demand) / at.slope if at.slope > 0.0 else 0.0
    for _ in range(_MAX_ROUNDS if law.hardening and not at.parted else 0):
        groups = law.far_groups(at.h, at.h - way if falls else at.h + way, falls, search.asperities.height, far)
        if groups == 0:
            break
        far.number[1] = groups
        found: Stand = law.sink(at, target, search) if falls else law.rise(at, target, search)
        far.number[1] = 0
        if not abs(found.h - at.h) <= way:
            break
        looked = law.stand_at(found.h, falls, search)
        law.stand(search.asperities)
        root, near = law.root_from(looked, target), _LOOKED_AT * abs(search.top - looked.h)
        if not abs(root - looked.h) <= near or law.next_below(search, max(root, looked.h)) >= min(root, looked.h):
            continue
        far.number[1] = groups
        there: Stand = law.stand_at(root, falls, search)
        far.number[1] = 0
        last = law.root_from(there, target)
        if abs(last - root) <= _LOOKED_AT * near:
            end: Stand = law.moved(there, last, target)
            return end
    reached: Stand = law.sink(at, target, search) if falls else law.rise(at, target, search)
    return reached


def root_below(at: Stand, target: float, touch: float, search: Search) -> float:
    """Return where Newton's method goes down, not much deeper than contacts are already; at most to the first touch."""
    root = law.root_from(at, target)
    root = -math.inf if math.isnan(root) else root
    if at.parted and touch > -math.inf:
        return float(max(root, touch))
    depth = search.asperities.max_scales[0, DEPTH_SCALE]
    return float(max(root, at.h - max(_GROWTH * (search.top - at.h), _FIRST_STEP * depth)))


def root_between(low: Stand, high: Stand, target: float, falls: bool, search: Search) -> Stand:
    """Return the stand with a demand between two, by Newton's method from the lower one."""
    left, right = low.h, high.h
    at: Stand = law.bent(low, high)
    for _ in range(_MAX_EVALUATIONS):
        h = law.root_from(at, target)
        if left <= h <= right and law.is_last(at, h, search):
            at = law.moved(at, h, target)
            break
        if not left < h < right:
            h = left + 0.5 * (right - left)
            if not left < h < right:
                break
        at = law.bent(law.stand_at(h, falls, search), at)
        if at.demand <= target:
            left = h
        else:
            right = h
        law.stand(search.asperities)
    return at


def follow(h: float, demand: Floats, falls: bool, search: Search, separation: Floats, jumps: Jumps) -> None:
    """Fill in the separations [m] of a leg that begins at h [m], inf from afar; inf where a dead load pulls off.

    NaN where a natural scale is not representable. Jumps are recorded where there is room for them.
    """
    at = Stand(h, math.inf, 0.0, 0.0, True, math.nan, math.nan)
    law.block_at(search.asperities, 0)  # its depths are the scale of first steps
    if h < math.inf:
        at = law.stand_at(h, falls, search)
    for step in range(demand.size):
        target = demand[step]
        if at.h == math.inf and falls:
            at = law.arrive(target, search, jumps, step)
        if at.h < math.inf:
            if jumps.limits.size:
                at = law.through_jumps(at, target, falls, search, jumps, step)
            at = law.passage(at, target, falls, search)
        separation[step] = law.rounded(at, target, falls, search)
        if search.asperities.ready[0] < 0:
            separation[:] = math.nan
            return


def arrive(target: float, search: Search, jumps: Jumps, step: int) -> Stand:
    """Return where a flat from afar comes to, at most just above first touch; inf under a dead load that pulls.

    Without any load it is pulled down at first touch.
    """
    if search.machine.weight > 0.0 and target > search.first_touch:
        return Stand(target, target, 1.0, 1.0, True, math.nan, math.nan)
    if search.machine.weight == 0.0 and target > 0.0:
        return Stand(math.inf, math.inf, 0.0, 0.0, True, math.nan, math.nan)
    at: Stand = law.stand_at(search.first_touch + search.beside, True, search)
    law.stand(search.asperities)
    if law.adhesive and not at.demand > target:
        beyond: Stand = law.stand_at(search.first_touch - search.beside, True, search)
        law.stand(search.asperities)
        if beyond.demand > target:
            snapped: Stand = law.sink(beyond, target, search)
            law.record(jumps, step, target, at.h, snapped.h)
            return snapped
        at = law.stand_at(search.first_touch, True, search)
        law.stand(search.asperities)
    return at


def record(jumps: Jumps, step: int, demand: float, before: float, after: float) -> None:
    """Record a jump, where there is room for it."""
    number = jumps.number[0]
    if number < jumps.step.size:
        jumps.step[number], jumps.demand[number] = step, demand
        jumps.limits[number, 0], jumps.limits[number, 1] = before, after
        jumps.number[0] = number + 1
