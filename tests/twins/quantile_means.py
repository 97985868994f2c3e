"""Expected force of Hertzian paraboloids by quadrature in the probability: from the inverses of scipy.stats alone.

The normal score t of the probability is the variable: z(t) is where a fraction Phi(t) of the heights lies below, by
``ppf`` on the lower half and by ``isf`` on the upper. No density is evaluated, so that poles do no harm, and tails are
integrated as far as doubles distinguish a probability from 0.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats import rv_continuous

from roughmdr.numerics.arguments import Floats

_END = 37.0  # normal score beyond which no double holds the probability
_END_NUMERICAL = 8.0  # where scipy finds the inverse numerically: from 1 - p, which has no digits beyond
_HALVINGS, _RTOL = 40, 1e-14  # most halvings of a panel; relative tolerance of the mean
_MAX_PANELS = 1_000  # halved at once: more of them disagree by roundings
_MAX_NUMERICAL = 100  # where inverses are found numerically, slowly and with noise
_END_OF_SCORES = 8.5  # largest score of two correlated quantities
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_FINE_NODES, _FINE_WEIGHTS = np.polynomial.legendre.leggauss(20)


class Mean(NamedTuple):
    """A mean and a bound on its error."""

    value: float
    doubt: float


def mean_of_heights(frozen: Any, separation: float, exponent: float) -> Mean:
    """Return the mean of max(z - separation, 0)^exponent over heights z [m]."""
    begin = _score(frozen, separation)
    return _mean(frozen, begin, lambda z: np.maximum(z - separation, 0.0) ** exponent)


def mean_of_radii(frozen: Any, exponent: float) -> Mean:
    """Return the mean of R^exponent over radii R [m]."""
    return _mean(frozen, -math.inf, lambda R: np.maximum(R, 0.0) ** exponent)


def mean_of_correlated(
    frozen: Any, separation: float, exponent: float, factor: Callable[[Floats], Floats], correlation: float
) -> float:
    """Return the mean of factor(t) max(z - separation, 0)^exponent over heights z [m] correlated with normal scores t.

    By Gauss's rule in t and in the part of the score of z that is independent of t: right to some 1e-12.
    """
    begin = _score(frozen, separation)
    spread = math.sqrt((1.0 - correlation) * (1.0 + correlation))
    scores, weights = _panels(np.linspace(-_END_OF_SCORES, _END_OF_SCORES, 15))
    total = 0.0
    for score, weight in zip(scores, weights * factor(scores), strict=True):
        first = max((begin - correlation * score) / spread, -_END_OF_SCORES)
        if first < _END_OF_SCORES:
            independent, density = _panels(first + (_END_OF_SCORES - first) * np.linspace(0.0, 1.0, 9) ** 4)
            heights = quantiles(frozen, correlation * score + spread * independent)
            total += weight * float(density @ np.maximum(heights - separation, 0.0) ** exponent)
    return total


def quantiles(frozen: Any, scores: Floats) -> Floats:
    """Return the values of a distribution of scipy.stats at normal scores, from the nearer tail."""
    with np.errstate(all="ignore"):
        lower, upper = frozen.ppf(ndtr(np.minimum(scores, 0.0))), frozen.isf(ndtr(-np.maximum(scores, 0.0)))
    return np.asarray(np.where(scores < 0.0, lower, upper))


def _score(frozen: Any, value: float) -> float:
    """Return the normal score of a value, from the nearer tail."""
    below, above = float(frozen.cdf(value)), float(frozen.sf(value))
    return float(ndtri(below)) if below < above else -float(ndtri(above))


def _is_numerical(frozen: Any) -> bool:
    """Return whether scipy finds an inverse of a distribution numerically."""
    return type(frozen.dist)._ppf is rv_continuous._ppf or type(frozen.dist)._isf is rv_continuous._isf


def _end(frozen: Any) -> float:
    """Return the normal score up to which the inverses of a distribution are right."""
    end, before = 4.0, -math.inf
    for score in np.arange(4.5, (_END_NUMERICAL if _is_numerical(frozen) else _END) + 0.5, 0.5).tolist():
        try:
            low, high = quantiles(frozen, np.array([-score, score]))
            tail, beyond = float(ndtr(-score)), float(frozen.sf(high))
        except ArithmeticError:  # from Boost
            break
        if not (math.isfinite(low) and math.isfinite(high) and high >= before):
            break
        if score > _END_NUMERICAL and not 0.5 * tail < beyond < 2.0 * tail:
            break
        end, before = score, high
    return end


def _mean(frozen: Any, begin: float, quantity: Callable[[Floats], Floats]) -> Mean:
    """Return the mean of a quantity that begins at a score; panels are halved until their halves agree with them."""
    end = _end(frozen)
    if not begin < end:
        return Mean(0.0, 0.0)

    def integral(low: Floats, high: Floats) -> Floats:
        scores = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _NODES
        density = np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)
        values = quantity(quantiles(frozen, scores.ravel())).reshape(scores.shape)
        return 0.5 * (high - low) * ((values * density) @ _WEIGHTS)

    edges = np.unique(np.clip([begin, *np.arange(-_END, _END + 1.0)], max(begin, -end), end))
    low, high = edges[:-1], edges[1:]
    rough = integral(low, high)
    value, doubt, last = 0.0, 0.0, 3.0 * abs(float(rough[high > end - 1.0].sum()))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        halves = np.array([integral(low, middle), integral(middle, high)])
        error = np.abs(halves.sum(axis=0) - rough)
        right = ~(error > _RTOL * (abs(value) + np.abs(halves).sum()))
        value, doubt = value + float(halves[:, right].sum()), doubt + float(error[right].sum())
        low, middle, high = low[~right], middle[~right], high[~right]
        rough = halves[:, ~right].ravel()
        if low.size > (_MAX_NUMERICAL if _is_numerical(frozen) else _MAX_PANELS):
            return Mean(value + float(rough.sum()), doubt + float(error[~right].sum()) + last)
        if low.size == 0:
            break
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return Mean(value + float(rough.sum()), doubt + float(np.abs(rough).sum() if low.size else 0.0) + last)


def _panels(edges: Floats) -> tuple[Floats, Floats]:
    """Return scores and weights of Gauss's rule on panels, for the normal density."""
    low, high = edges[:-1, None], edges[1:, None]
    scores = (0.5 * (low + high) + 0.5 * (high - low) * _FINE_NODES).ravel()
    weights = (0.5 * (high - low) * _FINE_WEIGHTS).ravel() * np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)
    return scores, weights
