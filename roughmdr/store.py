"""netCDF files: written by one thread, whole or not at all, and read."""

import contextlib
import os
import platform
import tempfile
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.labelled import Labelled
from roughmdr.netcdf import LOCK, load
from roughmdr.result_form import fault_in

_TEMPORARY = ".roughmdr."
_PACKAGES = ("numpy", "numba", "scipy", "dask", "xarray", "netCDF4")


def provenance(title: str, command: str) -> dict[str, str]:
    """The attributes that say what made a file, and with which versions."""
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    source, packages = _made_with()
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "source": source,
        "history": f"{now}: {command}",
        "packages": packages,
    }


@cache
def _made_with() -> tuple[str, str]:
    """The version of the package, and of what it needs: looked up once, which takes as long as a small scene."""
    versions = [f"python {platform.python_version()}", *(f"{name} {version(name)}" for name in _PACKAGES)]
    return f"roughmdr {version('roughmdr')}", ", ".join(versions)


def check_writable(path: Path, inputs: Iterable[Path] = ()) -> None:
    """StoreError where a file cannot be put at ``path``, or would take the place of an input; leaves nothing behind."""
    try:
        if path.is_dir():
            raise StoreError(f"{path}: is a folder; the output must be a file")
        if path.exists() and not path.is_file():
            raise StoreError(f"{path}: is no ordinary file; the output must be one")
        if path.exists() and any(other.exists() and path.samefile(other) for other in inputs):
            raise StoreError(f"{path}: is read from; the output must be another file")
        if not path.parent.is_dir():
            raise StoreError(f"{path}: the folder {path.parent} does not exist")
        if not _utf8(path.parent.absolute()):
            raise StoreError(f"{path.name!r}: the name of its folder is not UTF-8, and netCDF cannot write there")
        descriptor, name = tempfile.mkstemp(prefix=_TEMPORARY, dir=path.parent)
    except OSError as error:
        raise StoreError(f"{path}: cannot be written: {error.strerror}") from None
    os.close(descriptor)
    Path(name).unlink()


def _utf8(path: Path) -> bool:
    return str(path).encode(errors="replace").decode() == str(path)


@contextlib.contextmanager
def cannot_be_written(path: Path) -> Iterator[None]:
    """Whatever the system has against writing within is a StoreError that names ``path``."""
    try:
        yield
    except OSError as error:
        raise StoreError(f"{path}: cannot be written: {error.strerror or error}") from None


@contextlib.contextmanager
def replacing(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """A temporary name to write to, which takes the place of ``path`` when all is written and on disk.

    It is in ``folder``, which must be on the same disk; by default beside ``path``.
    """
    check_writable(path)
    place = folder or path.parent
    with cannot_be_written(path):
        with tempfile.NamedTemporaryFile(prefix=_TEMPORARY, suffix=".tmp", dir=place, delete=False) as made:
            temporary = Path(made.name)
        try:
            yield temporary
            with temporary.open("rb") as written:
                os.fsync(written.fileno())
            temporary.chmod(0o666 & ~_umask())
            temporary.replace(path)
            sync_folder(path.parent)
        finally:
            temporary.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def sync_folder(folder: Path) -> None:
    """Make the new name last through a power cut, on systems that let a folder be opened."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def write(data: Labelled, path: Path, folder: Path | None = None) -> None:
    """Put ``data`` at ``path`` as netCDF-4, atomically, by way of ``folder``; StoreError where that fails."""
    with replacing(path, folder) as temporary:
        try:
            _write_netcdf(data, temporary)
        except RuntimeError as error:  # so netCDF4 says that a disk is full
            raise StoreError(f"{path}: cannot be written: {error}") from None


def _write_netcdf(data: Labelled, path: Path) -> None:
    import netCDF4

    beside = {name: set(array.dims) for name, array in data.coordinates.items() if array.dims != (name,)}
    with LOCK, netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts(data.attrs)
        for dimension, size in data.sizes.items():
            file.createDimension(dimension, size)
        for name, array in (data.coordinates | data.variables).items():
            kind = array.values.dtype.kind
            variable = file.createVariable(
                name,
                str if kind in "OU" else array.values.dtype,
                array.dims,
                fill_value=np.nan if kind == "f" and name in data.variables else None,
            )
            variable.setncatts(array.attrs)
            if name in data.variables and (apt := [other for other, dims in beside.items() if dims <= set(array.dims)]):
                variable.coordinates = " ".join(apt)
            variable[...] = array.values.astype(object) if kind == "U" else array.values


def read(path: Path) -> Labelled:
    """A result file, loaded; StoreError where it is none."""
    try:
        data = load(path)
    except RoughmdrError as error:
        raise StoreError(f"{path}: {error}") from None
    if fault := fault_in(data):
        raise StoreError(f"{path}: not a result as roughmdr writes it: {fault}")
    return data
