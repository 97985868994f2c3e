"""A variable of a dataset or a file, and a diagnostic of a run: its name, unit and description."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Variable:
    """A variable of a dataset or a file, in SI units."""

    name: str
    units: str
    long_name: str
    codes: tuple[str, ...] = ()
    """Meanings of its values 0, 1, ..., where these are codes."""

    @property
    def attrs(self) -> dict[str, str]:
        """Its attributes in xarray and netCDF."""
        return {"units": self.units, "long_name": self.long_name}


@dataclass(frozen=True)
class Diagnostic(Variable):
    """A number or text that describes one run beside its curves, and the rule that merges those of several runs."""

    dtype: type = float
    merge: Literal["add", "maximum", "fmax", "fmin", "first"] = "fmax"
    """A ufunc of NumPy (``fmax`` and ``fmin`` ignore NaN, which ``maximum`` keeps); of texts the ``first`` one."""
    missing: Any = math.nan
    """Value of a run that did not run, or that failed."""
    unstated: Any = math.nan
    """Value of a run that is done, in a result or checkpoint without this diagnostic."""
    in_result: Callable[[Any], bool] = lambda scene: True
    """Whether a result with a cell of this scene has it; a text is there only if some run has one."""


def declare(*rows: tuple[str, str, str] | tuple[str, str, str, tuple[str, ...]]) -> dict[str, Variable]:
    """Return variables by their names, from name, unit, description and codes."""
    return {row[0]: Variable(*row) for row in rows}
