"""How far the sum of the forces of a block can be off."""

import math
from collections.abc import Callable
from typing import Any

from roughmdr.aggregate.block import least
from roughmdr.aggregate.scales import DEPTH, LOAD, PER_DEPTH, RIGIDITY
from roughmdr.aggregate.settle import FORCE, STATE, STIFFNESS
from roughmdr.arguments import Floats

_UNIT = 2.0**-53  # the largest relative error of one rounding
# Of the force of a contact over its natural scale, as the kernels are tested; the second where adhesion has a range.
_KERNEL_ERROR, _KERNEL_ERROR_COHESIVE = 1e-13, 1e-12

# Names that ``specialise`` fills with the kernels of a law.
_adhesive: bool
_cohesive: bool
_curved: bool
_state: Callable[..., float]
_force: Callable[..., float]
_stiffness: Callable[..., float]
_own: Callable[..., Any]
_mixed: Callable[..., bool]


def worst(count: int, z: Floats, h: float, slope: float, push: float, greatest: Floats) -> float:
    """The error [N] of ``count`` contacts whose reduced stiffness and force are at most ``slope`` and ``push``."""
    deepest = greatest[DEPTH] if _adhesive else 0.0
    rounding = 4.0 * _UNIT * (max(abs(z[0]), abs(z[count - 1])) + abs(h) + deepest)
    own = _KERNEL_ERROR_COHESIVE if _cohesive else _KERNEL_ERROR
    each = slope * greatest[RIGIDITY] * rounding + own * push * greatest[LOAD]
    return float(count * each)


def bound(
    count: int,
    z: Floats,
    forms: Floats,
    h: float,
    retracted: bool,
    greatest: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
) -> float:
    """A bound on the error [N] of what the first ``count`` asperities of a block add to the force.

    Each force is off by |k| times the rounding of z - h and of the fold, and by what its kernel is off. k grows along
    the branch, so that |k| is largest in the least or the greatest state: two calls bound a block of one form. Only
    a retraction brings a state below that of first touch, x = 1.
    """
    deepest = greatest[DEPTH] if _adhesive else 0.0
    high = _state(((z[0] - h) + deepest) * greatest[PER_DEPTH], _own(forms, 0))
    low = high
    if _adhesive:
        low = _state(1.0, _own(forms, 0))
        if retracted:
            for i in range(count):
                terms[i] = found[STATE, i] if held[i] > 0.0 else math.inf
            low = max(min(low, least(terms, count)), _UNIT)
    slope = max(abs(_stiffness(low, _own(forms, 0))), abs(_stiffness(high, _own(forms, 0))))
    least_push = 1.0 if _adhesive else 0.0  # without adhesion the natural force is no force of this contact
    push = max(least_push, abs(_force(high, _own(forms, 0))))
    if _mixed(forms):
        for i in range(count):
            slope = max(slope, abs(_stiffness(max(found[STATE, i], low), _own(forms, i))))
            push = max(push, abs(_force(found[STATE, i], _own(forms, i))))
    return worst(count, z, h, slope, push, greatest)


def bound_found(
    count: int,
    z: Floats,
    forms: Floats,
    h: float,
    retracted: bool,
    greatest: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
) -> float:
    """The same where P and k were found with the state: one by one."""
    slope = 0.0
    push = 1.0 if _adhesive and not _curved else 0.0  # that of a shape with a width is no force of this contact
    for i in range(count):
        if not _adhesive or held[i] > 0.0:
            slope = max(slope, abs(found[STIFFNESS, i]))
            push = max(push, abs(found[FORCE, i]))
    return worst(count, z, h, slope, push, greatest)
