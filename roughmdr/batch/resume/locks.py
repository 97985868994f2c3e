"""Locks of a folder of parts, which the system releases when their process ends, however that ends.

A process holds the folder alone, or shares it with others that compute the same batch. Then each run is computed by the
one that claims it, by a lock on bytes of a file, one byte for each run. On a disk without locks nobody is kept out:
there only parts of a batch may be computed beside each other.
"""

import errno
import os
import platform
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from zlib import crc32

from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.manifest import Manifest, Runs, runs_of
from roughmdr.errors import StoreError
from roughmdr.storage.files import convert_os_errors

_NO_LOCKS = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)
"""Error numbers of disks without locks, such as some that a cluster shares."""
CLAIMS = "claims"
_RUNS = 2**32  # number of bytes that a cell has in the file, more than realisations that a scene may ask for
_CELLS = 2**29  # number of places for cells, by a hash of their keys: two cells in one place wait for each other
_APPENDING, _FINISHING = _CELLS * _RUNS, _CELLS * _RUNS + 1  # bytes of who appends to the manifest, and of who ends
LOCK = "lock"
_BEGINNING = 60.0  # longest time [s] to wait for another run to say which batch it computes
_BETWEEN_TRIES = 0.05  # time [s] between two tries
_held_here: set[tuple[int, int]] = set()  # device and inode of the locks of this process, which shares none with itself


class Claims:
    """Claims of this process in a folder, until they are given up."""

    def __init__(self, folder: Path) -> None:
        self._file = os.open(folder / CLAIMS, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        self._folder, self._guard = folder, threading.Lock()
        self._manifest, self._done = Manifest(folder), dict[str, list[Runs]]()

    def look(self) -> None:
        """Read which runs have been stored, or have failed, since the last look."""
        with convert_os_errors(self._folder):
            for line in self._manifest.new_lines():
                for runs in runs_of(line):
                    self._done.setdefault(runs.key, []).append(runs)

    def are_done(self, ranges: Iterable[Runs]) -> bool:
        """Return whether any of the runs was stored, or had failed, at the last look."""
        return any(
            max(runs.first, done.first) < min(runs.last, done.last)
            for runs in ranges
            for done in self._done.get(runs.key, ())
        )

    def take(self, ranges: Iterable[Runs]) -> bool:
        """Claim runs, all or none; return whether they are this process's to compute, and not done already."""
        with self._guard, convert_os_errors(self._folder):
            taken = list[Runs]()
            for runs in ranges:
                if not self._lock(_place(runs), runs.last - runs.first):
                    break
                taken.append(runs)
            else:
                self.look()  # after the locks: who held them may have done the runs, and ended
                if not (self._manifest.ended or self.are_done(taken)):
                    return True
            for runs in taken:
                self._unlock(_place(runs), runs.last - runs.first)
            return False

    def finish(self) -> bool:
        """Claim to write the result; return whether no other process is about to."""
        return self._lock(_FINISHING)

    @contextmanager
    def appending(self) -> Iterator[None]:
        """Wait until no other process appends to the manifest, and keep others from it."""
        self._lock(_APPENDING, wait=True)
        try:
            yield
        finally:
            self._unlock(_APPENDING)

    def close(self) -> None:
        """Give up all claims."""
        os.close(self._file)

    def _lock(self, place: int, count: int = 1, *, wait: bool = False) -> bool:
        import fcntl

        return try_lock(fcntl.lockf, self._file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB), count, place)

    def _unlock(self, place: int, count: int = 1) -> None:
        import fcntl

        with suppress(OSError):
            fcntl.lockf(self._file, fcntl.LOCK_UN, count, place)


def try_lock(lock: Callable[..., None], *arguments: int) -> bool:
    """Call a function that locks a file; return whether the file is locked: always, on disks without locks."""
    try:
        lock(*arguments)
    except (BlockingIOError, PermissionError):
        return False
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
    return True


def _place(runs: Runs) -> int:
    """Return the byte of the first of the runs."""
    return crc32(runs.key.encode()) % _CELLS * _RUNS + runs.first


_opened: dict[Path, Claims] = {}
_guard = threading.Lock()


def claims_in(folder: Path) -> Claims:
    """Return the claims of this process in a folder, by its whole path: to open their file twice would lose them."""
    with _guard:
        if folder not in _opened:
            with convert_os_errors(folder):
                _opened[folder] = Claims(folder)
        return _opened[folder]


def give_up(folder: Path) -> None:
    """Give up all claims of this process in a folder."""
    with _guard:
        claims = _opened.pop(folder, None)
    if claims is not None:
        claims.close()


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
