"""OUT.nc.parts: the finished task results of a batch that is not over, safe against whatever ends it.

A task result is written to a temporary name, synchronised to the disk, and renamed; then a line of the manifest gives
its hash. A file without a line does not count, and neither does a line that was not finished. A lock that the system
releases when its process dies keeps others out.
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
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.storage.files import convert_os_errors, sync_folder

# Errors of disks without locks, such as some that a cluster shares: there nobody is kept out.
_NO_LOCKS = (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK)
LOCK, MANIFEST, SO_FAR, _FILE = "lock", "manifest.jsonl", "so_far.zarr", "{:06d}.npz"
_FILE_NAME = re.compile(r"[0-9]{6,}\.npz")
_OWN_FILES = re.compile(rf"{re.escape(MANIFEST)}|{re.escape(SO_FAR)}|[0-9]{{6,}}\.npz(\.tmp)?|\.roughmdr\..*")
"""Names of all that is written to the folder, but the lock: nothing else is removed."""


def store_folder(target: Path) -> Path:
    """Return the folder of the task results that belong to a result."""
    return target.with_name(f"{target.name}.parts")


def _is_regular(path: Path) -> bool:
    """Return whether a path is a regular file: no link to another place, and nothing that may never end."""
    return stat.S_ISREG(path.lstat().st_mode)


def manifest_lines(content: bytes) -> Iterator[dict[str, Any]]:
    """Yield the whole lines of a manifest: that of the batch, and those of its task results and failed runs."""
    for text in content[: content.rfind(b"\n") + 1].splitlines():
        with suppress(ValueError, RecursionError):
            line = json.loads(text)
            if isinstance(line, dict) and _FILE_NAME.fullmatch(str(line.get("file", _FILE.format(0)))):
                yield line


def read_task_result(folder: Path, file: str, sha256: str) -> TaskResult | None:
    """Return a stored task result; None where it is damaged, or no longer there."""
    path = folder / file
    with suppress(OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
        if _is_regular(path):
            content = path.read_bytes()
            if hashlib.sha256(content).hexdigest() == sha256:
                return TaskResult.from_bytes(content)
    return None


class CheckpointStore:
    """The folder, while this process holds its lock."""

    def __init__(self, folder: Path, *, of_share: bool = False) -> None:
        self.folder, self._of_share = folder, of_share
        self.scene = ""
        """TOML text of the scene of the batch that began the folder; of a share, of the last that went on there."""
        self.versions = ""
        self.replaces = ""
        """Stamp of the file that this batch may replace (see ``CheckpointWriter``); empty for none."""
        self._has_failed = False
        self._lines = self._read_manifest()
        self._next = 1 + max((int(line["file"][:-4]) for line in self._lines), default=0)

    @property
    def empty(self) -> bool:
        """Whether no task result is stored."""
        return self._next == 1

    @property
    def removable(self) -> bool:
        """Whether the folder tells nothing that is needed: of a share also which runs failed."""
        return self.empty and not (self._of_share and self._has_failed)

    def begin(self, scene: str, versions: str, replaces: str, command: str) -> None:
        """Note the batch that the folder is for, if it is a new one."""
        if not self.scene or (self._of_share and (self.scene, self.versions) != (scene, versions)):
            self.scene, self.versions, self.replaces = scene, versions, replaces
            began = datetime.now(UTC).isoformat(timespec="seconds")
            decisive = {"scene": scene, "versions": versions, "replaces": replaces}
            self._append({**decisive, "command": command, "began": began})

    def readers(self) -> Iterator[Callable[[], TaskResult | None]]:
        """Yield a function for each task result that reads it; it returns None for one that is damaged."""
        return (partial(read_task_result, self.folder, line["file"], line["sha256"]) for line in self._lines)

    def write(self, result: TaskResult) -> None:
        """Store a task result for good; StoreError where that fails, and then nothing is changed."""
        content, file = result.to_bytes(), _FILE.format(self._next)
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
        cells = {key: int(result.size[result.cell == i].sum()) for i, key in enumerate(result.keys)}
        self._append({"file": file, "sha256": digest, "realizations": result.realizations, "cells": cells})
        self._next += 1

    def note_failed(self, runs: list[tuple[str, int]], remark: str) -> None:
        """Note runs that failed, as key of the cell and realisation, and why; the next batch repeats them."""
        self._append({"failed": runs, "remark": remark})
        self._has_failed = True

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
        self.scene, self.replaces, self._has_failed, self._lines, self._next = "", "", False, [], 1

    def _read_manifest(self) -> list[dict[str, Any]]:
        """Return the lines of the manifest about task results; one that was not finished is cut off."""
        lines: list[dict[str, Any]] = []
        manifest = self.folder / MANIFEST
        if os.path.lexists(manifest) and not _is_regular(manifest):
            raise StoreError(f"{manifest}: is no ordinary file; remove it")
        content = manifest.read_bytes() if manifest.exists() else b""
        whole = content[: content.rfind(b"\n") + 1]
        if whole != content:
            os.truncate(manifest, len(whole))
        for line in manifest_lines(whole):
            match line:
                case {"scene": str(scene), "versions": str(versions), "replaces": str(replaces)}:
                    self.scene, self.versions, self.replaces = scene, versions, replaces
                case {"file": str(), "sha256": str()}:
                    lines.append(line)
                case {"failed": list()}:
                    self._has_failed = True
        return lines

    def _append(self, line: dict[str, Any]) -> None:
        manifest = self.folder / MANIFEST
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


def _remove(path: Path) -> None:
    shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


@contextmanager
def locked_store(target: Path, *, of_share: bool = False) -> Iterator[CheckpointStore]:
    """Open the store of a result or a share, made if need be, for this process alone.

    The folder is removed at the end if it tells nothing. StoreError where another process holds its lock.
    """
    folder = store_folder(target)
    with convert_os_errors(folder):
        lock = _acquire_lock(folder, target)
    try:
        with convert_os_errors(folder):
            for path in (*folder.glob("*.tmp"), *folder.glob(SO_FAR)):  # not whole, nor known to be on the disk
                if _OWN_FILES.fullmatch(path.name):
                    _remove(path)
            store = CheckpointStore(folder, of_share=of_share)
        try:
            yield store
        finally:
            if store.removable:
                shutil.rmtree(folder / SO_FAR, ignore_errors=True)
                with suppress(OSError):
                    (folder / MANIFEST).unlink()
    finally:
        with suppress(OSError):
            if {path.name for path in folder.glob("*")} == {LOCK}:
                (folder / LOCK).unlink()
                folder.rmdir()
        with suppress(OSError):
            os.ftruncate(lock, 0)  # no run is at work any more, for those too who do not see the lock
        os.close(lock)


def _acquire_lock(folder: Path, target: Path) -> int:
    """Return the descriptor of a lock on the folder, which is locked until the descriptor is closed."""
    import fcntl

    while True:
        folder.mkdir(exist_ok=True)
        try:
            lock = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        except FileNotFoundError:  # its last holder has just removed the folder
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
            if os.path.samestat(os.fstat(lock), os.stat(folder / LOCK)):
                with suppress(OSError):  # the disk may be full; the holder is named only to be helpful
                    os.truncate(lock, 0)
                    os.write(lock, f"process {os.getpid()} on {platform.node()}\n".encode())
                return lock
        os.close(lock)
