"""The deviation of a curve from the straight line between two of its steps, with jumps of contacts.

A smooth curve is off by the squared step times y''/8. Jumps between the steps show in third differences: a jump changes
the rise of its step by its size, against the rises of the steps beside. Of many small jumps at random, each rise
scatters with a standard deviation s, these differences with sqrt(3/2) s, and the curve between two steps is a Brownian
bridge: it departs from the line by more than x s with a probability of 2 exp(-2 x^2). A single jump departs by its size
at most.
"""

import numpy as np

from roughmdr.numerics.arguments import Floats

REACH = 4
"""Number of steps beside an interval, on each side, from which the deviation within it is estimated."""
CONFIDENCE = 0.97
"""Least share of random laws whose errors were right, against paths of eight times as many steps."""
ANYWHERE = 1.7
"""Largest departure between two steps, over the standard deviation by third differences: 2.1 s of a bridge."""
AT_A_PLACE = 1.2
"""Departure at a given position between two steps, over the same; few, unequal jumps scatter more than a bridge."""

_BEND = 0.275
"""Departure over half the second derivative times the squared step: 1/4, and a tenth more since it changes."""


def off_line(path: Floats, curve: Floats, *, spreads: float) -> tuple[Floats, Floats]:
    """Return the deviation of a curve from the line between the middle two of 2 REACH + 2 steps, by bend and by jumps.

    Path and curve are [..., step], NaN where there is no such step; both parts are [...], to be added, NaN for fewer
    than four steps. ``spreads`` is ANYWHERE or AT_A_PLACE.
    """
    step = np.diff(path, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.diff(curve, axis=-1) / np.where(step == 0.0, np.nan, step)
        span = step[..., 1:] + step[..., :-1]
        bend = np.diff(slope, axis=-1) / span  # half the second derivative, at each step but the first and the last
        left, right = span[..., :-1], span[..., 1:]
        jumps = step[..., 1:-1] * np.diff(bend, axis=-1) * left * right / (left + right)
        count = np.sum(np.isfinite(jumps), axis=-1)
        mean = np.where(count > 3, np.nansum(jumps, axis=-1) / count, 0.0)
        spread = np.sqrt(np.nansum((jumps - mean[..., None]) ** 2, axis=-1) / count)
        own = np.abs(jumps[..., REACH - 1] - mean)
        smooth = _BEND * step[..., REACH] ** 2 * np.fmax(np.abs(bend[..., REACH - 1]), np.abs(bend[..., REACH]))
        return smooth, np.fmax(own, spreads * spread)
