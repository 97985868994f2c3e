"""A profile that is given by its MDR profile."""

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import mdr_pieces
from roughmdr.shapes.array_shapes import TabledShape, equal_rows, power_of_two

_MIN_STEP = 1e-6  # least step, over the last radius and the last g: nearer points leave no digits to the slope
_MAX_LENGTH = 1e100  # [m], so that the squares of radii are floats


class MdrTable(TabledShape):
    """g [m] at contact radii a [m], the indentation of a contact without adhesion; both rise, from above 0.

    Between the points, and to the tip, g is a monotone cubic in a^2, beyond them a paraboloid. Every rising g is that
    of a profile (inverse of H 17), whose contact is a disc; f follows from it. In an ensemble each asperity has a table
    of its own, all with equally many points.

    Raises
    ------
    ShapeError
        Unless a and g are equally many numbers, at least one, finite, above 0 and rising by more than a millionth of
        the last of them.
    """

    name = "mdr_table"
    units: ClassVar[dict[str, str]] = {"a": "m", "g": "m"}
    dimension = "point"
    profile = mdr_pieces.PROFILE

    def __init__(self, a: ArrayLike, g: ArrayLike) -> None:
        self.radii, self.indentations = equal_rows(self.name, 1, a=a, g=g)
        self.check(self.parameters)

    def __repr__(self) -> str:
        return f"MdrTable({self.radii.size} points to a={self.radii[-1]:g}, g={self.indentations[-1]:g})"

    @classmethod
    def example(cls) -> dict[str, Any]:
        return {"a": [1.0, 2.0], "g": [1.0, 5.0]}

    @property
    def parameters(self) -> dict[str, Any]:
        return {"a": self.radii, "g": self.indentations}

    @classmethod
    def check(cls, parameters: Any) -> None:
        for name, values in parameters.items():
            table = np.atleast_2d(values)
            last = table[:, -1:]
            wrong = ~((np.diff(table, axis=1, prepend=0.0) > _MIN_STEP * last) & (last < _MAX_LENGTH))
            wrong |= last <= 1.0 / _MAX_LENGTH
            if wrong.any():
                row, k = (int(at) for at in np.argwhere(wrong)[0])
                where = "" if table.shape[0] == 1 else f" at asperity {row}"
                before = f" after {table[row, k - 1]:g} m" if k > 0 else ""
                raise ShapeError(
                    f"mdr_table: {name}[{k}] is {table[row, k]:g} m{before}{where}; {name} must rise from above 0, by "
                    f"more than {_MIN_STEP:g} of its last number, which must be between 1e-100 and 1e100 m"
                )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Return powers of two next to the last a and g as width and rise."""
        a, g = (np.atleast_2d(parameters[name]) for name in ("a", "g"))
        width, rise = power_of_two(a[:, -1]), power_of_two(g[:, -1])
        return width, rise, mdr_pieces.rows_of(a / width[:, None], g / rise[:, None])

    @cached_property
    def _nondimensional(self) -> tuple[float, float, Floats]:
        width, rise, params = self.nondimensionalise(self.parameters)
        return float(width[0]), float(rise[0]), params[0]

    def nondimensional(self) -> tuple[float, float, Any]:
        return self._nondimensional

    def precisely(self, t: float) -> tuple[Any, Any, Any]:
        """Return a, g and a g - G as ``ProfileShape`` does, here from the antiderivatives of each piece."""
        from mpmath import mp

        with mp.workdps(40):
            width, rise, _ = self.nondimensional()
            radii, depths = self.radii / width, self.indentations / rise
            slopes = mdr_pieces.knot_slopes(radii[None], depths[None])[0]
            points = [(mp.mpf(0), mp.mpf(0)), *zip(map(mp.mpf, radii), map(mp.mpf, depths), strict=True)]
            a, g, load = mp.mpf(t), mp.mpf(0), mp.mpf(0)
            for k, (begin, value) in enumerate(points):
                if begin > a:
                    break
                first, second, third = mp.mpf(slopes[k]), mp.mpf(0), mp.mpf(0)
                end = a
                if k + 1 < len(points):
                    following, after = points[k + 1]
                    h = following**2 - begin**2
                    chord, last = (after - value) / h, mp.mpf(slopes[k + 1])
                    second, third = (3 * chord - 2 * first - last) / h, (first + last - 2 * chord) / h**2
                    end = min(a, following)
                s = begin**2
                # dg/ds in powers of s
                powers = first - 2 * second * s + 3 * third * s**2, 2 * second - 6 * third * s, 3 * third
                g = value + sum(c * (end ** (2 * i + 2) - begin ** (2 * i + 2)) / (i + 1) for i, c in enumerate(powers))
                load += sum(
                    2 * c * (end ** (2 * i + 3) - begin ** (2 * i + 3)) / (2 * i + 3) for i, c in enumerate(powers)
                )
            return width * a, rise * g, width * rise * load


def rising(g: Floats) -> Floats:
    """Return g [table, point] with the least rise from point to point that a table may have where it rises less."""
    steps = np.diff(g, axis=1, prepend=0.0)
    return np.asarray(np.cumsum(np.maximum(steps, 2.0 * _MIN_STEP * np.abs(g).max(axis=1, keepdims=True)), axis=1))
