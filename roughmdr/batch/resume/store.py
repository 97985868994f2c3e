"""OUT.nc.parts: the finished shards of a batch that is not over, safe against whatever ends it.

A shard goes to a temporary name, onto the disk, and under its own name; then a line of the manifest says what it must
hold. What no line speaks of does not count, and a line that was not finished is none. A lock that the system lets go
of when its holder dies keeps others out.
"""

import errno
import hashlib
import json
import os
import platform
import re
import shutil
import stat
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.storage.atomic import sync_folder
from roughmdr.storage.file_checks import convert_os_errors

# What disks say that know no locks, as some of those that a cluster shares: there nobody is kept out.
_NO_LOCKS = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)
_LOCK, _MANIFEST, _SHARD = "lock", "manifest.jsonl", "{:06d}.npz"
_SHARD_NAME = re.compile(r"[0-9]{6,}\.npz")
_OWN = re.compile(rf"{re.escape(_MANIFEST)}|[0-9]{{6,}}\.npz(\.tmp)?|\.roughmdr\..*")
"""Names of all that is written to the folder beside the lock: nothing else is taken away."""


def store_folder(target: Path) -> Path:
    """The folder of the parts of a result."""
    return target.with_name(f"{target.name}.parts")


def _ordinary(path: Path) -> bool:
    """Whether a file is one, and no link to another place and nothing that may never end."""
    return stat.S_ISREG(path.lstat().st_mode)


class ShardStore:
    """The folder, while this process holds its lock."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.scene = ""
        """In TOML; of the batch that began the folder."""
        self.versions = ""
        self.replaces = ""
        """Marks the file that this batch was told to replace (see ``Keeper``); empty for none."""
        self._lines = self._read()
        self._next = 1 + max((int(line["file"][:-4]) for line in self._lines), default=0)

    @property
    def empty(self) -> bool:
        """Whether no shard is kept."""
        return self._next == 1

    def begin(self, scene: str, versions: str, replaces: str) -> None:
        """Say what the folder is for, if it is a new one."""
        if not self.scene:
            self.scene, self.versions, self.replaces = scene, versions, replaces
            self._append({"scene": scene, "versions": versions, "replaces": replaces})

    def held(self) -> Iterator[Callable[[], TaskResult | None]]:
        """What reads each of the shards; it gives None for one that is not whole."""
        return (partial(self._shard, line["file"], line["sha256"]) for line in self._lines)

    def _shard(self, file: str, sha256: str) -> TaskResult | None:
        path = self.folder / file
        with suppress(OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
            if _ordinary(path):
                content = path.read_bytes()
                if hashlib.sha256(content).hexdigest() == sha256:
                    return TaskResult.loaded(content)
        return None

    def put(self, shard: TaskResult) -> None:
        """Keep a shard for good; StoreError where that fails, and then nothing is changed."""
        content, file = shard.dumped(), _SHARD.format(self._next)
        temporary = self.folder / f"{file}.tmp"
        with convert_os_errors(self.folder):
            try:
                with temporary.open("wb") as written:
                    written.write(content)
                    written.flush()
                    os.fsync(written.fileno())
                temporary.replace(self.folder / file)
            except OSError:
                temporary.unlink(missing_ok=True)
                raise
            sync_folder(self.folder)
        self._append(
            {
                "file": file,
                "sha256": hashlib.sha256(content).hexdigest(),
                "rows": len(shard.first),
                "realizations": int(shard.size.sum()),
                "run_time": float(shard.run_time.sum()),
            }
        )
        self._next += 1

    def remove(self) -> None:
        """Take away all that was written to the folder but the lock: while anything is in it, it is locked."""
        with convert_os_errors(self.folder):
            (self.folder / _MANIFEST).unlink(missing_ok=True)  # first: without it nothing else counts
            for path in self.folder.iterdir():
                if _OWN.fullmatch(path.name):
                    shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        self.scene, self.replaces, self._lines, self._next = "", "", [], 1

    def _read(self) -> list[dict[str, Any]]:
        """The lines of the manifest that speak of shards; one that was not finished is cut off."""
        lines: list[dict[str, Any]] = []
        manifest = self.folder / _MANIFEST
        if os.path.lexists(manifest) and not _ordinary(manifest):
            raise StoreError(f"{manifest}: is no ordinary file; take it away")
        content = manifest.read_bytes() if manifest.exists() else b""
        whole = content[: content.rfind(b"\n") + 1]
        if whole != content:
            os.truncate(manifest, len(whole))
        for text in whole.splitlines():
            with suppress(ValueError, RecursionError):
                match json.loads(text):
                    case {"scene": str(scene), "versions": str(versions), "replaces": str(replaces)}:
                        self.scene, self.versions, self.replaces = scene, versions, replaces
                    case {"file": str(file), "sha256": str()} as line if _SHARD_NAME.fullmatch(file):
                        lines.append(line)
        return lines

    def _append(self, line: dict[str, Any]) -> None:
        manifest = self.folder / _MANIFEST
        with convert_os_errors(self.folder), manifest.open("ab") as file:
            before = file.tell()
            try:
                file.write(json.dumps(line).encode() + b"\n")
                file.flush()
                os.fsync(file.fileno())
            except OSError:
                with suppress(OSError):
                    os.truncate(manifest, before)
                raise


@contextmanager
def locked_store(target: Path) -> Iterator[ShardStore]:
    """The parts of a result, made if need be, for this process alone; StoreError where another one holds them.

    The folder goes away at the end if nothing is kept in it.
    """
    folder = store_folder(target)
    with convert_os_errors(folder):
        lock = _locked(folder, target)
    try:
        with convert_os_errors(folder):
            for path in folder.glob("*.tmp"):
                if _OWN.fullmatch(path.name):
                    path.unlink()
            parts = ShardStore(folder)
        try:
            yield parts
        finally:
            if parts.empty:
                with suppress(OSError):
                    (folder / _MANIFEST).unlink()
    finally:
        if {path.name for path in folder.glob("*")} == {_LOCK}:
            with suppress(OSError):
                (folder / _LOCK).unlink()
                folder.rmdir()
        os.close(lock)


def _locked(folder: Path, target: Path) -> int:
    """The descriptor of a lock on the folder, which is there until it is closed."""
    import fcntl

    while True:
        folder.mkdir(exist_ok=True)
        try:
            lock = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        except FileNotFoundError:  # who held it before has just taken the folder away
            continue
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(lock, 200).decode(errors="replace").strip()
            os.close(lock)
            raise StoreError(f"{target}: another run is writing it{holder and f' ({holder})'}") from None
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                os.close(lock)
                raise
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(lock), os.stat(folder / _LOCK)):
                with suppress(OSError):  # the disk may be full; who holds the lock is only said to be helpful
                    os.truncate(lock, 0)
                    os.write(lock, f"process {os.getpid()} on {platform.node()}\n".encode())
                return lock
        os.close(lock)
