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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.block import DEPTH_SCALE, law
from roughmdr.aggregate.response import Asperities, Memory, Response
from roughmdr.loading.machine import Machine
from roughmdr.numerics.arguments import Floats

_MAX_EVALUATIONS = 1_000_000  # on the way to one demand
_LAST = 4.0  # roundings: a shorter step of Newton's method is the last
_GRID = 2.0**-45  # of the distance to the highest place of contact: the last digit of a separation
_DOUBTFUL = 2.0**-3  # of that: nearer to the middle of two such separations the demand there decides
_GROWTH = 2.0  # of the distance to the highest place of contact, at most in a step
_FIRST_STEP = 2.0**-10  # of the natural depth, where contacts have no stiffness yet


class Stand(NamedTuple):
    """Where the flat stands, or a separation that it is tried at."""

    h: float
    """[m]"""
    demand: float
    """[m] or [N], as of ``Machine``."""
    slope: float
    """d(demand)/dh."""
    bound: float
    """Upper bound of the slope for these contacts at a higher flat."""
    parted: bool
    """Whether no contact is left."""


class Search(NamedTuple):
    """A leg on which passages are sought."""

    machine: Machine
    asperities: Asperities
    memory: Memory
    events: Floats
    """Separations [m], ascending, at which contacts are lost on the way up, or made on the way down."""
    first_touch: float
    """The separation [m] at which the first contact is made."""
    top: float
    """A separation [m] at or above all at which there is contact."""
    beside: float
    """A few roundings of any separation [m]."""


class Jumps(NamedTuple):
    """The jumps of a leg, and room for more; no room at all where they are not asked for."""

    number: NDArray[np.int64]
    """How many there are."""
    step: NDArray[np.int64]
    """Before which step of the leg each is."""
    limits: Floats
    """Separations [m] before and after each, [jump, 2]; inf after it where a dead load pulls off."""
    demand: Floats
    """The demand of the machine at each."""


def stand_at(h: float, falls: bool, search: Search) -> Stand:
    """Try the flat at h."""
    answer: Response = law.response(h, falls, search.asperities, search.memory)
    w, c = search.machine
    parted = answer.bound == 0.0 and answer.stiffness == 0.0 and answer.force == 0.0
    return Stand(h, w * h - c * answer.force, w + c * answer.stiffness, w + c * answer.bound, parted)


def past_next(search: Search, h: float) -> float:
    """Return a separation just past the next detachment above h; inf where there is none."""
    number = np.searchsorted(search.events, h - search.beside, side="right")
    return search.events[number] + search.beside if number < search.events.size else math.inf


def next_below(search: Search, h: float) -> float:
    """Return the next touch below h; -inf where there is none."""
    number = np.searchsorted(search.events, h, side="left")
    return search.events[number - 1] if number > 0 else -math.inf


def rise(at: Stand, target: float, search: Search) -> Stand:
    """Return the first stand from here up at which the demand is ``target``; at inf where a dead load has none."""
    for _ in range(_MAX_EVALUATIONS):
        missing = target - at.demand
        if at.parted or not missing > 0.0:
            break
        past = law.past_next(search, at.h)
        root = at.h + missing / at.slope if at.slope > 0.0 else math.inf
        if root < past:
            if root - at.h <= _LAST * np.spacing(max(abs(at.h), abs(root))):
                break
            after = root
        else:
            after = max(at.h + missing / at.bound, past) if at.bound > 0.0 else math.inf
            if after == math.inf:
                return Stand(math.inf, target, 0.0, 0.0, True)
        tried = law.stand_at(after, False, search)
        if tried.demand > target and after - at.h > search.beside:
            tried = law.root_between(at, tried, target, False, search)  # the bound does not hold
        law.stand(search.asperities)
        at = tried
    if at.parted and target > at.demand:
        return Stand(target if search.machine.weight > 0.0 else math.inf, target, at.slope, at.bound, True)
    return at


def sink(at: Stand, target: float, search: Search) -> Stand:
    """Return the first stand from here down at which the demand is ``target``."""
    for _ in range(_MAX_EVALUATIONS):
        excess = at.demand - target
        if not excess > 0.0:
            break
        touch = law.next_below(search, at.h)
        root = law.root_below(at, excess, touch, search)
        tried: Stand = law.stand_at(root, True, search)
        if root <= touch:
            safe = at.h - excess / tried.bound if tried.bound > 0.0 else -math.inf
            if root < safe < touch:
                tried = law.stand_at(safe, True, search)
            elif safe >= touch:  # it may pass before the touch
                root = touch + search.beside
                tried = law.stand_at(min(root, at.h), True, search)
        if tried.demand <= target and root > touch:
            reached: Stand = law.root_between(tried, at, target, True, search)
            return reached
        if root > touch and root - touch <= search.beside:
            tried = law.stand_at(touch - search.beside, True, search)
        law.stand(search.asperities)
        at = tried
    return at


def root_below(at: Stand, excess: float, touch: float, search: Search) -> float:
    """Return where Newton's method goes down, not much deeper than contacts are already; at most to the first touch."""
    root = at.h - excess / at.slope if at.slope > 0.0 else -math.inf
    if at.parted and touch > -math.inf:
        return max(root, touch)
    depth = search.asperities.max_scales[0, DEPTH_SCALE]
    return float(max(root, at.h - max(_GROWTH * (search.top - at.h), _FIRST_STEP * depth)))


def root_between(low: Stand, high: Stand, target: float, falls: bool, search: Search) -> Stand:
    """Return the stand with a demand between two, by Newton's method from the lower one."""
    left, right, at = low.h, high.h, low
    for _ in range(_MAX_EVALUATIONS):
        h = at.h + (target - at.demand) / at.slope if at.slope > 0.0 else math.inf
        if abs(h - at.h) <= _LAST * np.spacing(max(abs(left), abs(right))):
            break
        if not left < h < right:
            h = left + 0.5 * (right - left)
            if not left < h < right:
                break
        at = law.stand_at(h, falls, search)
        if at.demand <= target:
            left = h
        else:
            right = h
    law.stand(search.asperities)
    return at


def rounded(at: Stand, target: float, falls: bool, search: Search) -> float:
    """Return the separation [m] with so many digits that it does not depend on where the search for it began."""
    if at.h == math.inf or at.parted:
        return at.h
    h = at.h + (target - at.demand) / at.slope if at.slope > 0.0 else at.h
    off = search.top - h
    grid = max(math.ldexp(_GRID, math.ceil(math.log2(off))), search.beside) if 0.0 < off < math.inf else 0.0
    if grid == 0.0:
        return h
    number = math.floor(off / grid)
    part = off / grid - number
    if abs(part - 0.5) < _DOUBTFUL:
        middle = law.stand_at(search.top - (number + 0.5) * grid, falls, search)
        part = 0.0 if middle.demand < target else 1.0
    return search.top - (number + (1.0 if part > 0.5 else 0.0)) * grid


def follow(h: float, demand: Floats, falls: bool, search: Search, separation: Floats, jumps: Jumps) -> None:
    """Fill in the separations [m] of a leg that begins at h [m], inf from afar; inf where a dead load pulls off.

    NaN where a natural scale is not representable. Jumps are recorded where there is room for them.
    """
    at = Stand(h, math.inf, 0.0, 0.0, True)
    if h < math.inf:
        at = law.stand_at(h, falls, search)
    for step in range(demand.size):
        target = demand[step]
        if at.h == math.inf and falls:
            at = law.arrive(target, search)
        if at.h < math.inf:
            if jumps.limits.size:
                at = law.through_jumps(at, target, falls, search, jumps, step)
            at = law.sink(at, target, search) if falls else law.rise(at, target, search)
        separation[step] = law.rounded(at, target, falls, search)
        if search.asperities.ready[0] < 0:
            separation[:] = math.nan
            return


def arrive(target: float, search: Search) -> Stand:
    """Return where a flat from afar comes to, at most just above first touch; inf under a dead load that pulls."""
    if search.machine.weight > 0.0 and target > search.first_touch:
        return Stand(target, target, 1.0, 1.0, True)
    if search.machine.weight == 0.0 and target > 0.0:
        return Stand(math.inf, math.inf, 0.0, 0.0, True)
    at: Stand = law.stand_at(search.first_touch + search.beside, True, search)
    law.stand(search.asperities)
    return at
