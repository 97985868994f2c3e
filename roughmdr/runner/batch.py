"""A plan while it is carried out: round after round of tasks, stored as they finish, assembled at the end."""

import shutil
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.batch.collect import Collector
from roughmdr.batch.costs import ensemble_bytes, file_bytes, result_bytes
from roughmdr.batch.foresee import check_foreseen
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.find import ReusableRows, check_no_less, find_previous, is_finished, reuse
from roughmdr.batch.resume.share import Share
from roughmdr.batch.resume.writer import BETWEEN_LOOKS, CheckpointWriter, Together, WrittenElsewhereError
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import RunRange, Task, first_error, prepare_all, split_into_tasks
from roughmdr.errors import RoughmdrError, StoreError, Unfinished
from roughmdr.numerics.compiling import compiling
from roughmdr.result.assemble import assemble, curves_so_far
from roughmdr.runner.backend import Backend, Cluster
from roughmdr.runner.local import Pool, Serial, Sink, Threads
from roughmdr.runner.progress import Progress, progress, tell_compiling
from roughmdr.runner.signals import Interrupted, interruptible
from roughmdr.storage.files import NETCDF_ENDINGS, ZARR_ENDING, check_ending, check_writable, destination
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.memory import check_memory, describe_available_memory
from roughmdr.storage.room import Room
from roughmdr.storage.zarr_store import check_package
from roughmdr.variables import FAILED

_COPIES = 3  # copies of large curves on the disk: task results, in their places, the result; as they came, [accuracy]


class Beginning(NamedTuple):
    """The begin of a batch: the folder that its output has to itself, and all that earlier runs have left."""

    plan: Plan
    rounds: Rounds
    writer: CheckpointWriter
    reusable: ReusableRows
    old: Labelled | None
    """The result that is at the output."""
    finished: bool
    """Whether that is just what is asked for."""


@contextmanager
def begun(plan: Plan, target: Path | None, share: Share | None = None, *, resume: bool) -> Iterator[Beginning]:
    """Begin the batch of a plan, or a ``share`` of it beside the target.

    StoreError for a bad target, or where there are results that cannot be reused.
    """
    if target is not None:
        check_writable(target, plan.scene.inputs, as_zarr=target.suffix.lower() == ZARR_ENDING)
        if check_ending(target, "result", (*NETCDF_ENDINGS, ZARR_ENDING)) == ZARR_ENDING:
            check_package(target)
        target = destination(target)
    rounds, own = Rounds(plan), target if target is None or share is None else share.beside(target)
    with ExitStack() as stack:
        joins = plan.scene.toml if resume and share is None else ""
        writer = CheckpointWriter(own, stack, of_share=share is not None, joins=joins)
        reusable = ReusableRows(rounds.keys, computed_variables(plan), keep_moments=plan.keeps_statistics)
        old: Labelled | None = None
        finished = False
        if own is not None and resume:
            old = None if share is not None or writer.may_replace(plan.scene.toml) else find_previous(own)
            finished = old is not None and is_finished(old, plan, rounds.keys)
            if not finished:
                reuse(own, old, writer.store, plan, reusable)
            elif old is not None and writer.store is not None and writer.store.scene in ("", old.attrs["scene"]):
                writer.store.clear()  # the run that wrote the result was killed before it could
        yield Beginning(plan, rounds, writer, reusable, old, finished)


@contextmanager
def at_work(
    beginning: Beginning, backend: Backend, command: str, *, resume: bool, quiet: bool, assembled: bool = True
) -> Iterator["Batch"]:
    """Open the pool that computes a batch, whose result is ``assembled``, or a part of it; ``command`` goes into the
    file's history.

    StoreError, before computing, for too little memory; Unfinished where the batch cannot go on.
    """
    plan, writer = beginning.plan, beginning.writer
    backend = backend.for_runs_of(plan)
    with compiling(lambda: tell_compiling(plan.scene.title, quiet=quiet)):
        check_foreseen(plan)
        runs = sum(method.realizations for method in beginning.rounds.methods)  # runs in the first round
        if assembled:
            remedy = "fewer steps or realizations, or output.keep = 'statistics', take less"
            needed = (_COPIES + (plan.scene.accuracy is not None)) * file_bytes(plan, runs)
            on_disk = writer.target is not None and shutil.disk_usage(writer.target.parent).free > needed
            check_memory(result_bytes(plan, runs, on_disk=on_disk), "the run", remedy)
        if backend.is_local:
            asperities = min(backend.workers, runs) * ensemble_bytes(plan)
            check_memory(asperities, "the asperities of the runs in progress", "fewer asperities or workers take less")
        try:
            with backend.pool() as pool:
                if not resume:
                    writer.clear()
                yield Batch(beginning, pool, backend.runs_per_task, command)
        except (StoreError, MemoryError) as error:
            message = str(error) or f"out of memory, with {describe_available_memory()}"
            if writer.saved_message:
                raise Unfinished(f"{message}; {writer.saved_message}") from None
            if isinstance(error, MemoryError):
                raise Unfinished(message) from None
            raise


def computed_variables(plan: Plan) -> tuple[str, ...]:
    """Return the variables that are computed: those asked for, and those of an error asked for and of a pull-off."""
    of_error = [] if plan.scene.accuracy is None else [plan.watched]
    of_pull_off = ["force"] if plan.control == "separation" and plan.unloads else []
    return tuple(dict.fromkeys([*plan.variables, *of_error, *of_pull_off]))


class Batch:
    """The runs of a plan, and the pool that computes them."""

    def __init__(self, beginning: Beginning, pool: Pool, runs_per_task: int | None, command: str) -> None:
        self._pool, self._runs_per_task, self._command = pool, runs_per_task, command
        self._plan, self._rounds, self._writer, self._reusable, self._old, _ = beginning
        plan = self._plan
        watched = None if plan.scene.accuracy is None else plan.watched
        self._variables = computed_variables(plan)
        self._together = Together(self._writer, plan, self._rounds.keys)
        room = Room(None if self._writer.target is None else self._writer.target.parent)
        self._collector = Collector(
            self._variables, plan.steps, room, keep_moments=plan.keeps_statistics, watched=watched
        )

    def run(self, *, quiet: bool) -> Labelled:
        """Run all rounds; return the result, whose history continues that of the one that it may replace."""
        if self._plan.scene.accuracy is None and not self._plan.keeps_statistics:
            self._collector.expect([(method.key, method.realizations) for method in self._rounds.methods])
        with interruptible(lambda: self._writer.begun, self._saved_message) as stop:
            if self._writer.store is not None and not self._writer.store.alone:
                self._writer.begin(self._plan.scene.toml, self._command)
            with progress(self._plan.scene.title, quiet=quiet) as display:
                try:
                    self._run_rounds(display, stop)
                except WrittenElsewhereError as written:
                    display.add(total=display.done - display.total)
                    for store in self._writer.joined:
                        store.clear()
                    return written.result
            if stop.is_set():
                raise Interrupted(f"interrupted; {self._saved_message()}")
            return self._finish()

    def _run_rounds(self, display: Progress, stop: threading.Event) -> None:
        """Run all rounds; WrittenElsewhereError where another process has written the result."""
        try:
            ranges = self._rounds.begin()
            while ranges:
                self._round(ranges, display, stop, lambda result: self._writer.placed(self._collector.add(result)))
                ranges = self._rounds.next(self._collector)
            self._together.await_turn(stop)
        except StoreError:  # perhaps since all that led to the result is removed
            self._together.check()
            raise

    def keep(self, ranges: Sequence[RunRange], *, quiet: bool) -> list[str]:
        """Compute some of the runs of the first round, and keep them beside the output; return why runs failed."""
        failures = list[str]()

        def note(result: TaskResult) -> None:
            failed = result.diagnostics["status"] == FAILED
            failures.extend(map(str, result.diagnostics["remark"][failed]))

        with interruptible(lambda: self._writer.begun, self._saved_message) as stop:
            self._writer.begin(self._plan.scene.toml, self._command)
            with progress(self._plan.scene.title, quiet=quiet) as display:
                self._round(ranges, display, stop, note)
            self._writer.flush()
        if not failures and self._writer.store is not None:
            self._writer.store.note_complete()
        return failures

    def _finish(self) -> Labelled:
        """Assemble the result and write it."""
        methods = self._rounds.methods
        cells = [(method.key, method.realizations) for method in methods]
        collected = self._collector.collected(cells)
        failed = collected.diagnostics["status"] == FAILED
        if self._collector.none_done:
            error = first_error(str(collected.diagnostics["remark"][failed][0]))
            name = self._plan.name_of(int(np.argwhere(failed)[0, 0]))
            raise (type(error) if isinstance(error, RoughmdrError) else Unfinished)(f"{name}: {error}")
        result = assemble(self._plan, methods, collected, self._variables, self._command)
        if self._old is not None:
            result.attrs["history"] += f"\n{self._old.attrs['history']}"
            check_no_less(self._writer.target, self._old, result, self._rounds.keys)
        self._writer.finish(result, complete=not (failed.any() or self._reusable.has_unused(cells)))
        return result

    def _saved_message(self) -> str:
        return self._writer.saved_message or "nothing was written"

    def _round(self, ranges: Sequence[RunRange], display: Progress, stop: threading.Event, take: Sink) -> None:
        """Reuse what there is, compute what is missing, wait for what other processes compute."""
        missing, told = self._reused(ranges, display, take, counted=0), False
        while missing:
            tasks = split_into_tasks(self._plan, missing, self._variables, self._pool.workers, self._runs_per_task)
            undone = self._computed(tasks, display, stop, take)
            if stop.is_set():
                self._writer.flush()
                raise Interrupted(f"interrupted; {self._saved_message()}")
            others = [runs for task in undone for runs in task.ranges]
            missing = self._reused(others, display, take, counted=_count(others))
            if missing and len(undone) == len(tasks):
                if not told:
                    count = _count(missing)
                    display.tell(f"waits for {count} run{'s' * (count > 1)} that another process computes")
                told = True
                stop.wait(BETWEEN_LOOKS)

    def _reused(self, ranges: Sequence[RunRange], display: Progress, take: Sink, *, counted: int) -> list[RunRange]:
        """Take those runs that there are by now; return the others. So many were ``counted`` as runs to be done."""
        selected: list[tuple[int, int]] = []
        self._together.look(self._reusable)
        missing = self._reusable.missing(ranges, selected)
        display.add(total=_count(missing) - counted)
        for result in self._reusable.read(selected):
            take(result)
            display.add(reused=result.realizations)
        if missing:
            self._together.check()
        return missing

    def _computed(self, tasks: Sequence[Task], display: Progress, stop: threading.Event, take: Sink) -> list[Task]:
        """Compute tasks; return those that are left to other processes."""
        undone = {(task.ranges[0].key, task.ranges[0].first): task for task in tasks}
        on_cluster = isinstance(self._pool, Cluster)
        if len(tasks) > 1:
            self._writer.begin(self._plan.scene.toml, self._command)
            if places := self._collector.places:
                data = curves_so_far(self._plan, places, self._variables)
                self._writer.grow(data, places.diagnostics["status"])
        if not on_cluster:
            prepare_all(self._plan, [runs for task in tasks for runs in task.ranges])
        pool = Serial() if len(tasks) == 1 and isinstance(self._pool, Threads) else self._pool

        def sink(result: TaskResult) -> None:
            for cell, first in zip(result.cell.tolist(), result.first.tolist(), strict=True):
                undone.pop((result.keys[cell], first), None)
            self._writer.put(result)
            take(result)
            display.add(done=result.realizations)

        # Workers of a cluster outlive the batch, and would keep their claims.
        pool.compute(self._together.claimed(tasks, by_workers=not on_cluster), stop, sink)
        return list(undone.values())


def _count(ranges: Sequence[RunRange]) -> int:
    """Return the number of runs."""
    return sum(runs.last - runs.first for runs in ranges)
