"""A lock that is a file with the name of its holder; the system releases it when the process dies."""

import errno
import os
import platform
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from roughmdr.errors import StoreError

_NO_LOCKS = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)
"""Errors of disks without locks, such as some that a cluster shares: there nobody is kept out."""
_FLAGS = os.O_NOFOLLOW | os.O_NONBLOCK
"""Flags to open a lock with: no link to another place is followed, and no pipe is waited for."""
_ATTEMPTS, _PAUSE = 10, 0.02  # attempts to get a lock, which ``holder_of`` takes for a moment; pause between them [s]
_HOLDER = re.compile(r"process (\d+) on (.*)")


class Holder(NamedTuple):
    """The process that holds a lock."""

    process: int
    host: str
    since: str  # ISO 8601, UTC


@contextmanager
def locked(path: Path, target: Path) -> Iterator[bool]:
    """Hold the lock at ``path``, which is removed at the end; yield whether the disk has locks.

    StoreError, which names the ``target`` and the holder, where another process holds it.
    """
    lock, has_locks = _acquired(path, target)
    try:
        with suppress(OSError):  # the disk may be full; the holder is named only to be helpful
            os.truncate(lock, 0)
            os.write(lock, f"process {os.getpid()} on {platform.node()}\n".encode())
        yield has_locks
    finally:
        with suppress(OSError):
            path.unlink()
        os.close(lock)


def _acquired(path: Path, target: Path) -> tuple[int, bool]:
    """Return the descriptor of a lock, and whether the disk has locks."""
    import fcntl

    holder = ""
    for _ in range(_ATTEMPTS):
        lock = os.open(path, os.O_RDWR | os.O_CREAT | _FLAGS, 0o666)
        state = _try(lock, fcntl.LOCK_EX)
        with suppress(FileNotFoundError):  # its last holder may just have removed it
            if state != "held" and os.path.samestat(os.fstat(lock), path.stat()):
                return lock, state == "free"
        holder = os.read(lock, 200).decode(errors="replace").strip()
        os.close(lock)
        time.sleep(_PAUSE)
    raise StoreError(f"{target}: another run is writing it{holder and f' ({holder})'}")


def _try(lock: int, kind: int) -> str:
    """Lock a descriptor if it is "free"; else return "held" by another process, or "no locks" on this disk."""
    import fcntl

    try:
        fcntl.flock(lock, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return "held"
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
        return "no locks"
    return "free"


def holder_of(path: Path) -> tuple[Holder | None, bool]:
    """Return who holds the lock at ``path``, None for nobody, and whether that is sure: not of other hosts."""
    import fcntl

    try:
        lock = os.open(path, os.O_RDONLY | _FLAGS)
    except OSError:
        return None, True
    try:
        match = _HOLDER.fullmatch(os.read(lock, 200).decode(errors="replace").strip())
        since = datetime.fromtimestamp(os.fstat(lock).st_mtime, UTC).isoformat(timespec="seconds")
        state = _try(lock, fcntl.LOCK_SH)
    finally:
        os.close(lock)
    holder = Holder(int(match[1]), match[2], since) if match else None
    if state == "free" and (holder is None or holder.host == platform.node()):
        return None, True
    return holder, state == "held"
