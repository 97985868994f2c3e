"""Quadrature over the asperities of a source: shape parameters at weighted nodes, with the density of their heights."""

import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.random.distribution_families import ndtr
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.numerics.gauss import unit_gauss

HEIGHT_END = 10.0  # normal score beyond which heights with light tails are left out: a fraction of 1e-23
PARAMETER_END = 8.5  # normal score beyond which a rule with cuts leaves parameters out: a fraction of 1e-17
_FAR = 40.0  # normal score beyond which no float holds the density
_STEPS = 8  # steps of Newton's method
_NEGLIGIBLE = 1e-24  # weight of a score: what is there, far in a tail, does not matter


class UpperTail(NamedTuple):
    """The heights above the last edge, which are left out."""

    fraction: float  # of all heights
    xi: float  # index of extreme values: heights grow as fraction^-xi

    def over_edge(self, growth: float) -> float:
        """Return the force of the tail divided by that of one height at its edge, if forces grow as height^growth."""
        return self.fraction * float(mean_over_edge(np.array(growth * self.xi)))


class Heights(NamedTuple):
    """Heights of the summits of one node as differences y = z - origin [m], which keep their digits near a pole."""

    density: Callable[[Floats], Floats]
    """y -> the density [1/m]; inf at a pole."""
    fractions: Callable[[Floats], tuple[Floats, Floats]] | None
    """y -> the fractions of all heights below and above; None where the density is smooth and its integral 1."""
    edges: tuple[float, ...]
    """y, ascending; a negligible fraction lies below the first, ``tail`` is above the last."""
    scale: float
    """Interquartile range [m], or a third of the distance from the median to score 3 if that is larger."""
    tail: UpperTail
    origin: float  # [m]

    @classmethod
    def all_at(cls, height: float) -> "Heights":
        """Return heights that are all the same [m]."""
        return cls(np.zeros_like, None, (0.0, 0.0), 0.0, UpperTail(0.0, 0.0), height)


def fraction_above(score: float) -> float:
    """Return the fraction of a distribution that lies above a normal score."""
    return float(ndtr(np.array(-score)))


def mean_over_edge(index: Floats) -> Floats:
    """Return the mean over a tail of what grows as fraction^-index, over its value at the edge; inf if unbounded."""
    return np.where(index < 1.0, 1.0 / np.where(index < 1.0, 1.0 - index, 1.0), math.inf)


class Rule(NamedTuple):
    """A quadrature rule over a normal score; its weights add up to 1."""

    scores: Floats
    weights: Floats

    @classmethod
    @cache
    def smooth(cls, order: int) -> "Rule":
        """Return Gauss's rule for smooth functions."""
        scores, weights = np.polynomial.hermite_e.hermegauss(order)
        return cls(scores, weights / weights.sum())

    def weights_below(self, ends: Floats) -> Floats:
        """Return the weights of integrals up to each of ``ends`` [end], for a rule of ``smooth``: [end, score].

        They are those of the polynomial through the values at the scores, whose series is in the normalised Hermite
        polynomials h_m: the integral of h_m times the normal density up to x is -h_(m-1)(x) density/sqrt(m).
        """
        order = self.scores.size
        ends = np.clip(ends, -_FAR, _FAR)
        density = np.exp(-0.5 * ends**2) / math.sqrt(2.0 * math.pi)
        integrals = -hermite(ends, order - 1) * density / np.sqrt(np.arange(1.0, order))[:, None]
        sums = ndtr(ends)[:, None] + np.einsum("me,ms->es", integrals, hermite(self.scores, order)[1:])
        return np.asarray(self.weights * sums)

    @classmethod
    def between(cls, cuts: list[float], order: int) -> "Rule":
        """Return Gauss's rule of ``order`` scores between cuts, for functions smooth in roots of distances to them."""
        ends = np.unique(np.clip([-PARAMETER_END, *cuts, PARAMETER_END], -PARAMETER_END, PARAMETER_END))
        y, weights = unit_gauss(order)
        # x(y) from 0 to 1 and its slope, quadratic at each end that is a cut: (is the lower one, is the upper one).
        substitutions = {
            (True, True): (y * y * (3.0 - 2.0 * y), 6.0 * y * (1.0 - y)),
            (True, False): (y * y, 2.0 * y),
            (False, True): (y * (2.0 - y), 2.0 * (1.0 - y)),
            (False, False): (y, np.ones_like(y)),
        }
        parts = []
        for low, high in pairwise(ends):
            x, slope = substitutions[bool(low > -PARAMETER_END), bool(high < PARAMETER_END)]
            parts.append((low + (high - low) * x, (high - low) * slope * weights))
        scores, lengths = map(np.concatenate, zip(*parts, strict=True))
        return cls(scores, lengths * np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi))


def hermite(x: Floats, count: int) -> Floats:
    """Return the first ``count`` Hermite polynomials, orthonormal over the normal density: [polynomial, x]."""
    values = np.ones((max(count, 1), x.size))
    for m in range(1, count):
        values[m] = (x * values[m - 1] - (math.sqrt(m - 1.0) * values[m - 2] if m > 1 else 0.0)) / math.sqrt(m)
    return values[:count]


class Nodes(NamedTuple):
    """A few asperities that represent all, with weights: fractions that add up to 1."""

    weights: Floats  # [node]
    parameters: dict[str, Floats]  # [node]
    heights: tuple[Heights, ...]  # [node]


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
