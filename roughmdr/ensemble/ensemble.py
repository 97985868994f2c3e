"""An ensemble of asperities: plain arrays inside, an xarray dataset outside."""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.asperity.validity import ValidityLimits
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError, ShapeError
from roughmdr.kernels.interface import Columns
from roughmdr.numerics.arguments import Floats, check_number
from roughmdr.schema.units import unit_factor
from roughmdr.schema.wording import shown
from roughmdr.shapes import SHAPES, Shape, SharedProfile
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import COORDINATES

if TYPE_CHECKING:
    import xarray as xr

_SIDES = ("patch", "patch_x", "patch_y")


@dataclass(frozen=True)
class Ensemble:
    """Asperities of one shape, from the highest to the lowest summit; all arrays are equally long, in SI units."""

    shape: str
    height: Floats
    parameters: dict[str, Floats]
    nominal_area: float | None = None
    positions: dict[str, Floats] = field(default_factory=dict)
    attrs: dict[str, float | int | str] = field(default_factory=dict)
    fixed: SharedProfile | None = None
    """The one profile of all asperities, of a shape that has no plain numbers for parameters."""
    warnings: tuple[str, ...] = ()
    """What makes the asperities themselves doubtful, for the user."""

    @classmethod
    def sorted(
        cls,
        shape: str,
        height: Floats,
        parameters: dict[str, Floats],
        nominal_area: float | None = None,
        positions: dict[str, Floats] | None = None,
        attrs: dict[str, float | int | str] | None = None,
        fixed: SharedProfile | None = None,
    ) -> "Ensemble":
        """The ensemble in its one order: descending height, equal heights by their parameters."""
        order = np.argsort(-height, kind="stable")
        descending = height[order]
        if (descending[1:] == descending[:-1]).any():
            order = np.lexsort((*parameters.values(), -height))
        pick = {name: np.ascontiguousarray(column[order]) for name, column in parameters.items()}
        places = {name: np.ascontiguousarray(column[order]) for name, column in (positions or {}).items()}
        return cls(shape, np.ascontiguousarray(height[order]), pick, nominal_area, places, attrs or {}, fixed)

    def columns(self) -> Columns:
        """Return width, rise and params of each asperity; of a fixed profile its params in one row."""
        if self.fixed is None:
            with np.errstate(all="ignore"):  # what no float can hold is refused where contacts are looked for
                return Columns(*SHAPES[self.shape].nondimensionalise(self.parameters))
        width, rise, params = self.fixed.nondimensional()
        return Columns(np.full_like(self.height, width), np.full_like(self.height, rise), np.asarray(params)[None])

    def extremes(self, radius: Floats) -> ValidityLimits:
        """The most that contacts of these radii [m], 0 for none, come to."""
        if self.fixed is None:
            kind = SHAPES[self.shape]
            with np.errstate(all="ignore"):  # a slope that no float can hold is infinite
                slopes = kind.slopes(self.parameters, radius)
            return ValidityLimits.of(radius, slopes, kind.ends(self.parameters))
        return ValidityLimits.of(radius, self.fixed.df(radius), np.array(self.fixed.end))

    def labelled(self) -> Labelled:
        """The arrays over ``asperity``, with their units."""
        units = SHAPES[self.shape].units
        variables = {"height": Array(("asperity",), self.height, COORDINATES["height"].attrs)}
        for name, column in self.parameters.items():
            attrs = {"units": units[name], "long_name": f"{name} of the {self.shape}"}
            variables[name] = Array(("asperity",), column, attrs)
        if self.fixed is not None:
            for name, column in self.fixed.columns.items():
                attrs = {"units": units[name], "long_name": f"{name} of the {self.shape}, the same for all"}
                variables[name] = Array((self.fixed.along,), column, attrs)
        for name, column in self.positions.items():
            variables[name] = Array(("asperity",), column, COORDINATES[name].attrs)
        area = {} if self.nominal_area is None else {"nominal_area": self.nominal_area}
        doubts = {"warnings": "\n".join(self.warnings)} if self.warnings else {}
        return Labelled(variables, {}, {"shape": self.shape, **self.attrs, **area, **doubts})

    @classmethod
    def from_dataset(cls, dataset: "xr.Dataset") -> "Ensemble":
        """An ensemble from a dataset over ``asperity`` in any order; missing units mean SI.

        SceneError, naming the variable or attribute, where something is missing, not finite or out of range.
        """
        shape = dataset.attrs.get("shape")
        if not isinstance(shape, str) or shape not in SHAPES:
            raise SceneError(f"ensemble: attribute shape is {shown(shape)}; it must be one of {', '.join(SHAPES)}")
        kind = SHAPES[shape]
        height = _column(dataset, "height", "m")
        positions = {name: _column(dataset, name, "m") for name in ("x", "y") if name in dataset}
        try:
            parameters, fixed = _parameters(dataset, kind)
        except ShapeError as error:
            raise SceneError(f"ensemble: {error}") from None
        sides = {name: _size(name, dataset.attrs[name]) for name in _SIDES if name in dataset.attrs}
        doubts = dataset.attrs.get("warnings", "")
        if not isinstance(doubts, str):
            raise SceneError(f"ensemble: attribute warnings is {shown(doubts)}; it must be a text")
        area = _nominal_area(dataset.attrs, sides)
        found = cls.sorted(shape, height, parameters, area, positions, dict(sides), fixed)
        return replace(found, warnings=tuple(doubts.splitlines()))


def _parameters(dataset: "xr.Dataset", kind: type[Shape]) -> tuple[dict[str, Floats], SharedProfile | None]:
    """The parameters of each asperity, or the one profile of all."""
    if issubclass(kind, SharedProfile):
        columns = {name: _column(dataset, name, unit, kind.along) for name, unit in kind.units.items()}
        return {}, kind.of_columns(columns)
    spelling = kind.spelling({name for name in kind.units if name in dataset})
    parameters = {name: _column(dataset, name, kind.units[name]) for name in spelling}
    kind.check(parameters)
    return parameters, None


def _nominal_area(attrs: dict[str, Any], sides: dict[str, float]) -> float | None:
    """The nominal area [m2], or else what the sides of the patch make of it."""
    if "nominal_area" in attrs:
        return _size("nominal_area", attrs["nominal_area"])
    if "patch" in sides:
        return _size("patch, squared,", sides["patch"] * sides["patch"])
    if "patch_x" in sides and "patch_y" in sides:
        return _size("patch_x times patch_y", sides["patch_x"] * sides["patch_y"])
    return None


def _size(name: str, value: Any) -> float:
    """A length or an area of a patch, in SI."""
    try:
        return check_number(f"ensemble: attribute {name}", value, "in SI")
    except OutOfRange as error:
        raise SceneError(str(error)) from None


def _column(dataset: "xr.Dataset", name: str, unit: str, along: str = "asperity") -> Floats:
    if name not in dataset:
        raise SceneError(f"ensemble: variable {name!r} is missing")
    variable = dataset[name]
    if variable.dims != (along,):
        raise SceneError(f"ensemble: {name} lies over {variable.dims}; it must lie over ({along!r},)")
    if variable.size == 0:
        raise SceneError(f"ensemble: it has no {along}; at least one is needed")
    if variable.dtype.kind not in "iuf":
        raise SceneError(f"ensemble: {name} is of type {variable.dtype}; it must be numbers")
    try:
        given = str(variable.attrs.get("units", ""))
        factor = 1.0 if given == unit else float(unit_factor(given, unit))
    except RoughmdrError as error:
        raise SceneError(f"ensemble: units of {name}: {error}") from None
    with np.errstate(over="ignore"):  # refused below
        column = np.asarray(variable.to_numpy(), dtype=np.float64) * factor
    if not np.isfinite(column).all():
        where = int(np.argmin(np.isfinite(column)))
        raise SceneError(f"ensemble: {name} is {column[where]} at {along} {where}; it must be finite")
    return column
