"""The state of each contact of a block at one step, and what follows from it.

``found`` has a row for the state, and where the law has an ``answer`` one each for a, P and k, which then come
together; else each is computed from the state when it is asked for.
"""

from collections.abc import Callable
from typing import Any

from roughmdr.aggregate.scales import DEPTH, PER_DEPTH
from roughmdr.numerics.arguments import Floats

STATE, RADIUS, FORCE, STIFFNESS = range(4)
FOUND = 4

# Names that ``specialise`` fills with the kernels of a law.
_adhesive: bool
_branched: bool
_passes: int
_state: Callable[..., float]
_state_on: Callable[..., float]
_rung: Callable[..., float]
_guess: Callable[..., float]
_nearer: Callable[..., tuple[float, float, float]]
_arrived: Callable[..., bool]
_answer: Callable[..., tuple[float, float, float]]
_radius: Callable[..., float]
_force: Callable[..., float]
_stiffness: Callable[..., float]
_own: Callable[..., Any]


def hold(count: int, z: Floats, begin: int, end: int, bottom: Floats, top: Floats, depth: Floats, held: Floats) -> None:
    """Whether each of the first ``count`` contacts holds on (1) or not (0), by the staircase."""
    low, high = bottom[begin], top[begin]
    for i in range(count):
        held[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else 0.0
    for j in range(begin + 1, end):
        low, high = bottom[j], top[j]
        for i in range(count):
            held[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else held[i]


def conclude(count: int, params: Floats, found: Floats) -> None:
    """Find a, P and k of the first ``count`` contacts."""
    a, force, stiffness = found[RADIUS], found[FORCE], found[STIFFNESS]
    for i in range(count):
        a[i], force[i], stiffness[i] = _answer(found[STATE, i], _own(params, i))


def leave(count: int, params: Floats, found: Floats) -> None:
    """Leave a, P and k to who asks for them."""


def settle(
    count: int,
    z: Floats,
    params: Floats,
    h: float,
    reach: float,
    begin: int,
    end: int,
    bottom: Floats,
    top: Floats,
    scales: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
) -> None:
    """Find the first ``count`` contacts with the flat at h, and in ``held`` whether each holds on (1) or not (0).

    Without adhesion all of them do, and ``held`` is left alone. What does not hold on has the state of first touch.
    """
    depth, per_depth, state = scales[DEPTH], scales[PER_DEPTH], found[STATE]
    if _adhesive:
        hold(count, z, begin, end, bottom, top, depth, held)
        for i in range(count):
            x = ((z[i] - h) + depth[i]) * per_depth[i]
            state[i] = _state(x if held[i] > 0.0 else 1.0, _own(params, i))
    else:
        for i in range(count):
            state[i] = _state((z[i] - h) * per_depth[i], _own(params, i))
    conclude(count, params, found)


def settle_curved(
    count: int,
    z: Floats,
    params: Floats,
    h: float,
    reach: float,
    begin: int,
    end: int,
    bottom: Floats,
    top: Floats,
    scales: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
) -> None:
    """The same where contacts are found by Newton's method: all a step at a time, so that none waits for another.

    Where a contact can be on one of several branches ``held``, from the step before, is its number.
    """
    depth, per_depth, state = scales[DEPTH], scales[PER_DEPTH], found[STATE]
    x = found[RADIUS]  # until a is found
    lift = 1.0 if _adhesive else 0.0
    for i in range(count):
        x[i] = max(((z[i] - h) + lift * depth[i]) * per_depth[i], 0.0)
    if _branched:
        for i in range(count):
            held[i] = _rung(x[i], held[i], z[i] >= h - reach, _own(params, i))
    elif _adhesive:
        hold(count, z, begin, end, bottom, top, depth, held)
    if _adhesive:
        for i in range(count):
            x[i] = x[i] if held[i] > 0.0 else 1.0
    for i in range(count):
        state[i] = _guess(x[i], _own(params, i))
    for _ in range(_passes):
        for i in range(count):
            state[i], terms[i], _ = _nearer(state[i], x[i], _own(params, i))
    for i in range(count):
        rung = held[i] if _adhesive else 1.0
        if rung > 0.0 and not _arrived(state[i], terms[i], x[i], rung, _own(params, i)):
            t, step, _ = _nearer(state[i], x[i], _own(params, i))
            state[i] = t if _arrived(t, step, x[i], rung, _own(params, i)) else _state_on(x[i], rung, _own(params, i))
    conclude(count, params, found)


def radius_at(i: int, found: Floats, params: Floats) -> float:
    """a of one contact over its natural scale."""
    return _radius(found[STATE, i], _own(params, i))


def force_at(i: int, found: Floats, params: Floats) -> float:
    """P of one contact over its natural scale."""
    return _force(found[STATE, i], _own(params, i))


def stiffness_at(i: int, found: Floats, params: Floats) -> float:
    """k of one contact over its natural scale."""
    return _stiffness(found[STATE, i], _own(params, i))


def radius_found(i: int, found: Floats, params: Floats) -> float:
    """The same where it was found with the state."""
    return float(found[RADIUS, i])


def force_found(i: int, found: Floats, params: Floats) -> float:
    """The same where it was found with the state."""
    return float(found[FORCE, i])


def stiffness_found(i: int, found: Floats, params: Floats) -> float:
    """The same where it was found with the state."""
    return float(found[STIFFNESS, i])
