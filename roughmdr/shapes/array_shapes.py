"""Shapes whose parameters are arrays: one profile of all asperities, or a table of each."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import floats_in_si
from roughmdr.shapes.base import ProfileShape


class ArrayShape(ProfileShape):
    """A shape whose parameters are arrays. Shapes of equal parameters are equal and have one hash."""

    def _identity(self) -> tuple[object, ...]:
        """Return the parameters as values that can be compared and hashed."""
        return tuple(
            tuple(value.items()) if isinstance(value, Mapping) else tuple(np.atleast_1d(value).tolist())
            for value in self.parameters.values()
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ArrayShape) and type(other) is type(self) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash((type(self), self._identity()))

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore a shape that was pickled; NumPy forgets that its parameters are read-only."""
        vars(self).update(state)
        for value in self.parameters.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)


class SharedProfile(ArrayShape):
    """A shape whose parameters are arrays, so that all asperities of an ensemble share one profile."""

    shared = True
    dimension: ClassVar[str]  # the one of its arrays in the Dataset of an ensemble

    @property
    def columns(self) -> dict[str, Floats]:
        """The parameters as equally long arrays."""
        return dict[str, Any](self.parameters)

    @classmethod
    def from_columns(cls, columns: dict[str, Floats]) -> Self:
        """Return the shape of such arrays; ShapeError as the shape itself."""
        return cls(**columns)

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Any]) -> tuple[Any, Any, Any]:
        return cls(**parameters).nondimensional()

    @property
    def end(self) -> float:
        return math.inf


class TabledShape(ArrayShape):
    """A shape whose parameters are arrays, of which each asperity of an ensemble has its own, all equally long.

    Parameters of asperities are arrays [asperity, point], and params a row each.
    """

    dimension: ClassVar[str]  # the one of its arrays in the Dataset of an ensemble, beside ``asperity``


def power_of_two(values: ArrayLike) -> Any:
    """Return the powers of two next to positive numbers: a unit, since dividing by it changes no bit."""
    return 2.0 ** np.frexp(values)[1]


def equal_rows(owner: str, fewest: int, **columns: ArrayLike) -> list[Floats]:
    """Return columns in metres as read-only floats; ShapeError unless finite, and equally many in rows of so many."""
    rows = [_lengths_in_a_row(owner, name, values, fewest) for name, values in columns.items()]
    if rows[0].size != rows[1].size:
        first, second = columns
        raise ShapeError(
            f"{owner}: {first} holds {rows[0].size} numbers and {second} {rows[1].size}; they must be equally many"
        )
    return rows


def _lengths_in_a_row(owner: str, name: str, values: ArrayLike, fewest: int) -> Floats:
    """Return ``values`` in metres as read-only floats; ShapeError unless finite and a row of so many at least."""
    try:
        row = floats_in_si(name, values, "m", "a list of numbers")
    except OutOfRange as error:
        raise ShapeError(f"{owner}: {error}") from None
    if row.ndim != 1 or row.size < fewest:
        raise ShapeError(f"{owner}: {name} has the shape {row.shape}; it must be a row of at least {fewest}")
    if not np.isfinite(row).all():
        where = int(np.argmin(np.isfinite(row)))
        raise ShapeError(f"{owner}: {name}[{where}] is {row[where]}; it must be finite")
    row.setflags(write=False)
    return row
