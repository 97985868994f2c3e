"""Residuals of a fit: their size, and whether they follow each other as those of a law that describes the data do
not.
"""

import math

import numpy as np

from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.numerics.arguments import Floats

_LIMIT = 3.3  # standard deviations, which chance exceeds once in a thousand curves


def relative_rms(curve: MeasuredCurve, deviations: Floats) -> float:
    """Return the root mean square of the deviations over the largest load."""
    loads = deviations * curve.weight
    return float(np.sqrt(np.mean(np.square(loads))) / np.abs(curve.load).max())


def is_systematic(deviations: Floats) -> bool:
    """Return whether deviations follow each other: too few changes of sign, or correlated neighbours."""
    return max(_of_runs(deviations), _of_neighbours(deviations)) > _LIMIT


def _of_runs(deviations: Floats) -> float:
    """Return by how many standard deviations there are too few runs of one sign (Wald and Wolfowitz 1940)."""
    signs = deviations > 0.0
    above, below = int(signs.sum()), int((~signs).sum())
    both, count = 2.0 * above * below, above + below
    variance = both * (both - count) / (count * count * (count - 1.0))
    if not variance > 0.0:
        return math.sqrt(count) if count else 0.0  # all on one side
    runs = 1 + int((signs[1:] != signs[:-1]).sum())
    return (both / count + 1.0 - runs) / math.sqrt(variance)


def _of_neighbours(deviations: Floats) -> float:
    """Return the correlation of neighbours in standard deviations of what chance makes of it."""
    centred = deviations - deviations.mean()
    power = float(centred @ centred)
    return 0.0 if power == 0.0 else float(centred[1:] @ centred[:-1]) / power * math.sqrt(centred.size)
