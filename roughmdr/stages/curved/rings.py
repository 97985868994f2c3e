"""Rings of a nominal contact: nodes of elements on which the pressure is quadratic in the radius."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats


class Rings(NamedTuple):
    """Radii from the axis outwards: the ends and the middle of elements, on which a field is quadratic in r."""

    radius: Floats
    """[m]: [2 elements + 1], the first is 0."""

    @classmethod
    def between(cls, ends: Floats) -> "Rings":
        """Return rings with elements between ascending ``ends`` [m]."""
        radius = np.empty(2 * ends.size - 1)
        radius[::2], radius[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
        return cls(radius)

    @property
    def ends(self) -> Floats:
        """The ends of the elements [m]."""
        return self.radius[::2]

    @property
    def weights(self) -> Floats:
        """Weights of ∫ v dr [m], exact for cubics (Simpson)."""
        widths = np.diff(self.ends) / 6.0
        weights = np.zeros_like(self.radius)
        weights[:-1:2] += widths
        weights[1::2] += 4.0 * widths
        weights[2::2] += widths
        return weights

    @property
    def area_weights(self) -> Floats:
        """Weights of ∫ v 2 pi r dr [m2], exact for fields that are quadratic on each element."""
        return 2.0 * np.pi * self.radius * self.weights

    def halved(self, chosen: NDArray[np.bool_]) -> "Rings":
        """Return rings in which the ``chosen`` elements are halved."""
        return Rings.between(np.sort(np.concatenate([self.ends, self.radius[1::2][chosen]])))

    def doubt(self, field: Floats) -> Floats:
        """Return an estimate of the error of ∫ field 2 pi r dr over each element: [..., element].

        It is from the jumps of the slope at the ends of the elements, which are errors of the quadratic interpolation.
        ``field`` is [..., ring].
        """
        width = np.diff(self.ends)
        first, middle, last = field[..., :-1:2], field[..., 1::2], field[..., 2::2]
        at_first = (4.0 * middle - 3.0 * first - last) / width
        at_last = (first - 4.0 * middle + 3.0 * last) / width
        jump = np.zeros((*field.shape[:-1], self.ends.size))
        jump[..., 1:-1] = np.abs(at_first[..., 1:] - at_last[..., :-1])
        jump[..., -1] = np.abs(at_last[..., -1])
        return np.asarray(_JUMP * (jump[..., :-1] + jump[..., 1:]) * width * 2.0 * np.pi * self.radius[1::2] * width)


_JUMP = 1.0 / 24.0
"""About the integral, over half an element of width 1, of the cubic that vanishes at its ends and its middle, for a
jump of 1 of the slope."""
