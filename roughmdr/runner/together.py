"""Several processes that fill one batch: each takes runs that no other has, and one of them writes the result."""

import errno
import os
import threading
from collections.abc import Iterator, Sequence

from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.find import ReusableRows, find_previous, is_finished
from roughmdr.batch.resume.store import CheckpointStore
from roughmdr.batch.resume.writer import CheckpointWriter
from roughmdr.batch.tasks import Task
from roughmdr.errors import StoreError
from roughmdr.storage.labelled import Labelled

BETWEEN_LOOKS = 0.5  # time [s] between two looks at what other processes have stored


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
