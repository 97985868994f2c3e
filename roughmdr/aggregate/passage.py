"""Where the flat on a machine stands: the first separation on a leg at which its demand has passed the machine's.

On the way up the demand w h - c F (``loading.machine``) has a peak before each detachment and drops there; on the way
down it climbs at each touch that pulls. Two bounds limit the distance to the first passage:

- up, no contact stiffens, and one that is lost has pulled before: the demand grows by less than w + c (bound of the
  stiffness here) per separation;
- down, contacts stiffen: it falls by less than w + c (bound of the stiffness there).

Between two detachments or touches the demand is concave, so that Newton's method from below does not go beyond its
first root. The bounds and Newton's method together find the first root, over any number of detachments.
"""

import math

from roughmdr.aggregate.block import DEPTH_SCALE
from roughmdr.aggregate.far_contacts import far_groups
from roughmdr.aggregate.machine_stand import (
    Search,
    Stand,
    bent,
    is_last,
    moved,
    next_below,
    past_next,
    root_from,
    rounded,
    stand_at,
)
from roughmdr.aggregate.response import stand
from roughmdr.numerics.jit import njit

_MAX_EVALUATIONS = 1_000_000  # bound on the steps of one search, which takes a few
_GROWTH = 2.0  # longest step down, over the depth below ``top``: deeper, the slope here says little
_WIDE = 2.0  # search window, over Newton's step: groups with an event inside are evaluated, all others extrapolated
_MAX_ROUNDS = 4
_LOOKED_AT = 2.0**-25  # distance from a look, over the depth below ``top``, within which the polynomial has all digits
_FIRST_STEP = 2.0**-10  # least bound of a step down, over the natural depth: at first touch there is no stiffness yet


@njit
def root_below(at: Stand, target: float, touch: float, top: float, depth: float) -> float:
    """Return the next separation of Newton's method downward: not much deeper than contacts are, or than ``touch``."""
    root = root_from(at, target)
    root = -math.inf if math.isnan(root) else root
    if at.parted and touch > -math.inf:
        return float(max(root, touch))
    return float(max(root, at.h - max(_GROWTH * (top - at.h), _FIRST_STEP * depth)))


@njit
def root_between(low: Stand, high: Stand, target: float, search: Search) -> Stand:
    """Return the stand with a demand between two, by Newton's method from the lower one."""
    left, right = low.h, high.h
    at: Stand = bent(low, high)
    for _ in range(_MAX_EVALUATIONS):
        h = root_from(at, target)
        if left <= h <= right and is_last(at, h, search.top):
            at = moved(at, h, target)
            break
        if not left < h < right:
            h = left + 0.5 * (right - left)
            if not left < h < right:
                break
        at = bent(stand_at(h, search), at)
        if at.demand <= target:
            left = h
        else:
            right = h
        stand(search.asperities)
    return at


@njit
def rise(at: Stand, target: float, search: Search) -> Stand:
    """Return the first stand from here up at which the demand is ``target``; at inf where a dead load has none."""
    for _ in range(_MAX_EVALUATIONS):
        if at.parted or not at.demand < target:
            break
        past, root = past_next(search.events, search.beside, at.h), root_from(at, target)
        smooth = root < past
        if smooth:
            if is_last(at, root, search.top):
                at = moved(at, root, target)
                break
            after = root
        else:
            after = max(at.h + (target - at.demand) / at.bound, past) if at.bound > 0.0 else math.inf
            if after == math.inf:
                return Stand(math.inf, target, 0.0, 0.0, True, math.nan, math.nan)
        tried = stand_at(after, search)
        if tried.demand > target and after - at.h > search.beside:
            tried = root_between(at, tried, target, search)  # the demand bends, or its bound fails
        elif smooth:
            tried = bent(tried, at)
        stand(search.asperities)
        at = tried
    if at.parted and target > at.demand:
        h = target if search.machine.weight > 0.0 else math.inf
        return Stand(h, target, at.slope, at.bound, True, math.nan, math.nan)
    return at


@njit
def sink(at: Stand, target: float, search: Search) -> Stand:
    """Return the first stand from here down at which the demand is ``target``."""
    depth = search.asperities.max_scales[0, DEPTH_SCALE]
    deep_h, deep_bound = math.inf, 0.0  # a look further down, whose bound holds up to here
    for _ in range(_MAX_EVALUATIONS):
        excess = at.demand - target
        if not excess > 0.0:
            break
        touch = next_below(search.events, at.h)
        root = root_below(at, target, touch, search.top, depth)
        if root > touch:
            if is_last(at, root, search.top):
                at = moved(at, root, target)
                break
            tried = bent(stand_at(root, search), at)
            if tried.demand <= target:
                at = root_between(tried, at, target, search)
                break
        else:
            safe = at.h - excess / deep_bound if deep_bound > 0.0 else -math.inf
            tried = at
            if not deep_h <= safe:
                tried = stand_at(root, search)
                deep_h, deep_bound = root, tried.bound
                safe = at.h - excess / deep_bound if deep_bound > 0.0 else -math.inf
            if safe > root:
                if safe >= touch:  # it may pass before the touch
                    if touch + search.beside < at.h:
                        tried = stand_at(touch + search.beside, search)
                        if tried.demand <= target:
                            at = root_between(tried, at, target, search)
                            break
                    safe = touch - search.beside
                tried = stand_at(safe, search)
        stand(search.asperities)
        at = tried
    return at


@njit
def passage(at: Stand, target: float, search: Search) -> tuple[Stand, float]:
    """Return the first stand on the leg at which the demand is ``target``, and its separation [m], rounded.

    Contacts near an event are evaluated in the search, all others interpolated; then all are evaluated at the root.
    """
    far, falls = search.asperities.far, search.falls
    way = _WIDE * abs(target - at.demand) / at.slope if at.slope > 0.0 else 0.0
    for _ in range(0 if at.parted else _MAX_ROUNDS):
        groups = far_groups(at.h, at.h - way if falls else at.h + way, falls, search.asperities.height, far)
        if groups == 0:
            break
        far.number[1] = groups
        found: Stand = sink(at, target, search) if falls else rise(at, target, search)
        far.number[1] = 0
        if not abs(found.h - at.h) <= way:
            break
        looked = stand_at(found.h, search)
        stand(search.asperities)
        root, near = root_from(looked, target), _LOOKED_AT * abs(search.top - looked.h)
        if not abs(root - looked.h) <= near or next_below(search.events, max(root, looked.h)) >= min(root, looked.h):
            continue
        far.number[1] = groups
        there: Stand = stand_at(root, search)
        last = root_from(there, target)
        if abs(last - root) <= _LOOKED_AT * near:
            end: Stand = moved(there, last, target)
            h = rounded(end, target, search)
            far.number[1] = 0
            return end, h
        far.number[1] = 0
    reached: Stand = sink(at, target, search) if falls else rise(at, target, search)
    return reached, rounded(reached, target, search)
