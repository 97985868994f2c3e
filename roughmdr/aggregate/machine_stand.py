"""The flat on a machine at one separation: its demand there, and the separation at which it has another demand."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.response import Asperities, Memory, Response
from roughmdr.loading.machine import Machine
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_LAST = 4.0  # roundings: a shorter step of Newton's method is the last
_GRID = 2.0**-45  # grid that separations are rounded to, over the power of 2 above the depth below ``top``
_DOUBTFUL = 2.0**-4  # distance from the middle of two grid points, over the grid, below which the demand there decides
_NEGLIGIBLE = 2.0**-51  # error of a root, over its depth below ``top``, at which the search ends: two roundings
_NEAR = 2.0**-25  # longest last step, over the same depth: Newton's error, its square, is about a rounding
_MOST_BENT = 0.25  # largest correction of Newton's step by the bend, over the step: beyond, the slope alone is used


class Stand(NamedTuple):
    """Where the flat stands, or a separation that it is tried at."""

    h: float
    """[m]"""
    demand: float
    """Demand of the ``Machine`` [m] or [N]."""
    slope: float
    """d(demand)/dh."""
    bound: float
    """Upper bound of the slope with the same contacts at any higher flat."""
    parted: bool
    """Whether no contact is left."""
    bend: float
    """d(slope)/dh; NaN where it is not known."""
    twist: float
    """Error of ``bend``, per separation."""


class Search(NamedTuple):
    """A leg on which passages are sought."""

    look: Callable[[float, bool, Asperities, Memory], Response]
    """The ``response`` of these asperities, compiled."""
    falls: bool
    """Whether the flat comes down."""
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
    """The jumps of a leg, in arrays with room for more; arrays are empty where jumps are not asked for."""

    number: NDArray[np.int64]
    """Number of jumps so far."""
    step: NDArray[np.int64]
    """Step of the leg that each jump comes before."""
    limits: Floats
    """Separations [m] before and after each, [jump, 2]; inf after it where a dead load pulls off."""
    demand: Floats
    """The demand of the machine at each."""


@njit
def stand_at(h: float, search: Search) -> Stand:
    """Try the flat at h."""
    answer: Response = search.look(h, search.falls, search.asperities, search.memory)
    w, c = search.machine
    parted = answer.bound == 0.0 and answer.stiffness == 0.0 and answer.force == 0.0
    return Stand(
        h, w * h - c * answer.force, w + c * answer.stiffness, w + c * answer.bound, parted, math.nan, math.nan
    )


@njit
def bent(at: Stand, before: Stand) -> Stand:
    """Return a stand with the bend of the demand, from it and an earlier stand without a jump between them."""
    way = at.h - before.h
    if way == 0.0:
        return at
    bend = (at.slope - before.slope) / way
    twist = 12.0 * abs((at.demand - before.demand) / way - 0.5 * (at.slope + before.slope)) / abs(way)
    return Stand(at.h, at.demand, at.slope, at.bound, at.parted, bend, twist)


@njit
def root_from(at: Stand, target: float) -> float:
    """Return the separation where the demand is ``target``, by its slope and, if known, its bend; NaN if it falls."""
    if not at.slope > 0.0:
        return math.nan
    way = (target - at.demand) / at.slope
    turn = 0.5 * at.bend / at.slope * way
    return at.h + (way * (1.0 - turn) if abs(turn) < _MOST_BENT else way)


@njit
def is_last(at: Stand, root: float, top: float) -> bool:
    """Return whether a root is so near that the demand need not be looked at there."""
    way, distance = abs(root - at.h), abs(top - root)
    if way <= _LAST * np.spacing(max(abs(at.h), abs(root))):
        return True
    turn = at.bend / at.slope * way
    off = turn * turn * way + at.twist / at.slope * way * way
    return bool(way <= _NEAR * distance and off <= _NEGLIGIBLE * distance)


@njit
def moved(at: Stand, root: float, target: float) -> Stand:
    """Return the stand at a root that is so near that nothing is computed there."""
    slope = at.slope + at.bend * (root - at.h) if not math.isnan(at.bend) else at.slope
    return Stand(root, target, slope, at.bound, at.parted, at.bend, at.twist)


@njit
def count_below(events: Floats, h: float) -> int:
    """Return how many of the ascending events are below h."""  # numpy's searchsorted takes seconds to compile
    low, high = 0, events.size
    while low < high:
        middle = (low + high) // 2
        if events[middle] < h:
            low = middle + 1
        else:
            high = middle
    return low


@njit
def past_next(events: Floats, beside: float, h: float) -> float:
    """Return a separation just past the next detachment above h; inf where there is none."""
    number = count_below(events, np.nextafter(h - beside, math.inf))
    return events[number] + beside if number < events.size else math.inf


@njit
def next_below(events: Floats, h: float) -> float:
    """Return the next touch below h; -inf where there is none."""
    number = count_below(events, h)
    return events[number - 1] if number > 0 else -math.inf


@njit
def rounded(at: Stand, target: float, search: Search) -> float:
    """Return the separation [m] with so many digits that it does not depend on where the search for it began."""
    if at.h == math.inf or at.parted:
        return at.h
    h = at.h
    off = search.top - h
    grid = max(math.ldexp(_GRID, math.ceil(math.log2(off))), search.beside) if 0.0 < off < math.inf else 0.0
    if grid == 0.0:
        return h
    number = math.floor(off / grid)
    part = off / grid - number
    if abs(part - 0.5) < _DOUBTFUL:
        middle = stand_at(search.top - (number + 0.5) * grid, search)
        part = 0.0 if middle.demand < target else 1.0
    near: float = search.top - (number + (1.0 if part > 0.5 else 0.0)) * grid
    crossed = next_below(search.events, max(h, near)) >= min(h, near)
    return h if crossed else near
