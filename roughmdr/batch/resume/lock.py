"""The lock of a folder of parts: a process holds it alone, or shares it with others that compute the same batch."""

import os
import platform
import time
from contextlib import suppress
from pathlib import Path

from roughmdr.batch.resume.claims import try_lock
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.manifest import Manifest
from roughmdr.errors import StoreError

LOCK = "lock"
_BEGINNING = 60.0  # longest time [s] to wait for another run to say which batch it computes
_BETWEEN_TRIES = 0.05  # time [s] between two tries
_held_here: set[tuple[int, int]] = set()  # device and inode of the locks of this process, which shares none with itself


class FolderLock:
    """The lock, which the system releases when its process ends; ``alone`` where no other process held it."""

    def __init__(self, file: int, *, alone: bool) -> None:
        self._file, self.alone = file, alone
        _held_here.add(_identity(file))
        with suppress(OSError):  # the disk may be full; the holder is named only to be helpful
            if alone:
                os.truncate(file, 0)
            os.lseek(file, 0, os.SEEK_END)
            os.write(file, f"process {os.getpid()} on {platform.node()}\n".encode())

    def share(self) -> None:
        """Let others in that compute the same batch."""
        _flock(self._file, shared=True, wait=True)

    def is_last(self) -> bool:
        """Return whether no other process holds it, and keep others out then."""
        return _flock(self._file)

    def release(self) -> None:
        """Release it."""
        _held_here.discard(_identity(self._file))
        os.close(self._file)

    def forget(self) -> None:
        """Note that no run is at work any more, for those too who do not see the lock."""
        with suppress(OSError):
            os.ftruncate(self._file, 0)


def acquire_lock(folder: Path, target: Path, joins: str) -> FolderLock:
    """Lock a folder, made if need be, with no other process but those that compute the scene ``joins``, as TOML, in
    these versions; else StoreError.
    """
    deadline, asked = time.monotonic() + _BEGINNING, (joins, versions())
    while True:
        folder.mkdir(exist_ok=True)
        try:
            file = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        except FileNotFoundError:  # its last holder has just removed the folder
            continue
        try:
            alone = _flock(file)
            may_join = not alone and joins != "" and _identity(file) not in _held_here
            shared = may_join and _flock(file, shared=True)
            begun = _batch_in(folder) if may_join else None
            if alone or (shared and begun == asked):
                with suppress(FileNotFoundError):
                    if os.path.samestat(os.fstat(file), os.stat(folder / LOCK)):
                        return FolderLock(os.dup(file), alone=alone)
            elif not may_join or begun not in (None, asked) or time.monotonic() > deadline:
                holder = os.read(file, 200).decode(errors="replace").partition("\n")[0].strip()
                raise StoreError(f"{target}: another run is writing it{holder and f' ({holder})'}")
            else:
                time.sleep(_BETWEEN_TRIES)
        finally:
            os.close(file)


def _batch_in(folder: Path) -> tuple[str, str] | None:
    """Return scene and versions of the batch that a folder is for; None where nothing is told yet."""
    manifest = Manifest(folder)
    manifest.new_files()
    return (manifest.scene, manifest.versions) if manifest.scene else None


def _identity(file: int) -> tuple[int, int]:
    status = os.fstat(file)
    return status.st_dev, status.st_ino


def _flock(file: int, *, shared: bool = False, wait: bool = False) -> bool:
    """Lock an open file, or change how it is locked; return whether it is."""
    import fcntl

    return try_lock(fcntl.flock, file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | (0 if wait else fcntl.LOCK_NB))
