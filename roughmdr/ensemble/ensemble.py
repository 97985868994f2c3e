"""An ensemble of asperities: plain arrays inside, an xarray dataset outside."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from roughmdr.asperity.validity import ValidityLimits, relative_loads
from roughmdr.ensemble.maps.resolution import FORCE_PER_RADIUS
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.kernels.interface import Columns
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number
from roughmdr.schema.units import unit_factor
from roughmdr.schema.wording import short_repr
from roughmdr.shapes import SHAPES, Shape, SharedProfile, TabledShape
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import COORDINATES

Origin = Literal["asperities", "summits", "hills"]
"""Asperities on a plane, the summits of a continuous surface, or its hills."""

if TYPE_CHECKING:
    import xarray as xr

_SIDES = ("patch", "patch_x", "patch_y")
_OF_HILLS = ("resolution_error", "border_error", "area_share", "anisotropy")


@dataclass(frozen=True)
class Ensemble:
    """Asperities of one shape as equally long arrays in SI units; sums need them ``sorted``."""

    shape: str
    height: Floats
    parameters: dict[str, Floats]
    nominal_area: float | None = None
    positions: dict[str, Floats] = field(default_factory=dict)
    attrs: dict[str, float | int | str] = field(default_factory=dict)
    shared_profile: SharedProfile | None = None  # of a shape whose parameters are not plain numbers
    warnings: tuple[str, ...] = ()  # for the user, about the asperities themselves
    axis: tuple[float, float] | None = None  # x and y [m] of the apex of a curved body that presses them

    @classmethod
    def alike(cls, shape: Shape, height: Floats, positions: dict[str, Floats], patch: float) -> "Ensemble":
        """Return placed asperities of one shape at heights [m], on a patch of a side [m]."""
        shared = shape if isinstance(shape, SharedProfile) else None
        given = {} if shared else shape.parameters
        parameters = {name: np.repeat(np.asarray(value)[None], height.size, axis=0) for name, value in given.items()}
        return cls(shape.name, height, parameters, None, positions, {"patch": patch}, shared)

    def sorted(self) -> "Ensemble":
        """Return the asperities from the highest summit to the lowest, equal heights by their parameters."""
        order = np.argsort(-self.height, kind="stable")
        descending = self.height[order]
        if (descending[1:] == descending[:-1]).any():
            columns = [column for values in self.parameters.values() for column in np.atleast_2d(values.T)]
            order = np.lexsort((*columns, -self.height))
        return self.taken(order)

    def taken(self, numbers: NDArray[np.int64]) -> "Ensemble":
        """Return the asperities of these numbers."""

        def pick(columns: dict[str, Floats]) -> dict[str, Floats]:
            return {name: column[numbers] for name, column in columns.items()}

        parameters, positions = pick(self.parameters), pick(self.positions)
        return replace(self, height=self.height[numbers], parameters=parameters, positions=positions)

    @property
    def origin(self) -> Origin:
        """The origin of the asperities, on which the error of the model depends."""
        if self.attrs.get("asperity_model") == "hills":
            return "hills"
        return "summits" if self.attrs.get("of_surface") else "asperities"

    @property
    def goes_on(self) -> bool:
        """Whether the surface continues beyond the patch, however few asperities are on it (``Source.goes_on``)."""
        return bool(self.attrs.get("goes_on", 0))

    @property
    def resolution_error(self) -> float:
        """The relative error of the force that the resolution of a map causes [1]."""
        if self.origin == "hills":
            return float(self.attrs.get("resolution_error", 0.0))
        return min(FORCE_PER_RADIUS * float(self.attrs.get("radius_uncertainty", 0.0)), 1.0)

    @property
    def border_error(self) -> float:
        """The relative error of the force by what the border of their map cuts [1]."""
        return float(self.attrs.get("border_error", 0.0))

    @property
    def anisotropy(self) -> float:
        """Ratio of the r.m.s. slopes of the map of hills across and along its ridges [1]."""
        return float(self.attrs.get("anisotropy", 1.0))

    @property
    def area_share(self) -> float:
        """Area of contacts over that of circles of the same stiffness [1]: below 1 for long ones."""
        return float(self.attrs.get("area_share", 1.0))

    @cached_property
    def spread(self) -> float:
        """Standard deviation of the heights [m]; 0 where all are equal."""
        with np.errstate(all="ignore"):  # where no float holds their squares, JKR is not trusted
            return float(np.std(self.height - self.height[0])) if self.height.size else 0.0

    @cached_property
    def columns(self) -> Columns:
        """Width [m], rise [m] and params [1] of each asperity; of a shared profile one row of params."""
        if self.shared_profile is None:
            with np.errstate(all="ignore"):  # numbers that no float can hold are refused with the contacts
                return Columns(*SHAPES[self.shape].nondimensionalise(self.parameters))
        width, rise, params = self.shared_profile.nondimensional()
        return Columns(np.full_like(self.height, width), np.full_like(self.height, rise), np.asarray(params)[None])

    def validity_limits(self, radius: Floats) -> ValidityLimits:
        """Return the validity limits of contacts with these radii [m], 0 for none."""
        if not (radius > 0.0).any():
            return ValidityLimits()
        if self.shared_profile is not None:
            return ValidityLimits.of(radius, self._slopes(radius), np.array(self.shared_profile.end))
        return ValidityLimits.of(radius, self._slopes(radius), SHAPES[self.shape].ends(self.parameters))

    def relative_loads(self, radius: Floats) -> Floats:
        """Return estimates of the forces of contacts with these radii [m], 0 for none, up to a common factor."""
        loads = relative_loads(radius, self._slopes(radius))
        return loads if loads.any() else radius  # flat punches have flanks without slopes

    def _slopes(self, radius: Floats) -> Floats:
        """Return f' at radii [m]."""
        if self.shared_profile is not None:
            return self.shared_profile.df(radius)
        with np.errstate(all="ignore"):  # a slope that no float can hold is infinite
            return SHAPES[self.shape].slopes(self.columns, radius)

    def labelled(self) -> Labelled:
        """Return the arrays over ``asperity``, with their units."""
        units = SHAPES[self.shape].units
        variables = {"height": Array(("asperity",), self.height, COORDINATES["height"].attrs)}
        shared, along = self.shared_profile, dimensions_of(SHAPES[self.shape])
        for name, column in (self.parameters if shared is None else shared.columns).items():
            meaning = f"{name} of the {self.shape}{'' if shared is None else ', the same for all'}"
            variables[name] = Array(along, column, {"units": units[name], "long_name": meaning})
        for name, column in self.positions.items():
            variables[name] = Array(("asperity",), column, COORDINATES[name].attrs)
        area = {} if self.nominal_area is None else {"nominal_area": self.nominal_area}
        warnings = {"warnings": "\n".join(self.warnings)} if self.warnings else {}
        return Labelled(variables, {}, {"shape": self.shape, **self.attrs, **area, **warnings})

    @classmethod
    def from_dataset(cls, dataset: "xr.Dataset") -> "Ensemble":
        """Return the ensemble of a dataset, in any order; SceneError names what is missing or not allowed."""
        try:
            return _read(dataset).sorted()
        except RoughmdrError as error:
            raise SceneError(f"ensemble: {error}") from None


def _read(dataset: "xr.Dataset") -> Ensemble:
    shape = dataset.attrs.get("shape")
    if not isinstance(shape, str) or shape not in SHAPES:
        raise RoughmdrError(f"attribute shape is {short_repr(shape)}; it must be one of {', '.join(SHAPES)}")
    height = _column(dataset, "height", "m")
    positions = {name: _column(dataset, name, "m") for name in ("x", "y") if name in dataset}
    kind, along, shared_profile = SHAPES[shape], dimensions_of(SHAPES[shape]), None
    given = {name for name in kind.units if name in dataset}
    names = tuple(kind.units) if kind.shared else kind.parameter_set(given)
    parameters = {name: _column(dataset, name, kind.units[name], along) for name in names}
    if issubclass(kind, SharedProfile):
        shared_profile, parameters = kind.from_columns(parameters), {}
    else:
        kind.check(parameters)
    sides = {name: _size(name, dataset.attrs[name]) for name in _SIDES if name in dataset.attrs}
    warnings = dataset.attrs.get("warnings", "")
    if not isinstance(warnings, str):
        raise RoughmdrError(f"attribute warnings is {short_repr(warnings)}; it must be a text")
    area, texts = _nominal_area(dataset.attrs, sides), tuple(warnings.splitlines())
    attrs = {**sides, **_of_map(dataset.attrs)}
    return Ensemble(shape, height, parameters, area, positions, attrs, shared_profile, texts)


def dimensions_of(shape: type[Shape]) -> tuple[str, ...]:
    """Return the dimensions of the parameters of asperities of a shape."""
    if issubclass(shape, SharedProfile):
        return (shape.dimension,)
    return ("asperity", shape.dimension) if issubclass(shape, TabledShape) else ("asperity",)


def _nominal_area(attrs: dict[str, Any], sides: dict[str, float]) -> float | None:
    """Return the nominal area [m2], given or from the sides of the patch."""
    if "nominal_area" in attrs:
        return _size("nominal_area", attrs["nominal_area"])
    if "patch" in sides:
        return _size("patch, squared,", sides["patch"] * sides["patch"])
    if "patch_x" in sides and "patch_y" in sides:
        return _size("patch_x times patch_y", sides["patch_x"] * sides["patch_y"])
    return None


def _of_map(attrs: dict[str, Any]) -> dict[str, float | int | str]:
    """Return the attributes of summits and hills that are there; RoughmdrError where one is not allowed."""
    model = attrs.get("asperity_model", "hills")
    if model != "hills":
        raise RoughmdrError(f"attribute asperity_model is {short_repr(model)}; it must be 'hills' or absent")
    return {name: attrs[name] for name in ("asperity_model",) if name in attrs} | {
        name: check_number(f"attribute {name}", attrs[name], "1", zero=True)
        for name in ("of_surface", "goes_on", "radius_uncertainty", "exclusion_distance", *_OF_HILLS)
        if name in attrs
    }


def _size(name: str, value: Any) -> float:
    """Return a length [m] or an area [m2] of a patch; RoughmdrError unless it is a number above 0."""
    if isinstance(value, str):
        raise RoughmdrError(f"attribute {name} is {short_repr(value)}; it must be a finite number above 0 in SI")
    return check_number(f"attribute {name}", value, "in SI")


def _column(dataset: "xr.Dataset", name: str, unit: str, along: tuple[str, ...] = ("asperity",)) -> Floats:
    if name not in dataset:
        raise RoughmdrError(f"variable {name!r} is missing")
    variable = dataset[name]
    if variable.dims != along:
        raise RoughmdrError(f"{name} lies over {variable.dims}; it must lie over {along}")
    if variable.size == 0:
        empty = next(dimension for dimension in along if variable.sizes[dimension] == 0)
        raise RoughmdrError(f"it has no {empty}; at least one is needed")
    if variable.dtype.kind not in "iuf":
        raise RoughmdrError(f"{name} is of type {variable.dtype}; it must be numbers")
    try:
        factor = float(unit_factor(str(variable.attrs.get("units", "")), unit))
    except RoughmdrError as error:
        raise RoughmdrError(f"units of {name}: {error}") from None
    with np.errstate(over="ignore"):  # refused below
        column = np.asarray(variable.to_numpy(), dtype=np.float64) * factor
    if not np.isfinite(column).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(column))[0])
        place = ", ".join(f"{dimension} {i}" for dimension, i in zip(along, where, strict=True))
        raise RoughmdrError(f"{name} is {column[where]} at {place}; it must be finite")
    return column
