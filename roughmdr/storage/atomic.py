"""Atomic replacement of files: an output appears whole or not at all, and nothing is left behind."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from roughmdr.storage.file_checks import TEMPORARY_PREFIX, check_writable, convert_os_errors, destination


@contextlib.contextmanager
def replace_atomically(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """Yield a temporary file to write to; it replaces ``path`` once everything is written and on disk.

    The temporary file is in ``folder``, which must be on the same disk; by default beside ``path``. If ``path`` is a
    link, its target is replaced.
    """
    check_writable(path)
    path = destination(path)
    with convert_os_errors(path):
        with tempfile.NamedTemporaryFile(
            prefix=TEMPORARY_PREFIX, suffix=".tmp", dir=folder or path.parent, delete=False
        ) as created:
            temporary = Path(created.name)
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
    """Write a folder's entries to disk, so that a new name survives a power cut; no effect if it cannot be opened."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
