"""The two steps between which a curve first reaches a value, and linear interpolation between them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.analysis.curves import Legs
from roughmdr.numerics.arguments import Floats

WAYS = 3
"""With all steps, and without every other in both ways."""
LOWER, UPPER, FRACTION = range(3)
"""Parts of a bracket: its two steps, and how far from the first to the second the value is."""


class Steps(NamedTuple):
    """Some of the steps of a path."""

    kept: NDArray[np.int64]
    wanted: NDArray[np.bool_]
    """Whether each is on the branch."""
    start: NDArray[np.int64]
    """Where, among all steps, the leg of each begins."""

    @classmethod
    def ways(cls, legs: Legs) -> "tuple[Steps, ...]":
        """Return all steps of a path, and those without every other in both ways."""
        every = np.arange(legs.wanted.size)
        return tuple(cls(kept, legs.wanted[kept], legs.start[kept]) for kept in (every, *legs.without_every_other()))


def find_brackets(curve: Floats, values: Floats, *, ways: tuple[Steps, ...]) -> Floats:
    """Return where curves [..., step] first reach values [value]: [..., value, way, part]; NaN where they never do."""
    found = np.full((*curve.shape[:-1], values.size, WAYS, 3), np.nan)
    for way, steps in enumerate(ways):
        y = curve[..., steps.kept] if steps.kept.size < curve.shape[-1] else curve
        before, filled, usable = _joined(y, steps)
        for number, value in enumerate(values):
            found[..., number, way, :] = _first(filled, value, before, usable, steps)
    return found


def _joined(y: Floats, steps: Steps) -> tuple[NDArray[np.int64], Floats, NDArray[np.bool_]]:
    """Return, for each step but the first, the last one before it with a value, the curve, and whether the leg holds
    both; steps without a value have that of the last step with one.
    """
    number = np.arange(steps.kept.size)
    missing = np.isnan(y)
    if not missing.any():
        return number[:-1], y, steps.wanted[1:]
    last = np.maximum.accumulate(np.where(missing, 0, number), axis=-1)
    before = last[..., :-1]
    usable = steps.wanted[1:] & (steps.kept[before] >= steps.start[1:])
    return before, np.take_along_axis(y, last, axis=-1), usable


def _first(y: Floats, value: float, before: NDArray[np.int64], usable: NDArray[np.bool_], steps: Steps) -> Floats:
    """Return the first bracket of a value on each curve: [..., part]."""
    if steps.kept.size < 2:
        return np.full((*y.shape[:-1], 3), np.nan)
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
    parts = np.stack([steps.kept[lower], steps.kept[at + 1], fraction], axis=-1)
    return np.where(reached[..., None], parts, np.nan)


def interpolate(curve: Floats, brackets: Floats, *, in_jumps: bool) -> tuple[Floats, Floats]:
    """Return curves [..., step] at brackets [..., value, way, part], and how far that may be off: [..., value].

    A jump may lie anywhere between two steps. To leave out one of them moves the value by half of the part of the jump
    on its side, so that twice the largest change bounds the error. Of a curve that changes ``in_jumps`` only, and where
    the value is not reached without the step, it is the difference to the farther of the two steps.
    """
    curve = curve.reshape((1,) * (brackets.ndim - 2 - curve.ndim) + curve.shape)
    reached = ~np.isnan(brackets[..., FRACTION])
    first, second = (_at(curve, np.where(reached, brackets[..., part], 0.0)) for part in (LOWER, UPPER))
    fraction = brackets[..., FRACTION]
    with np.errstate(invalid="ignore"):
        found = np.where(fraction == 0.0, first, first + fraction * (second - first))
        found = np.where(reached, found, np.nan)
        value, others = found[..., 0], found[..., 1:]
        change = np.fmax.reduce(np.abs(others - value[..., None]), axis=-1)
        farther = np.maximum(np.abs(first - found), np.abs(second - found))[..., 0]
    error = np.where(in_jumps | np.isnan(others).all(axis=-1), farther, 2.0 * change)
    return value, np.where(np.isnan(value), np.nan, error)


def _at(curve: Floats, steps: Floats) -> Floats:
    """Return curves [..., step] at steps [..., value, way]."""
    runs, points = steps.shape[:-2], steps.shape[-2:]
    flat = steps.astype(np.int64).reshape((1,) * (curve.ndim - 1 - len(runs)) + (*runs, -1))
    taken = np.take_along_axis(curve, flat, axis=-1)
    return np.asarray(taken.reshape(*taken.shape[:-1], *points))
