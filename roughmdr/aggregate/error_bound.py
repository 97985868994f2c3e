"""How far the sum of the forces of a block can be off.

A kernel finds the state t of a contact where the indentation D, as it computes it, is z - h. With all digits D(t)
is off by some eta, and the right state is the t* with D(t*) = z - h. So the force is off by what P(t) is computed
wrongly by, and by |P(t) - P(t*)|. That is at most m |k(t)| eta, whichever way k goes along the branch:

- Far from a fold k is all but the same from t to t*, and m is 1.
- Next to a smooth fold P goes with y = t - t_c, and D - D_c with y^2, where two folds are about to meet with y^3, or
  with something between. Upwards dy/dD falls, and m is 1. Downwards t* is no further off than the fold itself, and
  from there on y/(D - D_c) is 2 or 3 times dy/dD at t. So m is 2 or 3, however close the fold is.
- Where t is so close to a fold that no digit of the slope of D is left, what is computed for |k| is some a/u, and |k|
  eta, with eta >= u dl, no less than the force itself.

eta is made of the roundings of z - h and of the depth, which times m are at most 4 u (|z| + |h| + depth); those of
x are as small as D - D_c is there. Where D is computed as g - dl, the errors of both come to it, some u (g + dl),
and g is z - h + dl. Where the state comes from the distance to the fold itself, it has none of these.
"""

import math
from collections.abc import Callable
from typing import Any

from roughmdr.aggregate.contacts import FORCE, RADIUS, STATE, STIFFNESS
from roughmdr.aggregate.scales import DEPTH, LOAD, PER_DEPTH, RIGIDITY
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import ROUNDING
from roughmdr.numerics.summation import least

_NEXT_TO_A_FOLD = 3.0  # m

# Names that ``specialise`` fills with the kernels of a law.
_adhesive: bool
_state: Callable[..., float]
_force: Callable[..., float]
_stiffness: Callable[..., float]
_errors: Callable[..., tuple[float, float]]
_pulled: Callable[..., tuple[float, float]]
_magnitude: Callable[..., tuple[float, float]] | None
_own: Callable[..., Any]
_mixed: Callable[..., bool]


def worst(count: int, z: Floats, h: float, slope: float, push: float, swing: float, greatest: Floats) -> float:
    """The error [N] of ``count`` contacts whose |k| add up to ``slope`` [N/m] and the errors of whose forces, each at
    its state, to ``push`` [N]; z - h, as a term of the computed indentation, has a relative error of ``swing``.
    """
    deepest = greatest[DEPTH] if _adhesive else 0.0
    farthest = max(abs(z[0]), abs(z[count - 1])) + abs(h) + deepest
    return float(slope * (4.0 * ROUNDING + _NEXT_TO_A_FOLD * swing) * farthest + push)


def bound(
    count: int,
    z: Floats,
    params: Floats,
    h: float,
    retracted: bool,
    scales: Floats,
    greatest: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
) -> float:
    """A bound on the error [N] of what the first ``count`` asperities of a block add to the force.

    For laws whose k grows along the branch, from -inf at the fold of a cone or a paraboloid, so that |k| is largest in
    the least or the greatest state: two calls bound a block of one form. Only a retraction brings a state below that of
    first touch, x = 1.
    """
    high = _state(((z[0] - h) + (greatest[DEPTH] if _adhesive else 0.0)) * greatest[PER_DEPTH], _own(params, 0))
    low = high
    if _adhesive:
        low = _state(1.0, _own(params, 0))
        if retracted:
            for i in range(count):
                terms[i] = found[STATE, i] if held[i] > 0.0 else math.inf
            low = max(min(low, least(terms, count)), ROUNDING)
    slope = max(abs(_stiffness(low, _own(params, 0))), abs(_stiffness(high, _own(params, 0))))
    least_push = 1.0 if _adhesive else 0.0  # without adhesion the natural force is no force of this contact
    push = max(least_push, abs(_force(high, _own(params, 0)))) * _errors(_own(params, 0))[0]
    if _mixed(params):
        for i in range(count):
            slope = max(slope, abs(_stiffness(max(found[STATE, i], low), _own(params, i))))
            push = max(push, abs(_force(found[STATE, i], _own(params, i))) * _errors(_own(params, i))[0])
    slope, push = count * slope * greatest[RIGIDITY], count * push * greatest[LOAD]
    return worst(count, z, h, slope, push, 0.0, greatest)


def bound_found(
    count: int,
    z: Floats,
    params: Floats,
    h: float,
    retracted: bool,
    scales: Floats,
    greatest: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
) -> float:
    """The bound where P and k were found with the state: one by one, so that nothing is asked of how k goes."""
    slope, push, swing = 0.0, 0.0, 0.0
    for i in range(count):
        if not _adhesive or held[i] > 0.0:
            own, each = _errors(_own(params, i))
            k, stretch, share = abs(found[STIFFNESS, i]), 0.0, 0.0
            if _adhesive:
                stretch, share = _pulled(found[RADIUS, i], _own(params, i))
                if k == math.inf:  # on the fold itself
                    k = share / stretch / ROUNDING
            off = own * (abs(found[FORCE, i]) + 2.0 * share) + 2.0 * _NEXT_TO_A_FOLD * each * k * stretch
            if _magnitude is not None:
                g, pushed = _magnitude(found[STATE, i], _own(params, i))
                off += own * pushed + _NEXT_TO_A_FOLD * each * k * g
            slope, push, swing = slope + scales[RIGIDITY, i] * k, push + scales[LOAD, i] * off, max(swing, each)
    return worst(count, z, h, slope, push, swing, greatest)
