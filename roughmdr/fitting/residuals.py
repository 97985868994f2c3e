"""Residuals of a fit: their size, and whether neighbours are correlated, which means that the law does not fit."""

import numpy as np

from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.numerics.arguments import Floats

_LIMIT = 3.3  # standard deviations, which chance exceeds once in a thousand curves
_OF_DIFFERENCES = 0.6745 * 20.0**0.5  # median of third differences of noise, over its standard deviation
_SCATTER = 2.0  # relative error of a deviation found by such differences, over 1/sqrt(points), at its largest


def relative_rms(curve: MeasuredCurve, deviations: Floats) -> float:
    """Return the root mean square of the deviations over the largest load."""
    loads = deviations * curve.weight
    return float(np.sqrt(np.mean(np.square(loads))) / np.abs(curve.load).max())


def is_systematic(deviations: Floats) -> bool:
    """Return whether neighbours deviate to the same side more often than those of noise do, even or uneven.

    Products of neighbours have mean 0 if all are independent, however large each may be.
    """
    products = deviations[1:] * deviations[:-1]
    size = float(np.sqrt(np.sum(np.square(products))))
    return bool(products.sum() > _LIMIT * size)


def is_above_noise(curve: MeasuredCurve, deviations: Floats) -> bool:
    """Return whether deviations are larger than the scatter of neighbours, by third differences of the load."""
    noise = float(np.median(np.abs(np.diff(curve.load, 3)))) / _OF_DIFFERENCES
    most = (1.0 + _SCATTER / np.sqrt(curve.load.size)) * noise
    return bool(relative_rms(curve, deviations) * np.abs(curve.load).max() > most)
