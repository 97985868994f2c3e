"""An exported file before it is written in the syntax of a code: its header and its columns, in the units asked for."""

from typing import NamedTuple

from roughmdr.numerics.arguments import Floats


class Column(NamedTuple):
    """A column of numbers."""

    name: str
    unit: str
    values: Floats


class Document(NamedTuple):
    """A table with all that is said about it."""

    quantity: str
    """As ``--quantity`` names it."""
    variable: str
    """The variable of the result that it is made from."""
    header: dict[str, str]
    """Names and texts."""
    columns: tuple[Column, ...]
    """The first two are what a code reads: the argument, then the value."""
    friction: float | None = None
    """Coefficient of friction of the scene; None where there is none."""

    @property
    def argument(self) -> Column:
        """The column that the value is a function of."""
        return self.columns[0]

    @property
    def value(self) -> Column:
        """The value itself."""
        return self.columns[1]
