"""From a plan to a result: round after round of tasks, kept as they finish, put together at the end."""

import threading
import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.batch.collect import Collector
from roughmdr.batch.compile import prepare_all
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.resume.find import check_no_less, find_previous, is_finished, reuse
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.reusable import ReusableRows
from roughmdr.batch.resume.writer import CheckpointWriter, checkpointing
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.sizes import held_bytes
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import RunRange, Task, TaskPart, first_error, split_into_tasks
from roughmdr.errors import FailedRuns, LimitWarning, RoughmdrError, StoreError, Unfinished
from roughmdr.result.assemble import assemble
from roughmdr.runner.cluster import Cluster, Tls, connected
from roughmdr.runner.local import Pool, Processes, Serial, Threads
from roughmdr.runner.progress import Progress, progress
from roughmdr.runner.signals import Interrupted, interruptible
from roughmdr.scene import Scene, read
from roughmdr.storage.file_checks import check_writable, destination
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.memory import check_memory, describe_available_memory
from roughmdr.variables import FAILED

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

_LOCAL: dict[str, Callable[[int], Pool]] = {"threads": Threads, "processes": Processes}
_FORCE = "force"
_CLUSTERS = ("tcp://", "tls://")


def run(
    scene: str | Path | dict[str, Any] | Scene,
    out: str | Path | None = None,
    workers: int = 2,
    scheduler: "str | Client" = "threads",
    resume: bool = True,
    *,
    quiet: bool = True,
) -> "xr.Dataset":
    """Compute a scene; with ``out``, write the result there as netCDF when all of it is done.

    scene is the path of a TOML file, a dictionary of the same form, or a Scene. ``scheduler`` is "threads" or
    "processes", of which there are ``workers``, or a dask cluster: its address, or a Client of it. With ``resume``,
    what ``out`` holds or an earlier run kept beside it is used again; else it is replaced. The result lies over the
    swept keys, realization and step and does not depend on workers or scheduler, to the last bit. ``quiet`` leaves out
    the progress display.

    SceneError, OutOfRange or StoreError say what is wrong before anything is written. Runs that cannot be computed are
    marked, and a FailedRuns warning tells of them; where none can, the error of the first is raised. Unfinished and
    KeyboardInterrupt leave what is done beside ``out``.
    """
    target = None if out is None else Path(out)
    plan = make_plan(read(scene))
    result = execute(plan, target, workers=workers, scheduler=scheduler, resume=resume, quiet=quiet)
    for text in result.attrs.get("warnings", "").splitlines():
        warnings.warn(text, LimitWarning, stacklevel=2)
    status = result.variables["status"].values
    if (status == FAILED).any():
        warnings.warn(f"{int((status == FAILED).sum())} of {status.size} failed, see remark", FailedRuns, stacklevel=2)
    return result.to_xarray()


def execute(
    plan: Plan,
    target: Path | None,
    *,
    workers: int = 2,
    scheduler: "str | Client" = "threads",
    resume: bool = True,
    quiet: bool = True,
    command: str = "roughmdr.run",
    tls: Tls | None = None,
) -> Labelled:
    """Do what a plan says; ``command`` goes into the file's history. StoreError, before computing, for a bad target."""
    _check(workers, scheduler)
    if target is not None:
        check_writable(target, plan.scene.inputs)
        target = destination(target)
    rounds = Rounds(plan)
    with checkpointing(target) as keeper:
        held = ReusableRows(rounds.keys, computed(plan), tallied=plan.scene.output.keep == "statistics")
        old: Labelled | None = None
        if target is not None and keeper is not None and resume:
            old = None if keeper.may_replace(plan.scene.toml) else find_previous(target)
            if old is not None and is_finished(old, plan, rounds.keys):
                if keeper.parts is not None and keeper.parts.scene in ("", old.attrs["scene"]):
                    keeper.parts.remove()  # the run that wrote the result was killed before it could
                return old
            reuse(target, old, keeper.parts, plan, held)
        _check_memory(plan, rounds)
        try:
            with _pool(scheduler, workers, tls) as pool:
                if keeper is not None and not resume:
                    keeper.clear()
                return _Batch(plan, rounds, keeper, held, pool, quiet=quiet).run(command, old)
        except (StoreError, MemoryError) as error:
            what = str(error) or f"out of memory, with {describe_available_memory()}"
            if keeper is not None and keeper.said:
                raise Unfinished(f"{what}; {keeper.said}") from None
            if isinstance(error, MemoryError):
                raise Unfinished(what) from None
            raise


def _check(workers: int, scheduler: "str | Client") -> None:
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
        raise RoughmdrError(f"workers is {workers!r}; it must be a whole number of at least 1")
    if isinstance(scheduler, str):
        known = scheduler in _LOCAL or scheduler.startswith(_CLUSTERS)
    else:
        known = type(scheduler).__module__.startswith("distributed.")  # which is not imported to tell
    if not known:
        raise RoughmdrError(
            f"scheduler is {scheduler!r}; it must be 'threads', 'processes', or the address of a dask cluster, "
            "tcp://HOST:PORT or tls://HOST:PORT, or in Python a Client of one"
        )


def _pool(scheduler: "str | Client", workers: int, tls: Tls | None) -> AbstractContextManager[Pool]:
    if not isinstance(scheduler, str):
        return nullcontext(Cluster(scheduler))
    if scheduler in _LOCAL:
        return nullcontext(_LOCAL[scheduler](workers))
    return connected(scheduler, tls)


def computed(plan: Plan) -> tuple[str, ...]:
    """The variables that are computed: those asked for and, where an error is asked for, the force."""
    asked = plan.scene.output.variables
    return tuple(asked if plan.scene.accuracy is None or _FORCE in asked else [*asked, _FORCE])


def _check_memory(plan: Plan, rounds: Rounds) -> None:
    """StoreError, before computing, where this process may not have the memory that the first round takes at least."""
    runs = sum(choice.realizations for choice in rounds.choices)
    check_memory(
        held_bytes(plan, runs), "the run", "fewer steps or realizations, or output.keep = 'statistics', take less"
    )


class _Batch:
    """A plan while it is carried out."""

    def __init__(
        self,
        plan: Plan,
        rounds: Rounds,
        keeper: CheckpointWriter | None,
        held: ReusableRows,
        pool: Pool,
        *,
        quiet: bool,
    ) -> None:
        self._plan, self._rounds, self._keeper, self._held, self._pool = plan, rounds, keeper, held, pool
        self._quiet, self._variables = quiet, computed(plan)
        self._tallied = plan.scene.output.keep == "statistics"
        watched = None if plan.scene.accuracy is None else _FORCE
        steps = plan.cells[0].path.separation.size
        self._gathered = Collector(self._variables, steps, tallied=self._tallied, watched=watched)

    def run(self, command: str, old: Labelled | None) -> Labelled:
        """All rounds; the result, whose history goes on from that of the ``old`` one that it may take the place of."""
        with interruptible(self._begun, self._kept) as stop:
            with progress(self._plan.scene.title, quiet=self._quiet) as display:
                stretches = self._rounds.begin()
                while stretches:
                    self._round(stretches, display, stop)
                    stretches = self._rounds.next(self._gathered)
            return self._finished(command, old)

    def _finished(self, command: str, old: Labelled | None) -> Labelled:
        """The result, put together and written."""
        choices = self._rounds.choices
        nothing = self._gathered.nothing  # asked first: what was gathered is given away then
        found = self._gathered.found([(choice.key, choice.realizations) for choice in choices])
        failed = found.beside["status"] == FAILED
        if nothing:
            cell = int(np.argwhere(failed)[0, 0])
            error = first_error(str(found.beside["remark"][failed][0]))
            name = self._plan.name_of(cell, 0)
            raise (type(error) if isinstance(error, RoughmdrError) else Unfinished)(f"{name}: {error}")
        result = assemble(self._plan, choices, found, self._variables, command)
        if old is not None:
            result.attrs["history"] += f"\n{old.attrs['history']}"
        if self._keeper is not None:
            if old is not None:
                check_no_less(self._keeper.target, old, result, self._rounds.keys)
            spare = self._held.spare([(choice.key, choice.realizations) for choice in choices])
            self._keeper.finish(result, whole=not (failed.any() or spare))
        return result

    def _kept(self) -> str:
        return (self._keeper and self._keeper.said) or "nothing was written"

    def _begun(self) -> bool:
        return self._keeper is not None and self._keeper.begun

    def _round(self, stretches: list[RunRange], display: Progress, stop: threading.Event) -> None:
        """Take what is at hand, compute what is missing."""
        picks: list[tuple[int, int]] = []
        missing = [
            stretch._replace(first=first, last=last)
            for stretch in stretches
            for first, last in self._held.take(self._rounds.key(stretch), stretch.first, stretch.last, picks)
        ]
        for shard in self._held.shards(picks):
            self._gathered.add(shard)
            display.use_again(int(shard.size.sum()))
        tasks = split_into_tasks(self._plan, missing, self._variables, self._pool.workers)
        if not tasks:
            return
        display.expect(sum(last - first for _, first, last, _ in missing))
        if not isinstance(self._pool, Cluster):
            prepare_all(self._plan, missing)
        if len(tasks) > 1 and self._keeper is not None:
            self._keeper.begin(self._plan.scene.toml)
        pool = Serial() if len(tasks) == 1 and isinstance(self._pool, Threads) else self._pool

        def sink(shard: TaskResult) -> None:
            if self._keeper is not None:
                self._keeper.put(shard)
            self._gathered.add(shard)
            display.advance(int(shard.size.sum()))

        pool.compute(map(self._task, tasks), stop, sink)
        if stop.is_set():
            if self._keeper is not None:
                self._keeper.flush()
            raise Interrupted(f"interrupted; {self._kept()}")

    def _task(self, group: list[RunRange]) -> Task:
        parts = (TaskPart(self._rounds.key(stretch), self._plan.cells[stretch.cell], *stretch[1:]) for stretch in group)
        return Task(tuple(parts), self._variables, self._tallied, versions())
