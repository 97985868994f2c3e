"""Claims of the processes that fill one folder of parts together: each run is computed by the one that claims it.

A claim is a lock on bytes of a file, one byte for each run: the system releases it when its process ends, however that
ends. On a disk without locks nobody is kept out: there only parts of a batch may be computed beside each other.
"""

import errno
import os
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from zlib import crc32

from roughmdr.batch.resume.manifest import Manifest, Runs, runs_of
from roughmdr.storage.files import convert_os_errors

_NO_LOCKS = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)
"""Error numbers of disks without locks, such as some that a cluster shares."""
CLAIMS = "claims"
_RUNS = 2**32  # number of bytes that a cell has in the file, more than realisations that a scene may ask for
_CELLS = 2**29  # number of places for cells, by a hash of their keys: two cells in one place wait for each other
_APPENDING, _FINISHING = _CELLS * _RUNS, _CELLS * _RUNS + 1  # bytes of who appends to the manifest, and of who ends


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
