"""The variable ``run_time`` in memory. It is imported with xarray, which takes long, where a Dataset is made."""

from typing import Any

import xarray as xr


class Clocked(xr.Variable):
    """A variable that depends on the clock: its values in two runs of one cell do not conflict where they are merged.

    Selections, copies and merges keep the class; in a file it is a variable as any other.
    """

    __slots__ = ()

    def no_conflicts(self, other: xr.Variable, equiv: Any = None) -> bool:
        """Return whether another variable has the same dimensions; the first of two that are merged is kept."""
        return self.dims == other.dims and self.shape == other.shape
