"""The separations of a flat on a machine where the force falls with the separation and has no memory.

The demand of the flat (``machine.py``) then grows with the separation, and each demand of the machine is met once. They
are met one after the other, each by Newton's method from the one before, held between the separations known to lie on
both sides.
"""

import math
from collections.abc import Callable

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.loading.machine import Machine
from roughmdr.numerics.arguments import Floats

_MAX_ROUNDS, _MAX_HALVINGS = 100, 60  # Newton steps to a demand; halvings of a step that leads to no equilibrium
_RTOL = 1e-13  # step over the distance to the first touch, below which it is the last
_FIRST = 2.0**-6  # first guess below first touch, over the depth scale
_LONGEST = 2.0  # longest step down over the distance to the first touch

ForceAndStiffness = Callable[[float], tuple[float, float]]
"""Separation [m] -> force [N] and stiffness -dF/dh [N/m]; NaN where there is no equilibrium."""


def separations_of(
    law: ForceAndStiffness, demand: Floats, machine: Machine, first_touch: float, depth: float, error: float
) -> Floats:
    """Return the separation [m] at each demand of a machine; inf where a dead load has pulled the flat off.

    At ``first_touch`` [m] and above no contact is made, ``depth`` [m] is of the order of a usual indentation, ``error``
    the relative one of the force. OutOfRange where no equilibrium is found.
    """
    separation, last = np.empty(demand.size), first_touch
    for step, asked in enumerate(demand.tolist()):
        if machine.weight * first_touch <= asked:
            at_touch = first_touch if asked == machine.weight * first_touch else asked
            separation[step] = math.inf if machine.is_dead_load and asked > 0.0 else at_touch
            continue
        begin = last if last < first_touch else first_touch - _FIRST * depth
        separation[step] = last = _met(law, asked, machine, first_touch, begin, error)
    return separation


def _met(law: ForceAndStiffness, asked: float, machine: Machine, top: float, h: float, error: float) -> float:
    """Return the separation below ``top`` at which a demand is met, from a first guess."""
    low, high, sound, force = -math.inf, top, top, 0.0
    for _ in range(_MAX_ROUNDS):
        h, force, stiffness = _sound(law, h, sound)
        excess = machine.weight * h - machine.compliance * force - asked
        noise = machine.compliance * error * force
        if abs(excess) <= noise:
            return h
        low, high = (low, h) if excess > 0.0 else (h, high)
        sound, slope = h, machine.slope(stiffness)
        new = h - excess / slope if slope > 0.0 else -math.inf
        new = max(new, h - _LONGEST * (top - h))
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - h) <= _RTOL * (top - h) or new in (low, high):
            return h
        h = new
    if low == -math.inf:
        raise OutOfRange(f"path: the load is out of reach of these contacts, which bear at most {force:g} N")
    raise OutOfRange("path: the separations under the machine do not converge")


def _sound(law: ForceAndStiffness, h: float, sound: float) -> tuple[float, float, float]:
    """Return a separation with its force and stiffness: nearer to a ``sound`` one where there is no equilibrium."""
    for _ in range(_MAX_HALVINGS):
        force, stiffness = law(h)
        if math.isfinite(force + stiffness):
            return h, force, stiffness
        h = 0.5 * (h + sound)
    raise OutOfRange("path: the load is out of reach of these contacts")
