"""Result files: their provenance, reading them, and the check that an output is replaced only by its own kind."""

import platform
from collections.abc import Iterable, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.storage.files import check_ending, check_writable
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.reading import read_arrays, read_attribute, read_dimensions
from roughmdr.storage.result_validation import as_result

FIT = "fit"
"""The attribute ``kind`` of the result of a fit."""
EXPORT_MARK = "exported by roughmdr"
"""Words in the first lines of every exported file."""
_PACKAGES = ("numpy", "numba", "scipy", "dask", "xarray", "netCDF4")
_MAGIC_BYTES = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-"}
_ROOTS = {"svg": b"<svg", "html": b"<!doctype html", "export": EXPORT_MARK.encode()}
_HEAD = 4096  # bytes, within which a text has its root element


def provenance(title: str, command: str) -> dict[str, str]:
    """Return the attributes that name the command and the versions that made a file."""
    history = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}: {command}"
    source, packages = _versions()
    return {"Conventions": "CF-1.11", "title": title, "source": source, "history": history, "packages": packages}


@cache
def _versions() -> tuple[str, str]:
    """Return the version of roughmdr and those of its dependencies; the look-up takes as long as a small scene."""
    versions = [f"python {platform.python_version()}", *(f"{name} {version(name)}" for name in _PACKAGES)]
    return f"roughmdr {version('roughmdr')}", ", ".join(versions)


def read_result(path: Path) -> Labelled:
    """Return a result file, loaded; StoreError if it is none."""
    try:
        data = read_arrays(path)
    except RoughmdrError as error:
        raise StoreError(f"{path}: {error}") from None
    if data.attrs.get("kind") == FIT:
        raise StoreError(f"{path}: holds a fit, no result; info, plot, report, cite show it, run computes its scene")
    return as_result(data, path)


def is_fit(path: Path) -> bool:
    """Return whether a file holds a fit."""
    with suppress(RoughmdrError):
        return read_attribute(path, "kind") == FIT
    return False


def check_nothing_lost(path: Path, ensemble: Labelled) -> None:
    """Raise StoreError if there are other asperities at ``path`` than those of ``ensemble``, bit for bit."""
    if not path.exists():
        return
    old = read_arrays(path)
    before, after = (file.variables | file.coordinates for file in (old, ensemble))
    alike = old.attrs.get("shape") == ensemble.attrs["shape"] and before.keys() == after.keys()
    if not (alike and all(np.array_equal(array.values, after[name].values) for name, array in before.items())):
        raise StoreError(f"{path}: holds other asperities already: give another output, or --fresh to replace them")


def check_output(
    path: Path, name: str, endings: Sequence[str], inputs: Iterable[Path | None] = (), *, kind: str = "", fresh: bool
) -> None:
    """Raise StoreError unless an output, such as a "picture", can be written to ``path``: with one of these endings.

    It may replace none of the inputs and, unless it is to be ``fresh``, no file that is no ``kind``: png, pdf, svg,
    html, export, ensemble or fit; by default that of its ending.
    """
    check_writable(path, filter(None, inputs))
    ending = check_ending(path, name, endings)
    if fresh or not path.exists():
        return
    kind, same = kind or ending.removeprefix("."), False
    if kind == "ensemble":
        with suppress(RoughmdrError):
            same = read_dimensions(path).get("height") == ("asperity",)
    elif kind == FIT:
        same = is_fit(path)
    else:
        try:
            with path.open("rb") as file:
                head = file.read(_HEAD)
        except OSError as error:
            raise StoreError(f"{path}: cannot be read: {error.strerror}") from None
        same = _ROOTS[kind] in head if kind in _ROOTS else head.startswith(_MAGIC_BYTES[kind])
    if not same:
        raise StoreError(f"{path}: exists already and is no {kind}: give another output, or --fresh to replace it")
