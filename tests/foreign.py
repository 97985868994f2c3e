"""Files of the three kinds, changed at random as anyone could change them, and what may be said of them."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
from hypothesis import strategies as st

ODD = "\x1b[31m\x1b]0;t\x07 \x9b2J \x85 \u202e \u2066 \u200b \r \x00 \x7f é"
"""Characters that a terminal acts on, and an innocent letter."""
_HEX = "F" * 5000
_TEXTS = (
    *("", "text", ODD.replace("\x00", ""), "1e-3", "1 mm", "days since 2000-01-01", "m", "N", "x" * 100_000),
    *("[", "[" * 3000, f"a = {'[' * 300}{']' * 300}", f"{'x.' * 3000}y = 1", f"a = 0x{_HEX}"),
    *("batch = 3", "[batch]\nestimator = 3", f"[batch]\nestimator = 0x{_HEX}", "sweep = 5", "[sweep]\na = [1]"),
    *("separation branch", "status force", "force_mean", "jkr", "cone", "tabulated", "power_law", "1"),
)
_NUMBERS = (0, 1, -1, 2, 7, 2**63 - 1, 0.0, 1.0, 0.5, -1.0, 1e-300, 1e300, 1e160, np.nan, np.inf, -np.inf)
_ATTRIBUTE_VALUES: tuple[Any, ...] = (
    *_TEXTS,
    *_NUMBERS,
    np.int8(1),
    np.float32(0.1),
    np.array([1.0, 2.0]),
    np.array([1, 2], dtype=np.int32),
    ["one", ODD.replace("\x00", "")],
)
_ATTRIBUTES = (
    *("title", "source", "history", "scene", "packages", "left_out", "accuracy", "warnings", "versions", "seed"),
    *("patch", "patch_x", "patch_y", "nominal_area", "shape", "periodic", "units", "long_name", "flag_meanings"),
    *("coordinates", "scale_factor", "add_offset", "missing_value", "valid_range", "_Unsigned", "dtype", "calendar"),
)
_NAMES = (
    *("force", "force_mean", "force_sem", "contact_area", "status", "separation", "branch", "realization_count"),
    *("adhesion_law", "tabor_number", "accuracy_method", "accuracy_reached", "cell_key", "remark", "foo"),
    *("height", "radius", "slope", "x", "y", "r", "f", "exponent", "coefficient", "odd\x9b\u202e"),
)
_DIMENSIONS = ("realization", "step", "cell", "asperity", "x", "y", "adhesion_work", "odd\x9b\u202e")
_KINDS = ("f8", "f4", "i8", "i4", "i1", "u8", "S1", "O")


class Variable(NamedTuple):
    """A variable of a netCDF file."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: dict[str, Any]


class Content(NamedTuple):
    """The content of a netCDF file."""

    variables: dict[str, Variable]
    attrs: dict[str, Any]


def content_of(path: Path) -> Content:
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        variables = {
            name: Variable(
                each.dimensions,
                np.asarray(each[...], dtype=object if each.dtype is str else None),
                {attribute: each.getncattr(attribute) for attribute in each.ncattrs()},
            )
            for name, each in file.variables.items()
        }
        return Content(variables, {name: file.getncattr(name) for name in file.ncattrs()})


def write(content: Content, path: Path) -> None:
    """An error of any kind where netCDF has no such thing."""
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(content.attrs)
        for name, (dims, values, attrs) in content.variables.items():
            for dim, size in zip(dims, values.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, size or None)
            fill = attrs.get("_FillValue")
            variable = file.createVariable(
                name, str if values.dtype.kind == "O" else values.dtype, dims, fill_value=fill
            )
            variable.set_auto_maskandscale(False)
            variable[...] = values
            variable.setncatts({name: value for name, value in attrs.items() if name != "_FillValue"})


def _of_kind(values: np.ndarray, kind: str) -> np.ndarray:
    dtype = np.dtype(kind)
    if dtype.kind in "OS":
        return values if dtype == values.dtype else np.full(values.shape, "o", dtype=dtype)
    if values.dtype.kind in "OS":
        return np.zeros(values.shape, dtype=dtype)
    with np.errstate(all="ignore"):
        return values.astype(dtype)


class Change(NamedTuple):
    """One change of a file's content, of one of its variables or of the attributes of the file."""

    make: "Callable[[Change, Content, str], None]"
    pick: int
    """Which variable, attribute, dimension or number, counted round."""
    whole: bool
    """All numbers, not one; the attributes of the file, not of a variable."""
    name: str
    dim: str
    attribute: str
    value: Any
    number: float
    kind: str

    def __call__(self, content: Content) -> None:
        if content.variables:
            self.make(self, content, self.chosen(list(content.variables)))

    def chosen(self, among: Sequence[str]) -> str:
        return among[self.pick % len(among)]


def _attributes(change: Change, content: Content, own: str) -> dict[str, Any]:
    return content.attrs if change.whole else content.variables[own].attrs


def _set_known_attribute(change: Change, content: Content, own: str) -> None:
    _attributes(change, content, own)[change.attribute] = change.value


def _set_own_attribute(change: Change, content: Content, own: str) -> None:
    attrs = _attributes(change, content, own)
    attrs[change.chosen([*attrs, change.attribute])] = change.value


def _drop_attribute(change: Change, content: Content, own: str) -> None:
    attrs = _attributes(change, content, own)
    attrs.pop(change.chosen([*attrs, change.attribute]), None)


def _set_values(change: Change, content: Content, own: str) -> None:
    dims, values, attrs = content.variables[own]
    new = values.astype(float if values.dtype.kind in "iuf" else object)
    if values.size:
        new.flat[slice(None) if change.whole else change.pick % values.size] = (
            change.number if values.dtype.kind in "iuf" else str(change.value)[:50].replace("\x00", "")
        )
    content.variables[own] = Variable(dims, _of_kind(new, values.dtype.str), attrs)


def _set_kind(change: Change, content: Content, own: str) -> None:
    dims, values, attrs = content.variables[own]
    kept = {name: value for name, value in attrs.items() if name != "_FillValue"}
    content.variables[own] = Variable(dims, _of_kind(values, change.kind), kept)


def _rename(change: Change, content: Content, own: str) -> None:
    content.variables[change.name] = content.variables.pop(own)


def _drop(change: Change, content: Content, own: str) -> None:
    del content.variables[own]


def _drop_dimension(change: Change, content: Content, own: str) -> None:
    dims, values, attrs = content.variables[own]
    if dims and len(values):
        content.variables[own] = Variable(dims[1:], values[0:1].reshape(values.shape[1:]), attrs)


def _turn(change: Change, content: Content, own: str) -> None:
    dims, values, attrs = content.variables[own]
    content.variables[own] = Variable(dims[::-1], values.T, attrs)


def _add_dimension(change: Change, content: Content, own: str) -> None:
    dims, values, attrs = content.variables[own]
    content.variables[own] = Variable((change.dim, *dims), values[None], attrs)


def _rename_dimension(change: Change, content: Content, own: str) -> None:
    old = change.chosen([*content.variables[own].dims, change.dim])
    for name, variable in content.variables.items():
        dims = tuple(change.dim if dim == old else dim for dim in variable.dims)
        content.variables[name] = variable._replace(dims=dims)


def _add(change: Change, content: Content, own: str) -> None:
    dims, values, _ = content.variables[own]
    like = (dims, _of_kind(values, change.kind)) if change.whole else ((), np.array(1.0))
    content.variables[change.name] = Variable(*like, {"units": change.value})


_CHANGES = (
    *(_set_known_attribute, _set_own_attribute, _drop_attribute, _set_values, _set_kind, _rename, _drop),
    *(_drop_dimension, _turn, _add_dimension, _rename_dimension, _add),
)
CHANGES = st.builds(
    Change,
    make=st.sampled_from(_CHANGES),
    pick=st.integers(0, 99),
    whole=st.booleans(),
    name=st.sampled_from(_NAMES),
    dim=st.sampled_from(_DIMENSIONS),
    attribute=st.sampled_from(_ATTRIBUTES),
    value=st.sampled_from(_ATTRIBUTE_VALUES),
    number=st.sampled_from(_NUMBERS),
    kind=st.sampled_from(_KINDS),
)


def control_characters(said: str) -> set[str]:
    """Return the characters that a terminal would act on."""
    return {letter for letter in said if not (letter.isprintable() or letter in "\n\t")}


def undefined(said: str) -> list[str]:
    """Return nan and inf where a text has them as numbers."""
    return re.findall(r"(?<![\w'])[-+]?(?:nan|inf)\b(?!')", said)
