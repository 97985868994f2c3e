"""Paraboloids of JKR or Hertz that feel each other as point forces on a periodic half-space, slow and plain.

delta_i = z_i - h - sum_j G_ij P_j, with the Green's function of zero mean, so that h counts from the mean plane of the
deformed half-space. Each contact in turn goes to its equilibrium in the field of the others, with its own memory, until
nothing moves: the energy falls with each of these steps.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.special import erfc

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats

_RTOL = 1e-9
_MAX_SWEEPS = 2000
_RTOL_RADIUS, _TINY = 1e-13, 1e-300
_DOUBLINGS = 4  # most doublings of the radius until it is an upper bound
_CELLS = 4  # images and waves on either side: the sums of Ewald have 15 digits


def periodic_green(x: Floats, y: Floats, size: float, effective_modulus: float) -> Floats:
    """G_ij [m/N] of points [m] in a periodic square patch, of zero mean (P. P. Ewald, Ann. Phys. 369 (1921) 253).

    The diagonal is without 1/(pi E* r): the displacement of a point by its own images and the uniform counter pressure.
    """
    dx, dy = (np.subtract.outer(p, p) / size for p in (x, y))
    split = math.sqrt(math.pi)  # images and waves then fall off alike
    result = np.full(dx.shape, -2.0)  # -2 sqrt(pi)/split, the mean of the images
    cells = range(-_CELLS, _CELLS + 1)
    for m in cells:
        for n in cells:
            away = np.hypot(dx - np.rint(dx) + m, dy - np.rint(dy) + n)
            own = away == 0.0
            away[own] = 1.0
            result += np.where(own, -2.0 * split / math.sqrt(math.pi), erfc(split * away) / away)
            if m or n:
                q = 2.0 * math.pi * math.hypot(m, n)
                wave = np.cos(2.0 * math.pi * (m * dx + n * dy))
                result += 2.0 * math.pi * math.erfc(0.5 * q / split) / q * wave
    return np.asarray(result / (math.pi * effective_modulus * size))


class State(NamedTuple):
    """The ensemble at one separation."""

    force: float  # [N]
    contact_area: float  # [m2]
    contact_count: int


class Paraboloids:
    """Paraboloids with heights and radii [m] under a work of adhesion [J/m2], which remember their contacts.

    ``green`` [m/N] couples them; zeros leave them independent.
    """

    def __init__(self, height: Floats, radius: Floats, green: Floats, effective_modulus: float, work: float) -> None:
        self.height, self.green = height, green
        self._cubic = 4.0 * effective_modulus / (3.0 * radius)  # P = cubic a^3 - root a^(3/2)
        self._root = math.sqrt(8.0 * math.pi * work * effective_modulus)
        self._curvature = 1.0 / radius  # delta = curvature a^2 - stretch a^(1/2)
        self._stretch = math.sqrt(2.0 * math.pi * work / effective_modulus)
        self._a, self._force = np.zeros_like(height), np.zeros_like(height)
        self._fold = [self._find_fold(i) for i in range(height.size)]
        self._least = [self._indentation(a, i) if a > 0.0 else 0.0 for i, a in enumerate(self._fold)]

    def _load(self, a: float, i: int) -> float:
        """P [N]."""
        return float((self._cubic[i] * a**1.5 - self._root) * a**1.5)

    def _indentation(self, a: float, i: int) -> float:
        """delta_i + G_ii P_i [m]."""
        alone = self._curvature[i] * a * a - self._stretch * math.sqrt(a)
        return float(alone + self.green[i, i] * self._load(a, i))

    def _slope(self, a: float, i: int) -> float:
        """Return the slope of ``_indentation`` over a [1]."""
        by_load = 3.0 * self._cubic[i] * a * a - 1.5 * self._root * math.sqrt(a)
        return float(2.0 * self._curvature[i] * a - 0.5 * self._stretch / math.sqrt(a) + self.green[i, i] * by_load)

    def _find_fold(self, i: int) -> float:
        """Return the radius at which contact i detaches while the others keep their forces; 0 without adhesion."""
        alone = float((0.25 * self._stretch / self._curvature[i]) ** (2.0 / 3.0))
        return float(brentq(lambda a: self._slope(a, i), 0.1 * alone, 10.0 * alone)) if alone else 0.0

    def _equilibrium(self, target: float, i: int) -> float:
        """Return the stable radius at which delta_i + G_ii P_i is ``target``, 0 if the contact is lost or not made."""
        if target <= (self._least[i] if self._a[i] > 0.0 else 0.0):
            return 0.0
        high = 2.0 * max(self._fold[i], math.sqrt(max(target, 0.0) / self._curvature[i]))
        for _ in range(_DOUBLINGS):
            if self._indentation(high, i) >= target:
                low = self._fold[i]
                return float(
                    brentq(lambda a: self._indentation(a, i) - target, low, high, xtol=_TINY, rtol=_RTOL_RADIUS)
                )
            high *= 2.0
        raise OutOfRange("a contact grows without end: its neighbours are nearer than their radii")

    def press(self, separation: float) -> State:
        """Return the state at ``separation`` [m], from that of the last call on: call it along a path.

        OutOfRange where the contacts do not come to rest, as where some are nearer than their radii.
        """
        for _ in range(_MAX_SWEEPS):
            moved = 0.0
            for i in range(self.height.size):
                others = float(self.green[i] @ self._force) - float(self.green[i, i] * self._force[i])
                a = self._equilibrium(float(self.height[i]) - separation - others, i)
                load = self._load(a, i) if a > 0.0 else 0.0
                moved = max(moved, abs(load - self._force[i]))
                self._a[i], self._force[i] = a, load
            if moved <= 10.0 * _RTOL * float(np.abs(self._force).max()):
                area = math.pi * float(np.sum(self._a**2))
                return State(float(self._force.sum()), area, int(np.count_nonzero(self._a)))
        raise OutOfRange(f"separation is {separation:g} m: the contacts do not come to rest")
