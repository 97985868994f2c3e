"""The two steps between which a curve first reaches a value, and linear interpolation between them."""

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.result.between import AT_A_PLACE, REACH, off_line
from roughmdr.result.curves import Branch


def find_brackets(curve: Floats, values: Floats, *, branch: Branch) -> tuple[Floats, ...]:
    """Return the brackets in which curves [..., step] first reach values [value]; NaN where they never do.

    A bracket is two steps, and the position of the value from the first (0) to the second (1): each [..., value].
    """
    before, filled, usable = _joined(curve, branch)
    brackets = (_first(filled, value, before, usable) for value in values)
    return tuple(np.stack(part, axis=-1) for part in zip(*brackets, strict=True))


def _joined(y: Floats, branch: Branch) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Return, for each step but the first, the last one before it with a value, the curve, and whether the leg holds
    both; steps without a value have that of the last step with one.
    """
    number = np.arange(y.shape[-1])
    missing = np.isnan(y)
    if not missing.any():
        return number[:-1], y, branch.wanted[1:]
    last = np.maximum.accumulate(np.where(missing, 0, number), axis=-1)
    before = last[..., :-1]
    return before, np.take_along_axis(y, last, axis=-1), branch.wanted[1:] & (before >= branch.start[1:])


def _first(y: Floats, value: float, before: Ints, usable: NDArray[np.bool_]) -> Floats:
    """Return the first bracket of a value on each curve: [part, ...]."""
    if y.shape[-1] < 2:
        return np.full((3, *y.shape[:-1]), np.nan)
    below, above = y <= value, y >= value
    crossed = (below[..., :-1] & above[..., 1:]) | (above[..., :-1] & below[..., 1:])
    crossed &= usable
    at = crossed.argmax(axis=-1)
    reached = np.take_along_axis(crossed, at[..., None], axis=-1)[..., 0]
    lower = before[at] if before.ndim == 1 else np.take_along_axis(before, at[..., None], axis=-1)[..., 0]
    first, second = (np.take_along_axis(y, step[..., None], axis=-1)[..., 0] for step in (lower, at + 1))
    rise = second - first
    with np.errstate(divide="ignore", invalid="ignore"):
        fraction = np.where(rise == 0.0, 0.0, (value - first) / rise)
    return np.where(reached, np.stack([lower, at + 1, fraction]), np.nan)


def interpolate(
    curve: Floats, reached: Floats, path: Floats, *bracket: Floats, branch: Branch, in_jumps: bool
) -> tuple[Floats, Floats, Floats]:
    """Return curves at a bracket of curves that are ``reached`` for each value, their errors and changes there.

    Curves and the ``path``, the controlled quantity, are [..., step]; the bracket and the returned arrays [..., value].
    A bracket gives a line, the curve over the reached one. The error is the deviation of the curve from that line
    between the steps; for a curve that changes ``in_jumps`` only, and where too few steps are known, the difference to
    the farther step.
    """
    fraction = bracket[2]
    known = ~np.isnan(fraction)
    lower, upper = (np.where(known, step, 0.0).astype(np.int64) for step in bracket[:2])
    first, second = (_at(curve, step[..., None])[..., 0] for step in (lower, upper))
    rise = second - first
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.where(known, np.where(fraction == 0.0, first, first + fraction * rise), np.nan)
        error = np.maximum(np.abs(first - value), np.abs(second - value))
        if not in_jumps:
            near, there = _near(lower, upper, branch)
            way = _at(reached, near)
            over = way[..., REACH + 1] - way[..., REACH]
            slope = np.where(over == 0.0, 0.0, rise / over)[..., None]
            around = np.where(there, _at(curve, near) - slope * way, np.nan)
            off = sum(off_line(_at(path, near), around, spreads=AT_A_PLACE))
            error = np.where(np.isnan(off), error, off)
    return value, np.where(np.isnan(value), np.nan, error), np.where(known, rise, np.nan)


def _near(lower: Ints, upper: Ints, branch: Branch) -> tuple[Ints, NDArray[np.bool_]]:
    """Return the steps around brackets, [..., value, step], and whether the leg of the bracket has each."""
    away = np.arange(REACH + 1)
    steps = np.concatenate([lower[..., None] - away[::-1], upper[..., None] + away], axis=-1)
    near = np.clip(steps, 0, branch.start.size - 1)
    start = branch.start[upper][..., None]
    return near, (near == steps) & (near >= start) & ((near <= upper[..., None]) | (branch.start[near] == start))


def _at(curve: Floats, steps: Ints) -> Floats:
    """Return curves [..., step] at steps [..., value, step]."""
    runs, points = steps.shape[:-2], steps.shape[-2:]
    count = max(curve.ndim - 1, len(runs))
    flat = steps.reshape((1,) * (count - len(runs)) + (*runs, -1))
    taken = np.take_along_axis(curve.reshape((1,) * (count + 1 - curve.ndim) + curve.shape), flat, axis=-1)
    return np.asarray(taken.reshape(*taken.shape[:-1], *points))
