"""OUT.nc.parts: the finished task results of a batch that is not over, safe against whatever ends it.

A task result is written to a temporary name, synchronised to the disk, and renamed; then a line of the manifest gives
its hash. A file without a line does not count, and neither does a line that was not finished. A lock that the system
releases when its process dies keeps others out, but for processes that compute the same batch: they share the lock.
"""

import hashlib
import json
import os
import re
import secrets
import shutil
import stat
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from roughmdr.batch.resume.locks import CLAIMS, LOCK, Claims, FolderLock, acquire_lock, claims_in, give_up
from roughmdr.batch.resume.manifest import FILE, MANIFEST, Manifest, StoredFile
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.storage.files import convert_os_errors, sync_folder

SO_FAR = "so_far.zarr"
_OWN_FILES = re.compile(rf"{re.escape(MANIFEST)}|{re.escape(SO_FAR)}|[0-9]{{6,}}\.npz(\.tmp)?|\.roughmdr\..*")
"""Names of all that is written to the folder, but the lock and claims: nothing else is removed."""
_FILES_OF_ONE = 10**6  # numbers of files that each process has to itself where several write to a folder


def store_folder(target: Path) -> Path:
    """Return the folder of the task results that belong to a result."""
    return target.with_name(f"{target.name}.parts")


def _is_regular(path: Path) -> bool:
    """Return whether a path is a regular file: no link to another place, and nothing that may never end."""
    return stat.S_ISREG(path.lstat().st_mode)


def read_task_result(folder: Path, file: str, sha256: str) -> TaskResult | None:
    """Return a stored task result; None where it is damaged, or no longer there."""
    path = folder / file
    with suppress(OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
        if _is_regular(path):
            content = path.read_bytes()
            if hashlib.sha256(content).hexdigest() == sha256:
                return TaskResult.from_bytes(content)
    return None


class CheckpointStore(Manifest):
    """The folder, while this process holds its lock."""

    def __init__(self, folder: Path, lock: FolderLock | None = None, *, of_share: bool = False) -> None:
        super().__init__(folder)
        self._of_share, self._lock = of_share, lock
        self.whole_path = folder.resolve()  # found now: the current folder may vanish
        self._own = set[str]()
        manifest = folder / MANIFEST
        if self.alone and os.path.lexists(manifest) and not _is_regular(manifest):
            raise StoreError(f"{manifest}: is no ordinary file; remove it")
        self._files = self.new_files()
        self._next = 1 + max((int(file.name[:-4]) for file in self._files), default=0)
        if not self.alone:
            self._next = (1 + secrets.randbelow(_FILES_OF_ONE)) * _FILES_OF_ONE

    @property
    def alone(self) -> bool:
        """Whether no other process was computing the batch when this one began."""
        return self._lock is None or self._lock.alone

    @property
    def claims(self) -> Claims:
        """The claims of this process on runs of the batch."""
        return claims_in(self.whole_path)

    @property
    def empty(self) -> bool:
        """Whether no task result is stored."""
        return not self._files and not self._own

    @property
    def removable(self) -> bool:
        """Whether the folder tells nothing that is needed: of a share also which runs failed."""
        self.news()  # another process may have stored more, and ended
        return self.empty and not (self._of_share and self.failed)

    def begin(self, scene: str, versions: str, replaces: str, command: str) -> None:
        """Note the batch that the folder is for, if it is a new one."""
        if not self.scene or (self._of_share and (self.scene, self.versions) != (scene, versions)):
            self.scene, self.versions, self.replaces = scene, versions, replaces
            began = datetime.now(UTC).isoformat(timespec="seconds")
            decisive = {"scene": scene, "versions": versions, "replaces": replaces}
            self._append({**decisive, "command": command, "began": began})
        if self.alone:
            self.claims.look()  # runs that are stored, but cannot be used, are computed again
            same = (self.scene, self.versions) == (scene, versions)  # else it has begun with fewer runs perhaps
            if self._lock is not None and same and not self._of_share:
                self._lock.share()

    def readers(self) -> Iterator[Callable[[], TaskResult | None]]:
        """Yield a function for each task result that reads it; it returns None for one that is damaged."""
        return self._readers(self._files)

    def news(self) -> Iterator[Callable[[], TaskResult | None]]:
        """Yield such functions for what other processes have stored since the last call."""
        self._files += (new := [file for file in self.new_files() if file.name not in self._own])
        return self._readers(new)

    def _readers(self, files: list[StoredFile]) -> Iterator[Callable[[], TaskResult | None]]:
        return (partial(read_task_result, self.folder, file.name, file.sha256) for file in files)

    def write(self, result: TaskResult) -> None:
        """Store a task result for good; StoreError where that fails, and then nothing is changed."""
        content, file = result.to_bytes(), FILE.format(self._next)
        temporary = self.folder / f"{file}.tmp"
        with convert_os_errors(self.folder):
            try:
                with temporary.open("wb") as opened:
                    opened.write(content)
                    opened.flush()
                    os.fsync(opened.fileno())
                temporary.replace(self.folder / file)
            except OSError:
                temporary.unlink(missing_ok=True)
                raise
            sync_folder(self.folder)
        digest = hashlib.sha256(content).hexdigest()
        self._own.add(file)
        self._append({"file": file, "sha256": digest, "realizations": result.realizations, "runs": result.runs})
        self._next += 1

    def note_failed(self, runs: list[tuple[str, int]], remark: str) -> None:
        """Note runs that failed, as key of the cell and realisation, and why; the next batch repeats them."""
        self._append({"failed": runs, "remark": remark})

    def note_complete(self) -> None:
        """Note that all runs of a share are kept."""
        self._append({"complete": True})

    def clear(self) -> None:
        """Remove all that was written to the folder but the lock, since the folder stays locked while it exists."""
        with convert_os_errors(self.folder):
            (self.folder / MANIFEST).unlink(missing_ok=True)  # first: without it nothing else counts
            for path in self.folder.iterdir():
                if _OWN_FILES.fullmatch(path.name):
                    _remove(path)
        super().__init__(self.folder)
        self._files, self._own, self._next = [], set(), 1

    def _append(self, line: dict[str, Any]) -> None:
        """Append a line: that of a batch to a new manifest, too, any other only where no process has removed it."""
        manifest, flags = self.folder / MANIFEST, os.O_RDWR | os.O_APPEND | (os.O_CREAT if "scene" in line else 0)
        with (
            convert_os_errors(self.folder),
            self.claims.appending(),
            os.fdopen(os.open(manifest, flags, 0o666), "r+b") as file,
        ):
            before = file.seek(0, os.SEEK_END)
            cut = before > 0 and os.pread(file.fileno(), 1, before - 1) != b"\n"  # by a process that was killed
            try:
                file.write(b"\n" * cut + json.dumps(line).encode() + b"\n")
                file.flush()
                os.fsync(file.fileno())
            except OSError:
                with suppress(OSError):
                    os.truncate(manifest, before)
                raise


def _remove(path: Path) -> None:
    """Remove what another process may be removing as well."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


@contextmanager
def locked_store(target: Path, *, of_share: bool = False, joins: str = "") -> Iterator[CheckpointStore]:
    """Open the store of a result or a share, made if need be, for this process and others that compute ``joins``.

    The last of them removes the folder if it tells nothing. StoreError where another process holds its lock.
    """
    folder = store_folder(target)
    with convert_os_errors(folder):
        lock = acquire_lock(folder, target, joins)
    store = None
    try:
        with convert_os_errors(folder):
            # Neither whole, nor known to be on the disk.
            for path in (*folder.glob("*.tmp"), *folder.glob(SO_FAR)) if lock.alone else ():
                if _OWN_FILES.fullmatch(path.name):
                    _remove(path)
            store = CheckpointStore(folder, lock, of_share=of_share)
        yield store
    finally:
        if store is not None:
            give_up(store.whole_path)
        if lock.is_last():
            with suppress(OSError, StoreError):
                if store is not None and (store.ended or store.removable):
                    store.clear()
                if {path.name for path in folder.glob("*")} <= {LOCK, CLAIMS}:
                    (folder / CLAIMS).unlink(missing_ok=True)
                    (folder / LOCK).unlink()
                    folder.rmdir()
            lock.forget()
        lock.release()
