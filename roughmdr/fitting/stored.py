"""Reading the file of a fit, which anyone may have changed."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_reading import read_netcdf
from roughmdr.storage.result_file import FIT, is_fit

if TYPE_CHECKING:
    import xarray as xr

_TEXTS = ("title", "scene", "trust", "history")
_ENDS = ("", "_standard_error", "_low", "_high")


def read_fit(path: Path) -> Labelled:
    """Return the file of a fit; StoreError if it is none, or not as ``fit`` writes it."""
    try:
        data = read_netcdf(path)
    except RoughmdrError as error:
        raise StoreError(f"{path}: {error}") from None
    if data.attrs.get("kind") != FIT:
        raise StoreError(f"{path}: holds no fit")
    if fault := fit_fault(data):
        raise StoreError(f"{path}: not a fit as roughmdr writes it: {fault}")
    return data


def given_fit(fit: "str | Path | xr.Dataset") -> Labelled | None:
    """Return a fit that is given by its file or as a Dataset; None where it is none, StoreError where it is broken."""
    if isinstance(fit, str | os.PathLike):
        return read_fit(Path(fit)) if is_fit(Path(fit)) else None
    if getattr(fit, "attrs", {}).get("kind") != FIT:
        return None
    data = Labelled.of(fit)
    if fault := fit_fault(data):
        raise StoreError(f"fit: not as roughmdr.fit returns it: {fault}")
    return data


def fit_fault(data: Labelled) -> str:
    """Return why arrays are no fit as ``fit`` writes it; empty if they are one."""
    for name, dims in _expected(data):
        array = (data.variables | data.coordinates).get(name)
        text = name in ("branch", "parameter_name")
        if array is None or array.dims != dims or (array.values.dtype.kind in "OU") != text:
            return f"{name} is missing or of another kind"
    missing = [name for name in _TEXTS if not isinstance(data.attrs.get(name), str)]
    return f"it has no {', '.join(missing)}" if missing else ""


def _expected(data: Labelled) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the arrays of a fit with their dimensions."""
    load = "pressure" if "pressure_fitted" in data.variables else "force"
    control = "remote" if "remote" in data.coordinates else "separation"
    yield from ((name, ("point",)) for name in (control, "branch", load, f"{load}_fitted", "residual"))
    yield from ((name, ("parameter",)) for name in ("parameter_name", "parameter_scale"))
    yield from ((name, ()) for name in ("residual_rms", "evaluation_count", "run_time"))
    names = data.coordinates["parameter_name"].values.ravel() if "parameter_name" in data.coordinates else ()
    for name in (str(each).replace(".", "_") for each in names):
        yield from ((f"{name}{end}", ()) for end in _ENDS)
