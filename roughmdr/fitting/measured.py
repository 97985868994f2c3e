"""A measured curve: force or pressure against separation or the far end of a spring, in the order of measurement."""

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.fitting.columns import read_columns
from roughmdr.fitting.formats import Columns
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import format_quantity, quantity, unit_factor
from roughmdr.schema.wording import printable, short_repr, suggestion
from roughmdr.variables import MEASURED

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_TURNS, _LONG_STEP = 1.0 / 3.0, 0.1  # share of turns and mean step over the range of mixed rows: 2/3, 1/3 by chance
_OF_DIFFERENCES = 0.6745 * 20.0**0.5  # median of third differences of noise, over its standard deviation
_SCATTER = 4.2  # three relative standard errors of a deviation found by such differences, over 1/sqrt(points)
_CONTROLS, _LOADS = ("separation", "remote", "piezo"), ("force", "pressure")


class MeasuredCurve(NamedTuple):
    """A measured curve in SI, row by row."""

    control: str
    """ "separation", or "remote" of the far end of a machine's spring, which is minus the extension of a piezo."""
    values: Floats
    """Values of the control [m]."""
    quantity: str
    """ "force" or "pressure"."""
    load: Floats
    """Values of the quantity [N or Pa]."""
    error: Floats | None
    """Standard deviation of each load [N or Pa]; None where it is not known."""
    origin: str
    """The file or argument it is from."""
    stiffness: float | None = None
    """Spring constant of the cantilever that the file tells [N/m]."""
    about: str = ""
    """The format of the file and what was taken from it, in words."""
    level: Floats | float = 0.0
    """The load without contact [N or Pa]: a guess before the search, the baseline after it; 0 unless that is fitted."""

    @property
    def far(self) -> float:
        """The median of the load in the tenth of the rows that is farthest from contact."""
        return float(np.median(self.load[self.values >= np.quantile(self.values, 0.9)]))

    @property
    def largest(self) -> float:
        """The largest load, in size, over that without contact."""
        return float(np.abs(self.load - self.level).max())

    @property
    def unit(self) -> str:
        """The unit of the load."""
        return MEASURED[self.quantity]

    @property
    def weight(self) -> Floats:
        """The divisor of deviations: the error of each load, or the largest load."""
        return np.full_like(self.load, np.abs(self.load).max()) if self.error is None else self.error

    @property
    def noise(self) -> float:
        """The standard deviation of the noise of the load [N or Pa], by third differences."""
        return float(np.median(np.abs(np.diff(self.load, 3)))) / _OF_DIFFERENCES

    def relative_rms(self, deviations: Floats) -> float:
        """Return the root mean square of the deviations, without those from priors, over the largest load."""
        loads = deviations[: self.load.size] * self.weight
        return float(np.sqrt(np.mean(np.square(loads))) / self.largest)

    def has_less_noise(self, deviations: Floats) -> bool:
        """Return whether deviations are larger than the scatter of neighbours, by third differences of the load."""
        most = (1.0 + _SCATTER / np.sqrt(self.load.size)) * self.noise
        return bool(self.relative_rms(deviations) * self.largest > most)

    def is_mixed(self) -> bool:
        """Return whether the control goes to and fro from row to row, by much more than a sensor's noise."""
        steps = np.diff(self.values)
        turns = np.mean(steps[1:] * steps[:-1] < 0.0)
        return bool(turns > _TURNS and np.abs(steps).mean() > _LONG_STEP * np.ptp(self.values))

    def backwards(self) -> "MeasuredCurve":
        """Return the curve row by row from its end."""
        error = None if self.error is None else self.error[::-1]
        return self._replace(values=self.values[::-1], load=self.load[::-1], error=error)


def read_measured(measured: "str | Path | pd.DataFrame | xr.Dataset | Columns", parameters: int) -> MeasuredCurve:
    """Return a measured curve that ``parameters`` numbers are fitted to; StoreError where it is wrong.

    The message names file, line, column, value and what is allowed.
    """
    columns = measured if isinstance(measured, Columns) else read_columns(measured)
    given = _one_of(columns, _CONTROLS)
    load = _one_of(columns, _LOADS)
    _check_names(columns, (given, load, f"{load}_error"))
    numbers = {name: _read(columns, name) for name in columns.names}
    least = parameters + 3
    if len(columns.rows) < least:
        raise StoreError(f"{columns.origin}: has {len(columns.rows)} rows; at least {least} are needed")
    for name, wanted in ((load, "with contact"), (given, "along which it changes")):
        if not np.ptp(numbers[name]):
            same = format_quantity(numbers[name][0], MEASURED[name]) if numbers[name][0] else "0"
            raise StoreError(f"{columns.origin}: {name} is {same} in every row; a curve {wanted} is needed")
    error = numbers.get(f"{load}_error")
    control, values = ("remote", -numbers[given]) if given == "piezo" else (given, numbers[given])
    origin, stiffness, about = columns.origin, columns.stiffness, columns.about
    return MeasuredCurve(control, values, load, numbers[load], error, origin, stiffness, about)


def _one_of(columns: Columns, names: tuple[str, ...]) -> str:
    """Return which of some columns there is; StoreError where it is none or several."""
    found = [name for name in names if name in columns.names]
    if len(found) != 1:
        there = " and ".join(found) or f"neither among {', '.join(map(printable, columns.names)) or 'no columns'}"
        listed = " or ".join([", ".join(names[:-1]), names[-1]])
        raise StoreError(f"{columns.origin}: needs one column {listed}; it has {there}")
    return found[0]


def _check_names(columns: Columns, allowed: tuple[str, ...]) -> None:
    """StoreError for a column that is not known, or given twice, or whose unit is none of its dimension."""
    for position, (name, unit) in enumerate(zip(columns.names, columns.units, strict=True)):
        if name not in allowed:
            hint = suggestion(name, list(allowed))
            raise StoreError(f"{columns.origin}: column {short_repr(name)}: not known{hint}")
        if name in columns.names[:position]:
            raise StoreError(f"{columns.origin}: column {name!r}: is given twice")
        try:
            unit_factor(unit, MEASURED[name])
        except RoughmdrError as error:
            raise StoreError(f"{columns.origin}: column {name!r}: {error}") from None


def _read(columns: Columns, name: str) -> Floats:
    """Return a column in SI; StoreError for an entry that is no finite number, or an error that is not above 0."""
    position, dimension = columns.names.index(name), MEASURED[name]
    unit, entries = columns.units[position], [row[position] for _, row in columns.rows]
    is_si = unit_factor(unit, dimension) == 1
    values = np.array([each if is_si and isinstance(each, float) else np.nan for each in entries])

    def wrong(i: int, reason: str) -> StoreError:
        return StoreError(f"{columns.origin}: {columns.rows[i][0]}: {name} = {short_repr(entries[i])}: {reason}")

    for i in np.flatnonzero(~np.isfinite(values)).tolist():
        try:
            values[i] = quantity(f"{entries[i]} {unit}", dimension)
        except RoughmdrError as error:
            raise wrong(i, str(error)) from None
    if name.endswith("_error") and not (values > 0.0).all():
        raise wrong(int(np.argmin(values > 0.0)), "must be above 0")
    return values
