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

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf import load
from roughmdr.storage.netcdf_writing import write_arrays
from roughmdr.storage.result_form import fault_in

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


def destination(path: Path) -> Path:
    """Where a file written to ``path`` ends up: for a link, what it leads to in the end, though nothing be there yet.

    All that belongs to an output stands beside that place, so that it is found by way of the link and without it.
    StoreError where links lead in a circle.
    """
    with cannot_be_written(path):
        if not path.is_symlink():
            return path
        real = Path(os.path.realpath(path))
        if real.is_symlink():
            raise StoreError(f"{path}: is a link that leads to no file, but round in a circle")
        return real


def check_writable(path: Path, inputs: Iterable[Path] = ()) -> None:
    """StoreError where a file cannot be put at ``path``, or would take the place of an input; leaves nothing behind."""
    real = destination(path)
    said = f"{path}" if real == path else f"{path} (a link to {real})"
    try:
        if real.is_dir():
            raise StoreError(f"{said}: is a folder; the output must be a file")
        if real.exists() and not real.is_file():
            raise StoreError(f"{said}: is no ordinary file; the output must be one")
        if real.exists() and any(other.exists() and real.samefile(other) for other in inputs):
            raise StoreError(f"{said}: is read from; the output must be another file")
        if not real.parent.is_dir():
            raise StoreError(f"{said}: the folder {real.parent} does not exist")
        if not _utf8(path.absolute()) or not _utf8(real.absolute()):
            raise StoreError(
                f"{str(path)!r}: is no name in UTF-8, and netCDF could not read it again; give another one"
            )
        descriptor, name = tempfile.mkstemp(prefix=_TEMPORARY, dir=real.parent)
    except OSError as error:
        raise StoreError(f"{said}: cannot be written: {error.strerror}") from None
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

    It is in ``folder``, which must be on the same disk; by default beside ``path``. A link stays one: what it leads to
    is replaced.
    """
    check_writable(path)
    path = destination(path)
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
            write_arrays(data, temporary)
        except RuntimeError as error:  # of the library
            raise StoreError(f"{path}: cannot be written: {error}") from None


def read(path: Path) -> Labelled:
    """A result file, loaded; StoreError where it is none."""
    try:
        data = load(path)
    except RoughmdrError as error:
        raise StoreError(f"{path}: {error}") from None
    if fault := fault_in(data):
        raise StoreError(f"{path}: not a result as roughmdr writes it: {fault}")
    return data
