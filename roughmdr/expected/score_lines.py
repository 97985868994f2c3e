"""Nodes of a rule along one axis of its scores, and where a quantity of theirs passes a level between them."""

import math

import numpy as np

from roughmdr.ensemble.nodes import Rule, hermite
from roughmdr.numerics.arguments import Floats, Ints

_STEPS = 8  # of Newton's method


def lines_along(axes: tuple[int, ...], rule: Rule, values: Floats) -> Ints:
    """Return the numbers of the nodes along that axis of each population on which the values depend most.

    They are [line, score]. Populations without an axis have none.
    """
    order, first = rule.scores.size, 0
    lines = [np.zeros((0, order), dtype=np.int64)]
    for count in axes:
        numbers = first + np.arange(order**count).reshape((order,) * count)
        first += order**count
        slopes = [abs(_mean(rule, values[numbers] * _along(rule.scores, axis, count))) for axis in range(count)]
        if slopes:
            lines.append(np.moveaxis(numbers, int(np.argmax(slopes)), -1).reshape(-1, order))
    return np.concatenate(lines)


def _along(scores: Floats, axis: int, count: int) -> Floats:
    """Return scores as an array that varies along one of so many axes."""
    return scores.reshape([-1 if each == axis else 1 for each in range(count)])


def _mean(rule: Rule, values: Floats) -> float:
    """Return the mean of values over all their axes, each one of scores."""
    for _ in range(values.ndim):
        values = (values * rule.weights).sum(axis=-1)
    return float(values)


def crossings(rule: Rule, values: Floats, levels: Floats) -> Floats:
    """Return the scores at which the polynomial through monotone values at the scores has each level; infinite beyond
    the last scores.
    """
    order = rule.scores.size
    rising = values if values[0] < values[-1] else -values
    levels = levels if values[0] < values[-1] else -levels
    series = (rule.weights * rising * hermite(rule.scores, order)).sum(axis=1)
    slopes = series[1:] * np.sqrt(np.arange(1.0, order))
    after = np.clip(np.searchsorted(rising, levels), 1, order - 1)
    low, high = rule.scores[after - 1], rule.scores[after]
    x = np.interp(levels, rising, rule.scores)
    for _ in range(_STEPS):
        basis = hermite(x, order)
        value, slope = np.einsum("m,mx->x", series, basis), np.einsum("m,mx->x", slopes, basis[:-1])
        low, high = np.where(value < levels, x, low), np.where(value < levels, high, x)
        newton = x - (value - levels) / slope
        x = np.where((low <= newton) & (newton <= high), newton, 0.5 * (low + high))
    return np.where(levels <= rising[0], -math.inf, np.where(levels >= rising[-1], math.inf, x))
