"""Inputs must be regular files or open pipes; an output appears whole or not at all, and nothing is left behind."""

import ctypes
import os
import shutil
import stat
import tempfile
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.storage.labelled import is_text

NETCDF_ENDINGS = (".nc", ".nc4", ".cdf", ".netcdf")
ZARR_ENDING = ".zarr"
_THIS_FOLDER, _EXCHANGE = -100, 2  # AT_FDCWD and RENAME_EXCHANGE of Linux (renameat2(2))
_UMASK_LOCK = threading.Lock()
_TEMPORARY_PREFIX = ".roughmdr."


def check_regular_file(path: Path) -> None:
    """Raise RoughmdrError, with the kind of file, unless ``path`` is a regular file or a link to one."""
    mode = _mode(path)
    if stat.S_ISDIR(mode):
        raise RoughmdrError("is a folder; expected a file")
    if not stat.S_ISREG(mode):
        raise RoughmdrError("is not a regular file; expected one")


def is_open_pipe(path: Path) -> bool:
    """Return whether ``path`` is a pipe that this process was given, such as /dev/stdin or /dev/fd/63.

    A named pipe does not count: opening it may block for ever. RoughmdrError if nothing is there.
    """
    if not stat.S_ISFIFO(_mode(path)):
        return False
    target = Path(os.path.realpath(path))
    return not target.exists() or target.parent == Path("/dev/fd")


def _mode(path: Path) -> int:
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        raise RoughmdrError("no such file") from None
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None
    except ValueError as error:  # no file can have such a name
        raise RoughmdrError(f"cannot be read: {error}") from None


def destination(path: Path) -> Path:
    """Return the file that writing to ``path`` replaces: for a link its final target, even if that does not exist yet.

    Everything that belongs to an output is kept beside the destination, so that it is found with and without the link.
    StoreError if links form a circle.
    """
    with convert_os_errors(path):
        if not path.is_symlink():
            return path
        target = Path(os.path.realpath(path))
        if target.is_symlink():
            raise StoreError(f"{path}: is a link in a circle of links, which leads to no file")
        return target


def check_writable(path: Path, inputs: Iterable[Path] = (), *, as_zarr: bool = False) -> None:
    """Raise StoreError if no file, or Zarr store, can be put at ``path``, or if it would replace one of the inputs."""
    target = destination(path)
    label = f"{path}" if target == path else f"{path} (a link to {target})"
    try:
        if as_zarr:
            if target.exists() and not is_zarr(target):
                raise StoreError(f"{label}: is no Zarr store; the output must be one, or not be there")
            if target.exists() and (others := _others_in(target)):
                raise StoreError(f"{label}: holds {others[0]}, which is no part of it and would be lost")
        elif target.is_dir():
            raise StoreError(f"{label}: is a folder; the output must be a file")
        elif target.exists() and not target.is_file():
            raise StoreError(f"{label}: is not a regular file; the output must be one")
        if target.exists() and any(other.exists() and target.samefile(other) for other in inputs):
            raise StoreError(f"{label}: is an input; the output must be another file")
        if not target.parent.is_dir():
            raise StoreError(f"{label}: the folder {target.parent} does not exist")
        if is_zarr(target.parent):
            raise StoreError(f"{label}: {target.parent} is a Zarr store; the output must be outside of it")
        if not (is_text(str(path.absolute())) and is_text(str(target.absolute()))):
            raise StoreError(f"{str(path)!r}: the name is not UTF-8, and netCDF could not read it again; give another")
        tempfile.TemporaryFile(dir=target.parent).close()  # without a name where it can, so that a kill leaves none
    except OSError as error:
        raise StoreError(f"{label}: cannot be written: {error.strerror}") from None


def is_zarr(path: Path) -> bool:
    """Return whether ``path`` is the folder of a Zarr store, of format 3, or of format 2, which others write."""
    return any(os.path.isfile(path / name) for name in ("zarr.json", ".zgroup"))


def _others_in(store: Path) -> list[str]:
    """Return the names of what lies in the folder of a Zarr store beside its arrays and what the format keeps there."""
    arrays = {each.name for each in store.iterdir() if (each / "zarr.json").is_file() or (each / ".zarray").is_file()}
    return sorted({each.name for each in store.iterdir() if each.name != "zarr.json" and each.name[0] != "."} - arrays)


def size_of(path: Path) -> int:
    """Return the size [byte] of a file, or of all files of a Zarr store."""
    files = path.rglob("*") if path.is_dir() else [path]
    return sum(each.stat().st_size for each in files if each.is_file())


def check_ending(path: Path, kind: str, endings: Sequence[str]) -> str:
    """Return the ending of the name of an output of this kind, in lower case; StoreError unless it is one of these."""
    ending = path.suffix.lower()
    if ending not in endings:
        allowed = ", ".join(endings[:-1]) + " or " * (len(endings) > 1) + endings[-1]
        raise StoreError(f"{path}: the name of a {kind} must end in {allowed}")
    return ending


@contextmanager
def convert_os_errors(path: Path) -> Iterator[None]:
    """Convert an OSError raised inside to a StoreError that names ``path``."""
    try:
        yield
    except OSError as error:
        raise StoreError(f"{path}: cannot be written: {error.strerror or error}") from None


@contextmanager
def replace_atomically(
    path: Path, folder: Path | None = None, *, as_zarr: bool = False, begun: Path | None = None
) -> Iterator[Path]:
    """Yield a temporary file to write to; it replaces ``path`` once everything is written and on disk.

    The temporary file is in ``folder``, which must be on the same disk; by default beside ``path``. If ``path`` is a
    link, its target is replaced. A Zarr store is a folder, which may have ``begun``. Where the system cannot exchange
    two names, nothing is at ``path`` for a moment while a store is replaced; the old one is ``before_of`` it.
    """
    check_writable(path, as_zarr=as_zarr)
    path = destination(path)
    with convert_os_errors(path):
        if as_zarr:
            temporary = begun or Path(tempfile.mkdtemp(".tmp", _TEMPORARY_PREFIX, folder or path.parent))
        else:
            descriptor, name = tempfile.mkstemp(".tmp", _TEMPORARY_PREFIX, folder or path.parent)
            os.close(descriptor)
            temporary = Path(name)
        try:
            yield temporary
            for each in (*temporary.rglob("*"), temporary) if as_zarr else (temporary,):
                descriptor = os.open(each, os.O_RDONLY)
                try:
                    os.fsync(descriptor)
                finally:
                    os.close(descriptor)
            temporary.chmod((0o777 if as_zarr else 0o666) & ~_umask())
            if not as_zarr:
                temporary.replace(path)
            elif not (path.exists() and _exchange(temporary, path)):
                _replace_in_steps(temporary, path)
            sync_folder(path.parent)
        finally:
            if as_zarr:
                shutil.rmtree(temporary, ignore_errors=True)
            else:
                temporary.unlink(missing_ok=True)


def before_of(path: Path) -> Path:
    """Return where the Zarr store at ``path`` stands while another takes its place."""
    return path.with_name(f"{_TEMPORARY_PREFIX}{path.name}.before")


def _replace_in_steps(new: Path, path: Path) -> None:
    old = before_of(path)
    if path.exists():
        shutil.rmtree(old, ignore_errors=True)
        path.rename(old)
    try:
        new.rename(path)
    except BaseException:
        if old.exists():
            old.rename(path)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _exchange(one: Path, other: Path) -> bool:
    """Exchange two names in one step; return whether the system could."""
    try:
        rename = ctypes.CDLL(None).renameat2
    except (AttributeError, OSError, TypeError):  # another system than Linux, or an old one
        return False
    return bool(rename(_THIS_FOLDER, os.fsencode(one), _THIS_FOLDER, os.fsencode(other), _EXCHANGE) == 0)


def _umask() -> int:
    """Return the mask of new files; it can only be read by setting it, for the whole process."""
    with _UMASK_LOCK:
        mask = os.umask(0)
        os.umask(mask)
    return mask


def sync_folder(folder: Path) -> None:
    """Write a folder's entries to disk, so that a new name survives a power cut; no effect if it cannot be opened."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
