"""Springs drawn as zigzags, in pictures of one contact and in those of the docs."""

import numpy as np

from roughmdr.numerics.arguments import Floats

_POINTS = 25  # of a spring
_STRAIGHT = 2  # at each end


def coils(positions: Floats, ends: Floats, bottom: float, width: float) -> list[Floats]:
    """Return each spring as a line, [point, 2], from ``bottom`` to its end, ``width`` to both sides."""
    swing = np.zeros(_POINTS)
    swing[_STRAIGHT:-_STRAIGHT:2], swing[_STRAIGHT + 1 : -_STRAIGHT : 2] = width, -width
    return [
        np.column_stack([x + swing, np.linspace(bottom, end, _POINTS)]) for x, end in zip(positions, ends, strict=True)
    ]
