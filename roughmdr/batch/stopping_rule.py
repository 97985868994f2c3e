"""When realisations are enough for an error that is asked for, and how many to look at next where they are not."""

import math

import numpy as np

from roughmdr.batch.moments import Moments
from roughmdr.numerics.arguments import Floats

FIRST = 16  # realisations at least, before a standard error is believed at all
FEWEST = 4  # realisations of what costs more: its standard error is enough where it is 6 times too small
_SCORE_99 = 2.326  # normal score of 99 %, the fraction of cases in which the true standard error is to be met
_ADDED_FRACTION = 0.7  # share of the realisations that seem to be missing, run before the next look
_MIN_GROWTH, _MAX_GROWTH = 0.02, 4  # from one look to the next: realisations added over present; after over before
_MAX_RATIO = 1e3  # error over the error asked for, above which more than _MAX_GROWTH is missing in any case


def relative_error(moments: Moments, unmet: Floats | float = 0.0, *, over_range: bool = False) -> float:
    """Return the largest standard error of the mean force [step] over its largest magnitude; inf without any force.

    ``unmet`` is the spread that asperities that were not met would add to that of a realisation [N], [step]. A
    separation, which has no natural zero, is taken ``over_range``: over the range of its mean. Steps where some
    realisations have none do not count.
    """
    known = ~np.isnan(moments.mean)
    if not known.any():
        return math.inf
    mean = moments.mean[known]
    largest = float(np.ptp(mean)) if over_range else float(np.max(np.abs(mean)))
    error = float(np.max(np.hypot(moments.standard_error, unmet / math.sqrt(moments.size))[known]))
    return error / largest if largest > 0.0 else math.inf


def error_at(moments: Moments, step: int, unmet: Floats | float = 0.0, *, absolute: bool) -> float:
    """Return the standard error of a mean at a step, over its magnitude unless it is ``absolute``; inf without any.

    ``unmet`` is as in ``relative_error``.
    """
    mean = float(moments.mean[step])
    error = float(np.hypot(moments.standard_error, unmet / math.sqrt(moments.size))[step])
    scale = 1.0 if absolute else abs(mean)
    return error / scale if scale > 0.0 and not math.isnan(mean) else math.inf


def bound(count: int) -> float:
    """Return the factor by which the true standard error may exceed that of ``count`` normal realisations.

    It is exceeded in 1 % of cases: chi-squared distribution (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17
    (1931) 684).
    """
    a = 2.0 / (9.0 * (count - 1))
    root = 1.0 - a - _SCORE_99 * math.sqrt(a)
    return root**-1.5 if root > 0.0 else math.inf


def is_enough(count: int, error: float, asked: float) -> bool:
    """Return whether ``count`` realisations with this ``error`` meet the error ``asked`` for."""
    return error * bound(count) <= asked


def missing_count(count: int, error: float, asked: float) -> float:
    """Estimate how many more realisations are needed, where ``count`` with this ``error`` are not enough."""
    ratio = min(error / asked, _MAX_RATIO)
    needed = float(max(count, FIRST))  # of fewer the bound can be infinite
    for _ in range(4):  # the bound comes down as the count goes up
        needed = max(count * (ratio * bound(math.ceil(needed))) ** 2, count + 1.0)
    return needed - count


def next_count(count: int, error: float, asked: float, most: int) -> int:
    """Return how many realisations of ``most`` to look at next, where ``count`` have this ``error``.

    It is ``count`` for no more.
    """
    if count >= most or is_enough(count, error, asked):
        return count
    added = max(_ADDED_FRACTION * missing_count(count, error, asked), _MIN_GROWTH * count, 1.0)
    return min(count + math.ceil(added), _MAX_GROWTH * count, most)
