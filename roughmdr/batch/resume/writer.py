"""Keeps what is finished: shards on the disk while a batch runs, by one thread, and the result at its end."""

import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path

from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.store import ShardStore, locked_store, store_folder
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.variables import FAILED

_LONGEST = 255  # bytes of a file's name
_WAITING = 16  # shards that may wait to be written before the batch does


class CheckpointWriter:
    """Of one output; it holds the lock of its parts, unless its name is too long for them."""

    def __init__(self, target: Path, stack: ExitStack) -> None:
        self.target, self._stack = target, stack
        self.parts: ShardStore | None = None
        self._cleared, self._replaces = False, ""
        self._writer: ThreadPoolExecutor | None = None
        self._pending: deque[Future[None]] = deque()
        if len(os.fsencode(store_folder(target).name)) <= _LONGEST:
            self.parts = stack.enter_context(locked_store(target))

    def clear(self) -> None:
        """Take away what an earlier run kept; the file that is at the output now, if one is, may be replaced."""
        self._cleared, self._replaces = True, _mark(self.target)
        if self.parts is not None:
            self.parts.remove()

    def begin(self, scene: str) -> None:
        """From now on there is something to lose: keep shards of this scene."""
        if self._writer is None:
            if self.parts is None:
                raise StoreError(f"{self.target}: the name is too long for a folder of parts; give a shorter one")
            self.parts.begin(scene, versions(), self._replaces)
            self._writer = self._stack.enter_context(ThreadPoolExecutor(1, "roughmdr-writer"))

    def may_replace(self, scene: str) -> bool:
        """Whether a batch of this scene goes on that was told to replace the file at the output."""
        if self.parts is None or not self.parts.replaces:
            return False
        return self.parts.scene == scene and self.parts.replaces == _mark(self.target)

    def put(self, shard: TaskResult) -> None:
        """Keep a shard, if shards are kept, without the runs of it that failed; StoreError where that cannot be."""
        done = shard.rows((shard.status != FAILED).nonzero()[0])
        if self._writer is None or self.parts is None or not len(done.first):
            return
        self._pending.append(self._writer.submit(self.parts.put, done))
        while self._pending and (self._pending[0].done() or len(self._pending) > _WAITING):
            self._pending.popleft().result()

    def flush(self) -> None:
        """All shards are on the disk when this returns."""
        while self._pending:
            self._pending.popleft().result()

    def finish(self, result: Labelled, *, whole: bool) -> None:
        """Write the result; the parts go if it is ``whole``: if no run failed, and all that was kept is in it."""
        self.flush()
        write_netcdf(result, self.target, self._near())
        if self.parts is not None and whole:
            self.parts.remove()

    def _near(self) -> Path | None:
        """Where the result is best written to: with the parts, so that the next run takes away what this one may leave.

        None where the result could not take its place from there.
        """
        if self.parts is None:
            return None
        folder = self.parts.folder
        return folder if folder.stat().st_dev == self.target.parent.stat().st_dev else None

    @property
    def begun(self) -> bool:
        """Whether shards are kept from now on."""
        return self._writer is not None

    @property
    def said(self) -> str:
        """What is safe, in words; empty where nothing is."""
        if self.parts is None or self.parts.empty or not self.parts.folder.is_dir():
            return ""
        again = "the same command without --fresh" if self._cleared else "the same command"
        return f"what is finished is kept in {self.parts.folder}; {again} goes on from there"


def _mark(path: Path) -> str:
    """Tell a file from any that takes its place, by its length [byte] and its time [ns]; empty where none is."""
    if not path.exists():
        return ""
    found = path.stat()
    return f"{found.st_size} {found.st_mtime_ns}"


@contextmanager
def checkpointing(target: Path | None) -> Iterator[CheckpointWriter | None]:
    """The keeper of an output, None where there is none."""
    with ExitStack() as stack:
        yield None if target is None else CheckpointWriter(target, stack)
