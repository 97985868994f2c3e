"""Residuals of a fit: their size, and whether neighbours are correlated, which means that the law does not fit."""

import numpy as np

from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.numerics.arguments import Floats

_LIMIT = 3.3  # standard deviations, which chance exceeds once in a thousand curves
_OF_DIFFERENCES = 0.6745 * 20.0**0.5  # median of third differences of noise, over its standard deviation
_SCATTER = 4.2  # three relative standard errors of a deviation found by such differences, over 1/sqrt(points)

POOR = 0.05
"""R.m.s. deviation over the largest load from which other starts are tried too, and deviations are no noise."""


def relative_rms(curve: MeasuredCurve, deviations: Floats) -> float:
    """Return the root mean square of the deviations, without those from priors, over the largest load."""
    loads = deviations[: curve.load.size] * curve.weight
    return float(np.sqrt(np.mean(np.square(loads))) / curve.largest)


def is_systematic(deviations: Floats) -> bool:
    """Return whether neighbours deviate to the same side more often than those of noise do, even or uneven.

    Products of neighbours have mean 0 if all are independent, however large each may be.
    """
    products = deviations[1:] * deviations[:-1]
    size = float(np.sqrt(np.sum(np.square(products))))
    return bool(products.sum() > _LIMIT * size)


def is_above_noise(curve: MeasuredCurve, deviations: Floats) -> bool:
    """Return whether deviations are larger than the scatter of neighbours, by third differences of the load."""
    most = (1.0 + _SCATTER / np.sqrt(curve.load.size)) * noise_of(curve)
    return bool(relative_rms(curve, deviations) * curve.largest > most)


def noise_of(curve: MeasuredCurve) -> float:
    """Return the standard deviation of the noise of the load [N or Pa], by third differences."""
    return float(np.median(np.abs(np.diff(curve.load, 3)))) / _OF_DIFFERENCES
