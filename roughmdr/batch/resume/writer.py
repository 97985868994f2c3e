"""The part of one process in a batch: it takes runs that no other process has, and writes what is finished.

Task results are written while the batch runs, in a thread of their own, the result at its end by one of the processes.
"""

import errno
import os
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.find import ReusableRows, find_previous, is_finished
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.store import SO_FAR, CheckpointStore, locked_store, store_folder
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import Task
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Ints
from roughmdr.storage.files import ZARR_ENDING
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf
from roughmdr.storage.zarr_store import GrowingStore, write_zarr
from roughmdr.variables import FAILED

_MAX_NAME = 255  # bytes of a file's name
_MAX_PENDING = 16  # task results and chunks that may wait to be written before the batch waits
BETWEEN_LOOKS = 0.5  # time [s] between two looks at what other processes have stored


class CheckpointWriter:
    """Write checkpoints for one output and hold the lock of their folder until the ``stack`` is closed.

    Nothing is written without a ``target``; there is no folder if its name would be too long. Where other processes
    compute the same batch as the scene ``joins``, as TOML, this one shares the folder with them.
    """

    def __init__(self, target: Path | None, stack: ExitStack, *, of_share: bool = False, joins: str = "") -> None:
        self.target, self._stack = target, stack
        self._is_zarr = target is not None and target.suffix.lower() == ZARR_ENDING
        self.store: CheckpointStore | None = None
        self.joined: list[CheckpointStore] = []
        """Stores of shares, whose results are in the result as well."""
        self._cleared, self._replaces = False, ""
        self._thread: ThreadPoolExecutor | None = None
        self._pending: deque[Future[None]] = deque()
        self._growing: GrowingStore | None = None
        if target is not None and len(os.fsencode(store_folder(target).name)) <= _MAX_NAME:
            self.store = stack.enter_context(locked_store(target, of_share=of_share, joins=joins))

    def clear(self) -> None:
        """Remove the checkpoints of an earlier run; the file that is at the output now, if one is, may be replaced."""
        self._cleared, self._replaces = True, _stamp(self.target)
        if self.store is not None:
            self.store.clear()

    def begin(self, scene: str, command: str) -> None:
        """Write checkpoints of this scene from now on; StoreError where there is no folder for them.

        ``command`` is what continues the batch, but for --fresh.
        """
        if self._thread is None and self.target is not None:
            if self.store is None:
                raise StoreError(f"{self.target}: the name is too long for a folder of parts; give a shorter one")
            self.store.begin(scene, versions(), self._replaces, command)
            self._thread = self._stack.enter_context(ThreadPoolExecutor(1, "roughmdr-writer"))

    @property
    def begun(self) -> bool:
        """Whether checkpoints are written."""
        return self._thread is not None

    def may_replace(self, scene: str) -> bool:
        """Return whether this resumes a batch of this scene that was allowed to replace the file at the output."""
        store = self.store
        return store is not None and store.scene == scene and store.replaces == _stamp(self.target) != ""

    def put(self, result: TaskResult) -> None:
        """Write a task result, and note its failed runs, if checkpoints are written; StoreError where that fails."""
        if self._thread is None or self.store is None:
            return
        failed = result.diagnostics["status"] == FAILED
        if failed.any():
            runs = [(result.keys[result.cell[row]], int(result.first[row])) for row in failed.nonzero()[0]]
            remark = str(result.diagnostics["remark"][failed][0])
            self._submit(self._thread, self.store.note_failed, runs, remark)
        if not failed.all():
            done = result.select_rows((~failed).nonzero()[0])
            self._submit(self._thread, self.store.write, done)

    def grow(self, data: Labelled, status: NDArray[Any]) -> None:
        """Begin a ``GrowingStore`` if the target is a Zarr store and checkpoints are written, first by this process."""
        folder, first = self._folder, self.store is not None and self.store.alone
        if self._thread is not None and self._growing is None and self._is_zarr and first and folder is not None:
            self._growing = GrowingStore(data, status, folder / SO_FAR)
            self.placed(np.arange(status.size))

    def placed(self, runs: Ints) -> None:
        """Write the chunks that these runs made whole, if a store grows; StoreError where that fails."""
        if self._thread is not None and self._growing is not None:
            for chunk in self._growing.whole(runs):
                self._submit(self._thread, self._growing.write, chunk)

    def _submit(self, thread: ThreadPoolExecutor, function: Callable[..., None], *arguments: Any) -> None:
        """Have something written; wait while much is to be written already."""
        self._pending.append(thread.submit(function, *arguments))
        while self._pending and (self._pending[0].done() or len(self._pending) > _MAX_PENDING):
            self._pending.popleft().result()

    def flush(self) -> None:
        """Wait until all task results are on the disk."""
        while self._pending:
            self._pending.popleft().result()

    def finish(self, result: Labelled, *, complete: bool) -> None:
        """Write the result; remove the checkpoints if it is ``complete``: no run failed, and all of them are in it."""
        if self.target is None:
            return
        self.flush()
        if self._is_zarr:
            write_zarr(result, self.target, self._folder, None if self._growing is None else self._growing.folder)
        else:
            write_netcdf(result, self.target, self._folder)
        for store in [*([] if self.store is None else [self.store]), *self.joined] if complete else []:
            store.clear()

    @property
    def _folder(self) -> Path | None:
        """Folder to write a result in, where the next run removes what is left behind; None for that of the target."""
        if self.store is None or self.target is None:
            return None
        folder = self.store.folder  # a result cannot be renamed from one disk to another
        return folder if folder.stat().st_dev == self.target.parent.stat().st_dev else None

    @property
    def saved_message(self) -> str:
        """Message that tells which runs are kept, and where; empty if none are."""
        if self.store is None or self.store.empty or not self.store.folder.is_dir():
            return ""
        again = "the same command without --fresh" if self._cleared else "the same command"
        return f"what is finished is kept in {self.store.folder}; {again} goes on from there"


def _stamp(path: Path | None) -> str:
    """Return length [byte] and time [ns] of a file, which tell it from one that replaces it; empty where none is."""
    status = path.stat() if path is not None and path.exists() else None
    return f"{status.st_size} {status.st_mtime_ns}" if status else ""


class WrittenElsewhereError(Exception):
    """Another process has written the result of the batch."""

    def __init__(self, result: Labelled) -> None:
        super().__init__()
        self.result = result


class Together:
    """The part of one process in a batch; without checkpoints it does all of it."""

    def __init__(self, writer: CheckpointWriter, plan: Plan, keys: Sequence[set[str]]) -> None:
        self._writer, self._plan, self._keys = writer, plan, keys

    @property
    def _store(self) -> CheckpointStore | None:
        """The folder that other processes may see; None where nothing is kept yet."""
        return self._writer.store if self._writer.begun else None

    def look(self, reusable: ReusableRows) -> None:
        """Add what other processes have stored to ``reusable``."""
        if store := self._store:
            store.claims.look()  # before the results themselves: all that it knows to be stored can be read then
            for reader in store.news():
                reusable.add(reader)

    def check(self) -> None:
        """Raise WrittenElsewhereError where another process has written the result, and removed what led to it.

        StoreError where it is removed, and no result is there.
        """
        target, store = self._writer.target, self._store
        if target is not None and store is not None and store.ended:
            result = find_previous(target, alone=False)
            if result is None or not is_finished(result, self._plan, self._keys):
                self._writer.flush()
                raise StoreError(f"{store.folder}: cannot be written: {os.strerror(errno.ENOENT)}")
            raise WrittenElsewhereError(result)

    def claimed(self, tasks: Sequence[Task], *, by_workers: bool) -> Iterator[Task]:
        """Yield tasks whose runs ``by_workers`` are claimed as they begin, or those of which they could be claimed now.

        A task of which runs have failed elsewhere, or are stored merged with others, is computed in any case.
        """
        store = self._store
        anyway = [store is None or store.claims.are_done(task.runs) for task in tasks]  # before others do more
        for task, unclaimed in zip(tasks, anyway, strict=True):
            if store is None or unclaimed:
                yield task
            elif by_workers:
                yield task._replace(claimed_in=store.whole_path)
            elif store.claims.take(task.runs):
                yield task

    def await_turn(self, stop: threading.Event) -> None:
        """Wait until no other process is about to write the result, or until ``stop`` is set; check whether it has."""
        if store := self._store:
            while not store.claims.finish() and not stop.wait(BETWEEN_LOOKS):
                pass
            self.check()
