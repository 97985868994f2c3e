"""Residuals of a fit: their size, and whether neighbours go together, as those of a law that fits the data do not."""

import numpy as np

from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.numerics.arguments import Floats

_LIMIT = 3.3  # standard deviations, which chance exceeds once in a thousand curves


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
