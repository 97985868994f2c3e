"""A rigid height map on an elastic half-space by boundary elements: periodic, without adhesion.

ContactMechanics solves it (fast Fourier transform, and the constrained conjugate gradients of I. A. Polonsky and
L. M. Keer, Wear 231 (1999), 206). The mean displacement is held at 0, so that separations count from the mean plane of
the deformed half-space. In the reduced problem the patch, the deepest overlap and E* are 1.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats

_RTOL_FORCE = 1e-7  # the largest change of the force over an iteration at the end
_RTOL_OVERLAP = 1e-6  # and the overlap that is left, over the deepest one
_MAX_ITERATIONS = 2000  # next to full contact; elsewhere some 50


class Pressed(NamedTuple):
    """The state at one separation."""

    force: float
    """[N]"""
    contact_area: float
    """[m2], of all grid cells under pressure; ``contact_areas`` has better ones"""


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
        deepest = float(self.height.max()) - separation
        if deepest <= 0.0:
            return Pressed(0.0, 0.0)
        if separation <= float(self.height.mean()):
            return Pressed(math.inf, self.size**2)
        found = forces_of_cells(self._half_space, self.height / deepest, separation / deepest, self._forces / deepest)
        if found is None:
            raise OutOfRange(f"separation is {separation:g} m: boundary elements do not converge")
        self._forces = found * deepest
        force = self.effective_modulus * self.size * float(self._forces.sum())
        return Pressed(force, float(np.mean(self._forces > 0.0)) * self.size**2)


def forces_of_cells(half_space: Any, height: Floats, separation: float, start: Floats) -> Floats | None:
    """Return the forces of the cells of a reduced problem, from a ``start`` like them; None where none are found.

    ``half_space`` is one of ContactMechanics, whose grid may be larger than the map.
    """
    from ContactMechanics.Optimization import constrained_conjugate_gradients

    around = [(0, grid - points) for grid, points in zip(half_space.nb_domain_grid_pts, height.shape, strict=True)]
    found = constrained_conjugate_gradients(
        half_space,
        height,
        offset=-separation,
        initial_forces=np.pad(-start, around) if start.any() else None,
        thermotol=_RTOL_FORCE,
        pentol=_RTOL_OVERLAP,
        forcetol=_RTOL_OVERLAP / height.size,
        maxiter=_MAX_ITERATIONS,
    )
    return np.asarray(found.jac) if found.success else None
