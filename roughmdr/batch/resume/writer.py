"""Writes what is finished: task results while a batch runs, in a thread of its own, and the result at its end."""

import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path

from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.store import CheckpointStore, locked_store, store_folder
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.variables import FAILED

_MAX_NAME = 255  # bytes of a file's name
_MAX_PENDING = 16  # task results that may wait to be written before the batch waits


class CheckpointWriter:
    """Write checkpoints for one output and hold the lock of their folder; no folder if its name would be too long."""

    def __init__(self, target: Path, stack: ExitStack) -> None:
        self.target, self._stack = target, stack
        self.store: CheckpointStore | None = None
        self._cleared, self._replaces = False, ""
        self._thread: ThreadPoolExecutor | None = None
        self._pending: deque[Future[None]] = deque()
        if len(os.fsencode(store_folder(target).name)) <= _MAX_NAME:
            self.store = stack.enter_context(locked_store(target))

    def clear(self) -> None:
        """Remove the checkpoints of an earlier run; the file that is at the output now, if one is, may be replaced."""
        self._cleared, self._replaces = True, _stamp(self.target)
        if self.store is not None:
            self.store.clear()

    def begin(self, scene: str) -> None:
        """Write checkpoints of this scene from now on; StoreError where there is no folder for them."""
        if self._thread is None:
            if self.store is None:
                raise StoreError(f"{self.target}: the name is too long for a folder of parts; give a shorter one")
            self.store.begin(scene, versions(), self._replaces)
            self._thread = self._stack.enter_context(ThreadPoolExecutor(1, "roughmdr-writer"))

    @property
    def begun(self) -> bool:
        """Whether checkpoints are written."""
        return self._thread is not None

    def may_replace(self, scene: str) -> bool:
        """Return whether this resumes a batch of this scene that was allowed to replace the file at the output."""
        if self.store is None or not self.store.replaces:
            return False
        return self.store.scene == scene and self.store.replaces == _stamp(self.target)

    def put(self, result: TaskResult) -> None:
        """Write a task result without its failed runs, if checkpoints are written; StoreError where that fails."""
        done = result.select_rows((result.diagnostics["status"] != FAILED).nonzero()[0])
        if self._thread is None or self.store is None or not len(done.first):
            return
        self._pending.append(self._thread.submit(self.store.write, done))
        while self._pending and (self._pending[0].done() or len(self._pending) > _MAX_PENDING):
            self._pending.popleft().result()

    def flush(self) -> None:
        """Wait until all task results are on the disk."""
        while self._pending:
            self._pending.popleft().result()

    def finish(self, result: Labelled, *, complete: bool) -> None:
        """Write the result; remove the checkpoints if it is ``complete``: no run failed, and all of them are in it."""
        self.flush()
        write_netcdf(result, self.target, self._temporary_folder())
        if self.store is not None and complete:
            self.store.clear()

    def _temporary_folder(self) -> Path | None:
        """Return the folder to write the result in: the checkpoints', where the next run removes what is left behind.

        None where the result cannot be renamed from there.
        """
        if self.store is None:
            return None
        folder = self.store.folder
        return folder if folder.stat().st_dev == self.target.parent.stat().st_dev else None

    @property
    def saved_message(self) -> str:
        """Message that tells which runs are kept, and where; empty if none are."""
        if self.store is None or self.store.empty or not self.store.folder.is_dir():
            return ""
        again = "the same command without --fresh" if self._cleared else "the same command"
        return f"what is finished is kept in {self.store.folder}; {again} goes on from there"


def _stamp(path: Path) -> str:
    """Return length [byte] and time [ns] of a file, which tell it from one that replaces it; empty where none is."""
    if not path.exists():
        return ""
    status = path.stat()
    return f"{status.st_size} {status.st_mtime_ns}"


@contextmanager
def checkpointing(target: Path | None) -> Iterator[CheckpointWriter | None]:
    """Open the checkpoint writer of an output, None where there is no output."""
    with ExitStack() as stack:
        yield None if target is None else CheckpointWriter(target, stack)
