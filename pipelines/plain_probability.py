"""Expected force of Hertzian paraboloids by quadrature in the probability: of the inverses of scipy.stats alone.

The normal score t of the probability is the variable: z(t) is where a fraction Phi(t) of the heights lies below, by
``ppf`` on the lower half and by ``isf`` on the upper. No density is evaluated, so that poles do no harm, and tails are
integrated as far as doubles can tell a probability from 0.
"""

import math
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from roughmdr.arguments import Floats

_END = 37.0  # normal score beyond which no double holds the probability
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def quantiles(frozen: Any, scores: Floats) -> Floats:
    """The values that lie as high in a distribution of scipy.stats as normal scores do, by the nearer tail."""
    with np.errstate(all="ignore"):
        return np.where(scores < 0.0, frozen.ppf(ndtr(np.minimum(scores, 0.0))), frozen.isf(ndtr(-np.maximum(scores, 0.0))))


def _rule(begin: float, width: float) -> tuple[Floats, Floats]:
    """Scores and weights from ``begin`` on, for what begins as a root there: panels of ``width``, the first graded."""
    graded = begin + width * 4.0 ** np.arange(-12.0, 0.0)
    edges = np.unique(np.concatenate([[begin], graded, np.arange(begin + width, _END, width), [_END]]))
    low, high = edges[:-1, None], edges[1:, None]
    scores, weights = 0.5 * (low + high) + 0.5 * (high - low) * _NODES, 0.5 * (high - low) * _WEIGHTS
    return scores.ravel(), (weights * np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)).ravel()


def mean_of_heights(frozen: Any, separation: float, exponent: float, width: float = 0.25) -> float:
    """The mean of max(z - separation, 0)^exponent over heights z [m]."""
    below, above = float(frozen.cdf(separation)), float(frozen.sf(separation))
    begin = float(ndtri(below)) if below < above else -float(ndtri(above))
    scores, weights = _rule(max(begin, -_END), width)
    indentation = np.maximum(quantiles(frozen, scores) - separation, 0.0)
    return float(weights @ indentation**exponent)


def mean_of_radii(frozen: Any, exponent: float, width: float = 0.25) -> float:
    """The mean of R^exponent over radii R [m]."""
    scores, weights = _rule(-_END, width)
    return float(weights @ quantiles(frozen, scores) ** exponent)
