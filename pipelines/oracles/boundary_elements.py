"""A rigid height map on an elastic half-space by boundary elements: periodic, without adhesion; areas.

ContactMechanics solves it (fast Fourier transform, and the constrained conjugate gradients of I. A. Polonsky and
L. M. Keer, Wear 231 (1999), 206). The mean displacement is held at 0, so that separations count from the mean plane of
the deformed half-space. In the reduced problem the patch, the deepest overlap and E* are 1.

Contact areas are found from the pressures of a periodic square grid, as shares of it. The number of cells under
pressure is too large: a cell at the edge counts in full. With contacts of some ten cells in radius it is off by 1 % or
more.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.elements.half_space import connected
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats

_RTOL_FORCE = 1e-7  # the largest change of the force over an iteration at the end
_RTOL_OVERLAP = 1e-6  # and the overlap that is left, over the deepest one
_MAX_ITERATIONS = 2000  # next to full contact; elsewhere some 50
_EDGE_SHARE = (math.pi - 1.0 + math.log(2.0)) / 24.0  # share of cells a side at the edge (Yastrebov et al.)


class Pressed(NamedTuple):
    """The state at one separation."""

    force: float  # [N]
    contact_area: float  # [m2], of all grid cells under pressure; by_perimeter has a better one


class HeightMap:
    """Heights [m] on a periodic square grid over ``size`` [m], pressed into a half-space of ``effective_modulus``."""

    def __init__(self, height: Floats, size: float, effective_modulus: float = 1.0) -> None:
        from ContactMechanics import PeriodicFFTElasticHalfSpace

        self.height = np.asarray(height, dtype=np.float64)
        self.size = size
        self.effective_modulus = effective_modulus
        self._half_space = PeriodicFFTElasticHalfSpace(self.height.shape, 1.0, (1.0, 1.0), stiffness_q0=0.0)
        self._forces = np.zeros_like(self.height)  # [E* size m] of the grid cells, at the last separation

    @property
    def pressure(self) -> Floats:
        """[Pa], of the grid cells at the last separation."""
        return np.asarray(self._forces * (self.effective_modulus * self._forces.size / self.size))

    def press(self, separation: float) -> Pressed:
        """Return force and contact area at ``separation`` [m] of the datum plane from the deformed mean plane.

        The force is infinite from the mean height on: no half-space whose mean plane stays fits in. It starts from the
        pressures of the last call: call it with separations in order. OutOfRange where it does not converge.
        """
        from ContactMechanics.Optimization import constrained_conjugate_gradients

        deepest = float(self.height.max()) - separation
        if deepest <= 0.0:
            return Pressed(0.0, 0.0)
        if separation <= float(self.height.mean()):
            return Pressed(math.inf, self.size**2)
        found = constrained_conjugate_gradients(
            self._half_space, self.height / deepest, offset=-separation / deepest,
            initial_forces=-self._forces / deepest if self._forces.any() else None,
            thermotol=_RTOL_FORCE, pentol=_RTOL_OVERLAP, forcetol=_RTOL_OVERLAP / self.height.size,
            maxiter=_MAX_ITERATIONS,
        )  # fmt: skip
        if not found.success:
            raise OutOfRange(f"separation is {separation:g} m: boundary elements do not converge")
        self._forces = np.asarray(found.jac) * deepest
        force = self.effective_modulus * self.size * float(self._forces.sum())
        return Pressed(force, float(np.mean(self._forces > 0.0)) * self.size**2)


def by_perimeter(pressure: Floats) -> float:
    """Return the area with the mean share of the cells at the edge taken off, for contacts of any shape.

    V. A. Yastrebov, G. Anciaux and J.-F. Molinari, Tribol. Int. 114 (2017), 161.
    """
    loaded = pressure > 0.0
    sides = sum(np.count_nonzero(loaded != np.roll(loaded, 1, axis)) for axis in (0, 1))
    return float(np.count_nonzero(loaded) - _EDGE_SHARE * sides) / pressure.size


def of_half_ellipsoids(pressure: Floats) -> float:
    """Return the area of separated contacts of paraboloids, whose pressure is half an ellipsoid: 9/8 (∫p)²/∫p² each.

    Neighbours change that shape of the pressure only in the fourth derivative of the displacement.
    """
    contact = connected(pressure > 0.0, across=True)[0].ravel()
    first, second = (np.bincount(contact, pressure.ravel() ** power) for power in (1, 2))
    loaded = second > 0.0
    return 1.125 * float(np.sum(first[loaded] ** 2 / second[loaded])) / pressure.size
