"""Computes tasks on this machine: in the calling thread, over dask's threads, or over processes."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from itertools import islice
from multiprocessing.context import SpawnContext
from multiprocessing.synchronize import Event
from typing import Any, Protocol, TypeVar

from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import Task, compute, failed
from roughmdr.errors import RoughmdrError, Unfinished

_Item = TypeVar("_Item")
_Done = TypeVar("_Done")
Sink = Callable[[TaskResult], None]  # receives a finished task result, in the thread that called

_BATCH = 64  # tasks a worker that dask is given at a time: it finishes a batch before it begins the next one
_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_MAX_STARTS = 3  # attempts to start processes
_MAX_LOSSES = 1  # how often all tasks are tried again when a process died, before each is tried alone


class Pool(Protocol):
    """Computes tasks, but those whose runs other processes have claimed."""

    @property
    def workers(self) -> int:
        """Number of tasks that run at a time."""
        ...

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute tasks; when ``stop`` is set, those under way are finished and no others begun."""
        ...


class Serial:
    """The calling thread, for a batch that is over before dask is loaded."""

    workers = 1

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute the tasks in this thread."""
        for task in tasks:
            if not stop.is_set() and (result := compute(task)) is not None:
                sink(result)


class Threads:
    """Threads of this process: compiled code releases Python's lock."""

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute the tasks in threads."""
        from dask.threaded import get

        # Its own pool: those that dask keeps are dead in a process that was forked from this one.
        pool = ThreadPoolExecutor(self.workers, "roughmdr")
        try:
            for batch in _batches(tasks, _BATCH * self.workers):
                if stop.is_set():
                    return
                functions = {number: partial(_compute_unless, stop, task) for number, task in batch.items()}
                _over_dask(get, functions, lambda _, result: sink(result), pool=pool)
        except BaseException:
            stop.set()  # tasks that have not begun return at once
            raise
        finally:
            pool.shutdown(wait=not stop.is_set(), cancel_futures=True)


class Processes:
    """Processes of this machine, for code that holds Python's lock; one that dies is replaced."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._context = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang
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
        from dask.multiprocessing import get

        group = self._group = self._group or ProcessGroup(self.workers, self._context)
        waiting: dict[int, Task] = {}

        def done(number: int, result: TaskResult) -> None:
            del waiting[number]
            if stop.is_set():
                group.halt.set()
            sink(result)

        try:
            for waiting in _batches(tasks, _BATCH * self.workers):
                losses = 0
                while waiting and not stop.is_set():
                    first = next(iter(waiting))
                    alone = losses > _MAX_LOSSES
                    selected = [first] if alone else list(waiting)
                    functions = {number: partial(_compute_unless_halted, waiting[number]) for number in selected}
                    try:
                        _over_dask(get, functions, done, pool=group.pool, chunksize=1, optimize_graph=False)
                    except BrokenProcessPool:
                        losses += 1
                        group.end()
                        group = self._group = ProcessGroup(self.workers, self._context)
                        if alone:
                            sink(failed(waiting.pop(first), "the process that computed it died"))
                    else:
                        for number in selected:  # tasks without a result are left to other processes
                            waiting.pop(number, None)
        except BaseException:
            stop.set()
            self.close()
            raise


class ProcessGroup:
    """A pool of processes that end with it, and with this process, however that ends."""

    def __init__(self, workers: int, context: SpawnContext) -> None:
        self.halt = context.Event()  # set when the batch that they work for is to stop
        if multiprocessing.current_process().daemon:
            raise RoughmdrError("scheduler is 'processes', which cannot run inside a daemonic process")
        for _ in range(_MAX_STARTS):
            self.pool = ProcessPoolExecutor(workers, context, _start_worker, (self.halt,))
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
    group = ProcessGroup(workers, multiprocessing.get_context("spawn"))
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


def _over_dask(
    get: Callable[..., Any],
    functions: Mapping[int, Callable[[], TaskResult | None]],
    done: Callable[[int, TaskResult], None],
    **options: Any,
) -> None:
    """Call functions over one of dask's schedulers; ``done`` receives each task result as soon as it is there."""
    # A task without arguments: dask would search them for other tasks, and import dask.array to tell them apart. It
    # begins with the last key.
    keys = {f"task-{len(functions) - index:09d}": number for index, number in enumerate(functions)}
    graph = {key: (functions[number],) for key, number in keys.items()}

    def posttask(key: str, result: TaskResult | None, _graph: object, state: dict[str, Any], _worker: object) -> None:
        state["cache"][key] = None  # else all results of a batch are in memory
        if result is not None:
            done(keys[key], result)

    # As an argument, since what dask.callbacks registers is shared by all threads.
    get(graph, list(graph), callbacks=[(None, None, None, posttask, None)], **options)


def _batches(tasks: Iterable[Task], size: int) -> Iterator[dict[int, Task]]:
    """Yield tasks by their numbers, ``size`` at a time."""
    numbered = enumerate(tasks)
    while batch := dict(islice(numbered, size)):
        yield batch


def _compute_unless(stop: threading.Event | Event, task: Task) -> TaskResult | None:
    return None if stop.is_set() else compute(task)


_halt: Event | None = None  # set when the batch that a worker process works for is to stop


def _start_worker(halt: Event) -> None:
    """Make a worker process leave signals to its parent, and end when that does."""
    global _halt  # noqa: PLW0603 - the arguments of an initializer have no other place
    _halt = halt
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _compute_unless_halted(task: Task) -> TaskResult | None:
    return None if _halt is not None and _halt.is_set() else compute(task)
