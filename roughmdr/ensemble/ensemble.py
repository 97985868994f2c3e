"""An ensemble of asperities: plain arrays inside, an xarray dataset outside."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.arguments import Floats, check_number
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError, ShapeError
from roughmdr.labelled import Array, Labelled
from roughmdr.shapes import SHAPES
from roughmdr.shapes.base import check_positive
from roughmdr.units import unit_factor
from roughmdr.variables import COORDINATES

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Ensemble:
    """Asperities of one shape, from the highest to the lowest summit; all arrays are equally long, in SI units."""

    shape: str
    height: Floats
    parameters: dict[str, Floats]
    nominal_area: float | None = None
    positions: dict[str, Floats] = field(default_factory=dict)
    attrs: dict[str, float | int | str] = field(default_factory=dict)

    @classmethod
    def sorted(
        cls,
        shape: str,
        height: Floats,
        parameters: dict[str, Floats],
        nominal_area: float | None = None,
        positions: dict[str, Floats] | None = None,
        attrs: dict[str, float | int | str] | None = None,
    ) -> "Ensemble":
        """The ensemble in its one order: descending height, equal heights by their parameters."""
        order = np.argsort(-height, kind="stable")
        descending = height[order]
        if (descending[1:] == descending[:-1]).any():
            order = np.lexsort((*parameters.values(), -height))
        pick = {name: np.ascontiguousarray(column[order]) for name, column in parameters.items()}
        places = {name: np.ascontiguousarray(column[order]) for name, column in (positions or {}).items()}
        return cls(shape, np.ascontiguousarray(height[order]), pick, nominal_area, places, attrs or {})

    def columns(self) -> tuple[Floats, Floats, Floats]:
        """Width [m], rise [m] and form [1] of each asperity."""
        return SHAPES[self.shape].stretch(self.parameters)

    def labelled(self) -> Labelled:
        """The arrays over ``asperity``, with their units."""
        units = SHAPES[self.shape].units
        variables = {"height": Array(("asperity",), self.height, COORDINATES["height"].attrs)}
        for name, column in self.parameters.items():
            attrs = {"units": units[name], "long_name": f"{name} of the {self.shape}"}
            variables[name] = Array(("asperity",), column, attrs)
        for name, column in self.positions.items():
            variables[name] = Array(("asperity",), column, COORDINATES[name].attrs)
        area = {} if self.nominal_area is None else {"nominal_area": self.nominal_area}
        return Labelled(variables, {}, {"shape": self.shape, **self.attrs, **area})

    @classmethod
    def from_dataset(cls, dataset: "xr.Dataset") -> "Ensemble":
        """An ensemble from a dataset over ``asperity`` in any order; missing units mean SI.

        SceneError, naming the variable or attribute, where something is missing, not finite or out of range.
        """
        shape = dataset.attrs.get("shape")
        if not isinstance(shape, str) or shape not in SHAPES:
            raise SceneError(f"ensemble: attribute shape is {shape!r}; it must be one of {', '.join(SHAPES)}")
        kind = SHAPES[shape]
        given = {name for name in kind.units if name in dataset}
        try:
            spelling = kind.spelling(given)
        except ShapeError as error:
            raise SceneError(f"ensemble: {error}") from None
        height = _column(dataset, "height", "m")
        parameters = {name: _column(dataset, name, kind.units[name]) for name in spelling}
        for name, column in parameters.items():
            try:
                check_positive(shape, name, column)
            except ShapeError as error:
                raise SceneError(f"ensemble: {error}") from None
        positions = {name: _column(dataset, name, "m") for name in ("x", "y") if name in dataset}
        return cls.sorted(shape, height, parameters, _nominal_area(dataset.attrs), positions)


def _nominal_area(attrs: dict[str, Any]) -> float | None:
    """The nominal area [m2], or else what the sides of the patch make of it."""

    def number(name: str) -> float:
        try:
            return check_number(f"ensemble: attribute {name}", attrs[name], "in SI")
        except OutOfRange as error:
            raise SceneError(str(error)) from None

    if "nominal_area" in attrs:
        return number("nominal_area")
    if "patch" in attrs:
        return number("patch") ** 2
    if "patch_x" in attrs and "patch_y" in attrs:
        return number("patch_x") * number("patch_y")
    return None


def _column(dataset: "xr.Dataset", name: str, unit: str) -> Floats:
    if name not in dataset:
        raise SceneError(f"ensemble: variable {name!r} is missing")
    variable = dataset[name]
    if variable.dims != ("asperity",):
        raise SceneError(f"ensemble: {name} lies over {variable.dims}; it must lie over ('asperity',)")
    if variable.size == 0:
        raise SceneError("ensemble: it has no asperity; at least one is needed")
    if variable.dtype.kind not in "iuf":
        raise SceneError(f"ensemble: {name} is of type {variable.dtype}; it must be numbers")
    try:
        given = str(variable.attrs.get("units", ""))
        factor = 1.0 if given == unit else float(unit_factor(given, unit))
    except RoughmdrError as error:
        raise SceneError(f"ensemble: units of {name}: {error}") from None
    column = np.asarray(variable.to_numpy(), dtype=np.float64) * factor
    if not np.isfinite(column).all():
        where = int(np.argmin(np.isfinite(column)))
        raise SceneError(f"ensemble: {name} is {column[where]} at asperity {where}; it must be finite")
    return column
