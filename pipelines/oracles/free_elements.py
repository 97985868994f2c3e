"""A rigid height map alone on an elastic half-space by boundary elements, without adhesion.

ContactMechanics solves it as in ``boundary_elements``, with the Green's function of a half-space that does not repeat.
Separations count from the undeformed plane. In the reduced problem the side of a point, the deepest overlap and E*
are 1.
"""

import math

import numpy as np

from oracles.boundary_elements import forces_of_cells
from roughmdr.numerics.arguments import Floats


class FreeMap:
    """Heights [m] on a grid of square cells of the side ``spacing`` [m], pressed into a half-space of E* = 1."""

    def __init__(self, height: Floats, spacing: float) -> None:
        from ContactMechanics import FreeFFTElasticHalfSpace

        self.height, self.spacing = height, spacing
        sides = tuple(float(points) for points in height.shape)
        self._half_space = FreeFFTElasticHalfSpace(height.shape, 1.0, sides)
        self.forces = np.zeros_like(height)
        """[m2], of the cells at the last separation."""

    def press(self, separation: float) -> float:
        """Return the force [m2] at a separation [m]; NaN where none is found. It starts from the last forces."""
        deepest = float(self.height.max()) - separation
        if deepest <= 0.0:
            self.forces = np.zeros_like(self.height)
            return 0.0
        unit = deepest * self.spacing
        found = forces_of_cells(self._half_space, self.height / deepest, separation / deepest, self.forces / unit)
        if found is None:
            self.forces = np.zeros_like(self.height)
            return math.nan
        self.forces = found * unit
        return float(self.forces.sum())

    def stiffness(self, separation: float, step: float) -> float:
        """Return -dF/dh [m] by a central difference of ``step`` [m] each way; the forces stay as they are."""
        kept = self.forces
        nearer, farther = self.press(separation - step), self.press(separation + step)
        self.forces = kept
        return (nearer - farther) / (2.0 * step)
