"""Nodes of a rule along one axis of its scores, and where a quantity of theirs passes a level between them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.nodes import Rule, hermite
from roughmdr.numerics.arguments import Floats, Ints

_STEPS = 8  # steps of Newton's method
_NEGLIGIBLE = 1e-24  # weight of a score: what is there, far in a tail, does not matter


class Line(NamedTuple):
    """The nodes along one axis, at equal scores of all others."""

    rule: Rule
    numbers: Ints
    """Numbers of the nodes: [score]."""


def lines_along(axes: tuple[int, ...], rules: tuple[Rule, ...], values: Floats) -> list[Line]:
    """Return the lines along that axis of each population on which the values depend most.

    ``axes`` are their numbers, ``rules`` has one for each axis of each population. Populations without an axis have no
    lines.
    """
    first, left, lines = 0, list(rules), []
    for count in axes:
        own, left = left[:count], left[count:]
        shape = tuple(rule.scores.size for rule in own)
        numbers = first + np.arange(math.prod(shape)).reshape(shape)
        first += numbers.size
        if own:
            axis = int(np.argmax([abs(_slope(own, values[numbers], axis)) for axis in range(count)]))
            some = np.moveaxis(numbers, axis, -1).reshape(-1, shape[axis])
            lines += [Line(own[axis], each) for each in some]
    return lines


def _slope(rules: list[Rule], values: Floats, axis: int) -> float:
    """Return the mean slope of values at the scores of some rules along one of their axes."""
    for each, rule in reversed(list(enumerate(rules))):
        values = (values * (rule.weights * rule.scores if each == axis else rule.weights)).sum(axis=-1)
    return float(values)


def weighty(rule: Rule) -> NDArray[np.bool_]:
    """Return which scores are not of negligible weight."""
    return rule.weights > _NEGLIGIBLE


def crossings(rule: Rule, values: Floats, levels: Floats) -> Floats:
    """Return the scores at which the polynomial through monotone values at the scores has each level; infinite beyond
    the last scores that are not of negligible weight.
    """
    order, some = rule.scores.size, weighty(rule)
    rising = values if values[0] < values[-1] else -values
    levels = levels if values[0] < values[-1] else -levels
    series = (rule.weights * rising * hermite(rule.scores, order)).sum(axis=1)
    slopes = series[1:] * np.sqrt(np.arange(1.0, order))
    scores, rising = rule.scores[some], rising[some]
    after = np.clip(np.searchsorted(rising, levels), 1, scores.size - 1)
    low, high = scores[after - 1], scores[after]
    x = np.interp(levels, rising, scores)
    for _ in range(_STEPS):
        basis = hermite(x, order)
        value, slope = np.einsum("m,mx->x", series, basis), np.einsum("m,mx->x", slopes, basis[:-1])
        low, high = np.where(value < levels, x, low), np.where(value < levels, high, x)
        newton = x - (value - levels) / slope
        x = np.where((low <= newton) & (newton <= high), newton, 0.5 * (low + high))
    return np.where(levels <= rising[0], -math.inf, np.where(levels >= rising[-1], math.inf, x))
