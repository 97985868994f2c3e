"""Computes tasks on this machine, in threads or in processes: as many at a time as there are workers."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor, as_completed, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from itertools import islice
from typing import Protocol, TypeVar

from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import Task, compute, failed
from roughmdr.errors import RoughmdrError, Unfinished

_Item = TypeVar("_Item")
_Done = TypeVar("_Done")
_Pending = Future[TaskResult | None]
Sink = Callable[[TaskResult], None]  # receives a finished task result, in the thread that called

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_MAX_STARTS = 3  # attempts to start processes


class Pool(Protocol):
    """Computes tasks, but those whose runs other processes have claimed."""

    @property
    def workers(self) -> int:
        """Number of tasks that run at a time."""
        ...

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute tasks; when ``stop`` is set, those under way are finished and no others begun."""
        ...


class Threads:
    """Threads of this process: compiled code releases Python's lock."""

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute the tasks in threads."""
        pool = ThreadPoolExecutor(self.workers, "roughmdr")
        try:
            for _, done in _computed(pool, self.workers, iter(tasks), stop.is_set):
                if (result := done.result()) is not None:
                    sink(result)
        except BaseException:
            stop.set()
            raise
        finally:
            pool.shutdown(wait=not stop.is_set(), cancel_futures=True)


class Processes:
    """Processes of this machine, for code that holds Python's lock; one that dies is replaced."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._group: ProcessGroup | None = None

    def close(self) -> None:
        """End the processes, and with them their claims: what they computed must be stored before."""
        if self._group is not None:
            self._group.end()
            self._group = None

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute the tasks in processes, which last until they are closed; one whose process dies again and again has
        failed.
        """
        remaining = iter(tasks)
        try:
            while lost := self._lost(remaining, stop, sink):
                for task in self._lost(iter(lost), stop, sink):  # one of them is to blame: each is tried alone
                    if self._lost(iter([task]), stop, sink):
                        sink(failed(task, "the process that computed it died"))
        except BaseException:
            stop.set()
            self.close()
            raise

    def _lost(self, tasks: Iterator[Task], stop: threading.Event, sink: Sink) -> list[Task]:
        """Compute tasks until a process dies; return those that were under way then."""
        self._group = self._group or ProcessGroup(self.workers)
        lost = list[Task]()
        for task, done in _computed(self._group.pool, self.workers, tasks, lambda: stop.is_set() or bool(lost)):
            try:
                result = done.result()
            except BrokenProcessPool:
                lost.append(task)
            else:
                if result is not None:
                    sink(result)
        if lost:
            self.close()
        return lost


def _computed(
    pool: Executor, workers: int, tasks: Iterator[Task], ended: Callable[[], bool]
) -> Iterator[tuple[Task, _Pending]]:
    """Yield tasks as they are done; none is begun before a result is taken, nor once they have ``ended``."""
    under_way, done = dict[_Pending, Task](), list[tuple[Task, _Pending]]()
    while True:
        for task in islice(tasks, 0 if ended() else workers - len(under_way) - len(done)):
            under_way[_submitted(pool, task)] = task
        if done:
            yield done.pop()
        elif under_way:
            done = [(under_way.pop(future), future) for future in wait(under_way, return_when="FIRST_COMPLETED").done]
        else:
            return


def _submitted(pool: Executor, task: Task) -> _Pending:
    """Return the future of a task, which tells too that a process has died before."""
    try:
        return pool.submit(compute, task)
    except BrokenProcessPool as error:
        broken = _Pending()
        broken.set_exception(error)
        return broken


class ProcessGroup:
    """A pool of processes that end with it, and with this process, however that ends."""

    def __init__(self, workers: int) -> None:
        if multiprocessing.current_process().daemon:
            raise RoughmdrError("scheduler is 'processes', which cannot run inside a daemonic process")
        context = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang
        for _ in range(_MAX_STARTS):
            self.pool = ProcessPoolExecutor(workers, context, _start_worker)
            with _signals_blocked():
                # Each is started with the first call for which no other is idle.
                started = [self.pool.submit(int) for _ in range(workers)]
            with suppress(BrokenProcessPool):
                for future in started:
                    future.result()
                return
            self.end()
        raise RoughmdrError(
            "scheduler is 'processes': no process can be started; a script must make its calls under "
            "if __name__ == '__main__':"
        )

    def end(self) -> None:
        """Kill all processes, also those that have only just begun; they ignore SIGTERM."""
        for process in list((self.pool._processes or {}).values()):
            process.kill()
        self.pool.shutdown(wait=False, cancel_futures=True)


def over_processes(
    function: Callable[[_Item], _Done], items: Sequence[_Item], workers: int
) -> Iterator[tuple[int, _Done]]:
    """Yield the position of each item with what the function makes of it, as they are done.

    One worker is this process. Unfinished where a process dies.
    """
    if workers == 1:
        yield from enumerate(map(function, items))
        return
    group = ProcessGroup(workers)
    try:
        futures = {group.pool.submit(function, item): position for position, item in enumerate(items)}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool:
        raise Unfinished("a process died, perhaps for lack of memory; fewer workers take less") from None
    finally:
        group.end()


@contextmanager
def _signals_blocked() -> Iterator[None]:
    """Block signals, also in processes that are started meanwhile, from their first moment on."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start_worker() -> None:
    """Make a worker process leave signals to its parent, and end when that does."""
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
