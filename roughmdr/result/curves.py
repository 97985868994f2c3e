"""The curves of a result as arrays of xarray, which may be in chunks, and those that follow from others."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Ints
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import short_repr, suggestion
from roughmdr.variables import BRANCHES, CURVE_VARIABLES, LAW_VARIABLES, OVER_AREA, STEP_COORDINATES

if TYPE_CHECKING:
    import xarray as xr

PER_AREA = {
    f"{of}{OVER_AREA[total]}": f"{of}{total}" for of in ("", "reference_") for total in ("force", "contact_area")
}
"""Curves that follow from others and the nominal area."""
_NEEDED = "ds.roughmdr needs a result as roughmdr.run or load_separation returns it"


def is_ensemble(dataset: "xr.Dataset") -> bool:
    """Return whether a dataset holds asperities, as ``roughmdr.generate`` returns them."""
    return "asperity" in dataset.dims and "height" in dataset and "shape" in dataset.attrs


def is_result(dataset: "xr.Dataset") -> bool:
    """Return whether a dataset holds curves over the steps of a path."""
    controlled = any(name in dataset.coords and "step" in dataset[name].dims for name in STEP_COORDINATES)
    return "branch" in dataset.coords and controlled and bool(stored_curves(ResultView(dataset)))


def result_of(dataset: "xr.Dataset") -> ResultView:
    """Return a dataset as a result; StoreError if it is none."""
    if is_ensemble(dataset):
        raise StoreError(f"{_NEEDED}; this is an ensemble of asperities")
    if not is_result(dataset):
        names = short_repr(sorted(map(str, dataset.variables)))
        expected = "curves over step, such as force, with the coordinates branch and separation (or another control)"
        raise StoreError(f"{_NEEDED}, with {expected}; this dataset has the variables {names}")
    return ResultView(dataset)


def stored_curves(result: ResultView) -> list[str]:
    """Return the variables with a curve, or a mean curve, over the steps; those of references included."""
    suffix = "_mean" if result.keeps_statistics else ""
    names = (f"{name}{suffix}" for name in LAW_VARIABLES)
    return [name for name in names if name in result.variables and "step" in result.variables[name].dims]


def curve(result: ResultView, name: str, asked: str = "ds.roughmdr needs") -> "xr.DataArray":
    """Return a variable over the steps, or its mean, computed from another where the result does not hold it.

    StoreError where it holds neither; ``asked`` are the words before the name in its message, such as "x is".
    """
    dataset = result.dataset
    if held := _held(dataset, name):
        array = dataset[held]  # without coordinates over the steps, as one may have the name of a new dimension
        return array.drop_vars([each for each, coordinate in array.coords.items() if "step" in coordinate.dims])
    if name in PER_AREA and "nominal_area" in dataset:
        total = curve(result, PER_AREA[name], asked)
        return (total / dataset["nominal_area"]).assign_attrs(LAW_VARIABLES[name].attrs)
    if name == "force" and _held(dataset, "pressure") and "nominal_area" in dataset:
        total = curve(result, "pressure", asked) * dataset["nominal_area"]
        return total.assign_attrs(CURVE_VARIABLES[name].attrs)
    held_names = [each.removesuffix("_mean") for each in stored_curves(result)]
    allowed = list(dict.fromkeys([*held_names, result.control]))
    if name in PER_AREA and "nominal_area" not in dataset and _held(dataset, PER_AREA[name]):
        raise StoreError(
            f"{asked} {name!r}: from {PER_AREA[name]} only with nominal_area, which this result does not hold"
        )
    if name in LAW_VARIABLES:
        raise StoreError(f"{asked} {name!r}, which this result does not hold; it holds {', '.join(allowed)}")
    raise StoreError(f"{asked} {short_repr(name)}, no variable of a result{suggestion(str(name), allowed)}")


def apply(
    function: Callable[..., Any],
    *arrays: "xr.DataArray",
    core: Sequence[Sequence[str]],
    out: Sequence[Sequence[str]],
    **keywords: object,
) -> "tuple[xr.DataArray, ...]":
    """Return what a function of numbers gives of arrays, lazily where these are in chunks; all of one type.

    ``core`` are the last dimensions of each array that it takes, and ``out`` of each that it returns.
    """
    import xarray as xr

    whole = (
        array if array.chunks is None else array.chunk(dict.fromkeys(dims, -1))
        for array, dims in zip(arrays, core, strict=True)
    )
    found = xr.apply_ufunc(
        function,
        *whole,
        kwargs=keywords,
        input_core_dims=core,
        output_core_dims=out,
        keep_attrs=False,
        dask="parallelized",
        output_dtypes=[arrays[0].dtype] * len(out),
    )
    return found if len(out) > 1 else (found,)


class Read(NamedTuple):
    """A curve where it is read."""

    label: str
    value: "xr.DataArray"
    rise: "xr.DataArray"
    """Change between the steps around."""


class Branch:
    """The steps of a result on one branch, and the legs that they are on."""

    def __init__(self, result: ResultView, branch: str) -> None:
        """Take the steps of a branch; StoreError where that is none, or the path has none of it."""
        if branch not in BRANCHES:
            raise StoreError(f"branch is {branch!r}; it must be {' or '.join(map(repr, BRANCHES))}")
        self.wanted: NDArray[np.bool_] = result.branches == branch
        """Whether each step is on the branch."""
        self.start: Ints = np.concatenate([np.full_like(leg.steps, max(leg.steps[0] - 1, 0)) for leg in result.legs])
        """The step at which the leg of each step begins: the last before the turning point."""
        if not self.wanted.any():
            raise StoreError(f"branch is {branch!r}; the path of this result has no {branch}")


def _held(dataset: "xr.Dataset", name: str) -> str:
    """Return the name under which a dataset holds a curve or its mean; empty where it holds neither."""
    held = (each for each in (name, f"{name}_mean") if each in dataset.variables and "step" in dataset[each].dims)
    return next(held, "")
