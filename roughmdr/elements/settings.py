"""The accuracy that a reference by boundary elements is asked for."""

from typing import NamedTuple

DEFAULT_ERROR, LEAST_ERROR, MOST_ERROR = 0.02, 1e-3, 0.5


class Reference(NamedTuple):
    """A law by boundary elements beside that of the asperities."""

    error: float = DEFAULT_ERROR
    """Of its force by the grid [1]."""
