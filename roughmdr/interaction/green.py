"""The displacement of a half-space under a point load, over 1/(pi E*): 1/r, on a periodic patch that of all images.

On a periodic patch it has zero mean, so that displacements count from the deformed mean plane. The sums are split as by
P. P. Ewald, Ann. Phys. 369 (1921) 253: 1/r = erfc(split r)/r + erf(split r)/r, images of the first, waves of the
second. Lengths are over the side of the patch along x.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_ROOT_PI = math.sqrt(math.pi)
_REACH = 6.0  # erfc(6) is 2e-17
_MARGIN = 0.1  # margin over the range of displacements: between the points they may be less than at them


class Periodic(NamedTuple):
    """A rectangular patch that repeats, 1 along x, and how its sums are split."""

    side_y: float
    """Side along y over that along x."""
    split: float
    """Images and waves fall off alike where it is sqrt(pi/area)."""

    @classmethod
    def of(cls, side_y: float) -> "Periodic":
        """Return the patch with the split that takes the fewest terms."""
        return cls(side_y, _ROOT_PI / math.sqrt(side_y))


Field = tuple[float, float, float, float]
"""G, its slopes along x and y, and its Laplacian."""


@njit
def point_load(dx: float, dy: float) -> Field:
    """Return 1/r with its derivatives at a distance (dx, dy) from the load."""
    inverse = 1.0 / math.sqrt(dx * dx + dy * dy)
    cube = inverse * inverse * inverse
    return inverse, -dx * cube, -dy * cube, cube


@njit
def near_part(dx: float, dy: float, split: float) -> Field:
    """Return erfc(split r)/r with its derivatives."""
    square = dx * dx + dy * dy
    r = math.sqrt(square)
    value = math.erfc(split * r) / r
    bell = 2.0 * split / _ROOT_PI * math.exp(-split * split * square)
    slope = -(value + bell) / square
    laplacian = (value + bell) / square + 2.0 * split * split * bell
    return value, slope * dx, slope * dy, laplacian


@njit
def mean_of_near_part(split: float, area: float) -> float:
    """Return the mean of erfc(split r)/r over the patch, which the waves take away."""
    return 2.0 * _ROOT_PI / (split * area)


@njit
def far_part_at_load(split: float) -> tuple[float, float]:
    """Return erf(split r)/r and its Laplacian at r = 0."""
    return 2.0 * split / _ROOT_PI, -8.0 * split * split * split / (3.0 * _ROOT_PI)


@njit
def far_wave(wave_number: float, split: float, area: float) -> float:
    """Return the amplitude of a wave of the sum of erf(split r)/r over all images."""
    return 2.0 * math.pi * math.erfc(0.5 * wave_number / split) / (area * wave_number)


@njit
def periodic_load(dx: float, dy: float, patch: Periodic) -> Field:
    """Return the field of a load and all its images at (dx, dy); at the load itself without its own 1/r."""
    side, split = patch
    dx, dy = dx - np_rint(dx), dy - side * np_rint(dy / side)
    g, gx, gy, lap = -mean_of_near_part(split, side), 0.0, 0.0, 0.0
    reach = _REACH / split
    for m in range(-int(reach + 0.5) - 1, int(reach + 0.5) + 2):
        for n in range(-int(reach / side + 0.5) - 1, int(reach / side + 0.5) + 2):
            x, y = dx + m, dy + side * n
            square = x * x + y * y
            if square == 0.0:
                own, own_lap = far_part_at_load(split)
                g, lap = g - own, lap - own_lap
            elif square <= reach * reach:
                value, slope_x, slope_y, laplacian = near_part(x, y, split)
                g, gx, gy, lap = g + value, gx + slope_x, gy + slope_y, lap + laplacian
    highest = 2.0 * split * _REACH
    step_x, step_y = 2.0 * math.pi, 2.0 * math.pi / side
    for m in range(int(highest / step_x) + 1):
        for n in range(-int(highest / step_y), int(highest / step_y) + 1):
            kx, ky = m * step_x, n * step_y
            k = math.sqrt(kx * kx + ky * ky)
            if (m > 0 or n > 0) and k <= highest:
                amplitude = 2.0 * far_wave(k, split, side)
                cosine, sine = amplitude * math.cos(kx * dx + ky * dy), amplitude * math.sin(kx * dx + ky * dy)
                g, gx, gy, lap = g + cosine, gx - kx * sine, gy - ky * sine, lap - k * k * cosine
    return g, gx, gy, lap


@njit
def np_rint(value: float) -> float:
    """Return the whole number nearest to ``value``."""
    return math.floor(value + 0.5)


def below_all(displacement: Floats) -> float:
    """Return about the least displacement between points, from those at the points: some of their range below."""
    return float(displacement.min() - _MARGIN * np.ptp(displacement))
