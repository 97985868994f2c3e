"""When realisations are enough for an error that is asked for, and how many to look at next where they are not."""

import math

import numpy as np

from roughmdr.batch.moments import Moments
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.sections import Accuracy

FIRST = 16
"""Realisations at least, before a standard error is believed at all."""
_SCORE = 2.326  # of 99 %: the share of cases in which the true standard error is to be met
_CARE = 0.7  # of the realisations that seem to be missing, how many are added before the next look
_LEAST = 0.02  # of those that there are, how many are added at least
_GROWTH = 4  # times as many at most from one look to the next
_FAR = 1e3  # times too large, an error asks for more than _GROWTH whatever it is


def relative_error(tally: Moments, unmet: Floats | float = 0.0) -> float:
    """The largest standard error of the mean force [step] over its largest magnitude; inf without any force.

    ``unmet`` is the spread that asperities that were not met would add to that of a realisation [N], [step].
    """
    largest = float(np.max(np.abs(tally.mean)))
    error = float(np.max(np.hypot(tally.standard_error, unmet / math.sqrt(tally.size))))
    return error / largest if largest > 0.0 else math.inf


def bound(count: int) -> float:
    """By how much the true standard error may exceed that of ``count`` normal realisations, in 99 % of cases.

    From the chi-squared distribution (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684).
    """
    a = 2.0 / (9.0 * (count - 1))
    share = 1.0 - a - _SCORE * math.sqrt(a)
    return share**-1.5 if share > 0.0 else math.inf


def enough(count: int, error: float, accuracy: Accuracy) -> bool:
    """Whether ``count`` realisations with this ``error`` come to that asked for."""
    return error * bound(count) <= accuracy.relative


def still_missing(count: int, error: float, accuracy: Accuracy) -> float:
    """How many more it seems to take, where ``count`` with this ``error`` are not enough."""
    ratio = min(error / accuracy.relative, _FAR)
    needed = float(max(count, FIRST))  # of fewer the bound can be infinite
    for _ in range(4):  # the bound comes down as the count goes up
        needed = max(count * (ratio * bound(math.ceil(needed))) ** 2, count + 1.0)
    return needed - count


def next_count(count: int, error: float, accuracy: Accuracy) -> int:
    """How many realisations to look at next, where ``count`` have this ``error``; ``count`` where no more are made."""
    if count >= accuracy.max_realizations or enough(count, error, accuracy):
        return count
    added = max(_CARE * still_missing(count, error, accuracy), _LEAST * count, 1.0)
    return min(count + math.ceil(added), _GROWTH * count, accuracy.max_realizations)
