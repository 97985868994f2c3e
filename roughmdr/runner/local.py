"""Tasks on this machine: here, over dask's threads, or over processes."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from itertools import islice
from multiprocessing.context import SpawnContext
from multiprocessing.synchronize import Event
from typing import Any, Protocol

from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import Task, compute, failed
from roughmdr.errors import RoughmdrError

Sink = Callable[[TaskResult], None]
"""Takes a finished shard, in the thread that called."""

_AT_ONCE = 64  # tasks a worker that dask is given at a time: it ends a lot before it begins the next one
_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_STARTS = 3  # how often processes are started before that is given up
_LOSSES = 1  # how often all tasks are tried again when a process died, before each is tried alone


class Pool(Protocol):
    """What computes tasks."""

    @property
    def workers(self) -> int:
        """How many tasks run at a time."""
        ...

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute tasks; when ``stop`` is set those that are under way are finished, and no others begun."""
        ...


class Serial:
    """The thread that calls, for what is over before dask is loaded."""

    workers = 1

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """As in ``Pool``."""
        for task in tasks:
            if not stop.is_set():
                sink(compute(task))


class Threads:
    """Threads of this process: what is compiled lets go of Python's lock."""

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """As in ``Pool``."""
        from dask.threaded import get

        # An own pool: those that dask keeps are dead in a process that was forked from this one.
        pool = ThreadPoolExecutor(self.workers, "roughmdr")
        try:
            for lot in _lots(tasks, _AT_ONCE * self.workers):
                if stop.is_set():
                    return
                functions = {number: partial(_unless, stop, task) for number, task in lot.items()}
                _over_dask(get, functions, lambda _, shard: sink(shard), pool=pool)
        except BaseException:
            stop.set()  # threads that wait for their turn let it pass
            raise
        finally:
            pool.shutdown(wait=not stop.is_set(), cancel_futures=True)


class Processes:
    """Processes of this machine, for what holds Python's lock; one that dies is replaced."""

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """As in ``Pool``; a task whose process dies again and again has failed."""
        context = multiprocessing.get_context("spawn")  # a fork of a process with threads may hang
        halt = context.Event()
        crew = _Crew(self.workers, context, halt)
        try:
            for waiting in _lots(tasks, _AT_ONCE * self.workers):
                losses = 0
                while waiting and not stop.is_set():
                    first = next(iter(waiting))
                    alone = losses > _LOSSES
                    try:
                        _over_processes(crew.pool, [first] if alone else list(waiting), waiting, stop, halt, sink)
                    except BrokenProcessPool:
                        losses += 1
                        crew.end()
                        crew = _Crew(self.workers, context, halt)
                        if alone:
                            sink(failed(waiting.pop(first), "the process that computed it died"))
        except BaseException:
            stop.set()
            raise
        finally:
            halt.set()
            crew.end()


class _Crew:
    """A pool of processes that end when it does, and when this process does, however that ends."""

    def __init__(self, workers: int, context: SpawnContext, halt: Event) -> None:
        if multiprocessing.current_process().daemon:
            raise RoughmdrError("scheduler is 'processes': a daemonic process, as this one is, can start none")
        for _ in range(_STARTS):
            self.pool = ProcessPoolExecutor(workers, context, _begin, (halt,))
            with _deaf():
                # Each is started with the first thing for which no other is idle.
                begun = [self.pool.submit(int) for _ in range(workers)]
            with suppress(BrokenProcessPool):
                for future in begun:
                    future.result()
                return
            self.end()
        raise RoughmdrError(
            "scheduler is 'processes': none can be started; in a script, what is not only defined must stand under "
            "if __name__ == '__main__':"
        )

    def end(self) -> None:
        """End all processes at once, also those that have only just begun; SIGTERM they would not hear."""
        for process in list((self.pool._processes or {}).values()):
            process.kill()
        self.pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def _deaf() -> Iterator[None]:
    """Signals wait; for processes that are started here, from their first moment on."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _over_processes(
    pool: ProcessPoolExecutor,
    chosen: Sequence[int],
    waiting: dict[int, Task],
    stop: threading.Event,
    halt: Event,
    sink: Sink,
) -> None:
    """Compute some of the tasks that are waiting; those that are done wait no longer."""
    from dask.multiprocessing import get

    def done(number: int, shard: TaskResult) -> None:
        del waiting[number]
        if stop.is_set():
            halt.set()
        sink(shard)

    functions = {number: partial(_unless_halted, waiting[number]) for number in chosen}
    _over_dask(get, functions, done, pool=pool, chunksize=1, optimize_graph=False)


def _over_dask(
    get: Callable[..., Any],
    functions: Mapping[int, Callable[[], TaskResult | None]],
    done: Callable[[int, TaskResult], None],
    **options: Any,
) -> None:
    """Call functions over one of dask's schedulers; what each returns goes to ``done`` as soon as it is there."""
    # A task without arguments: dask would search them for other tasks, and import dask.array to tell them apart. It
    # begins with the last key.
    keys = {f"shard-{len(functions) - place:09d}": number for place, number in enumerate(functions)}
    graph = {key: (functions[number],) for key, number in keys.items()}

    def posttask(key: str, result: TaskResult | None, *_: object) -> None:
        if result is not None:
            done(keys[key], result)

    # Handed over, since what dask.callbacks registers is the same for all threads.
    get(graph, list(graph), callbacks=[(None, None, None, posttask, None)], **options)


def _lots(tasks: Iterable[Task], size: int) -> Iterator[dict[int, Task]]:
    """Tasks with their numbers, so many at a time."""
    numbered = enumerate(tasks)
    while lot := dict(islice(numbered, size)):
        yield lot


def _unless(stop: threading.Event, task: Task) -> TaskResult | None:
    return None if stop.is_set() else compute(task)


_halt: Event | None = None
"""Of the batch that a worker process works for."""


def _begin(halt: Event) -> None:
    """Make a worker process one that leaves signals to its parent, and ends when that does."""
    global _halt  # noqa: PLW0603 - what a process is given when it begins has no other place
    _halt = halt
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _unless_halted(task: Task) -> TaskResult | None:
    return None if _halt is not None and _halt.is_set() else compute(task)
