"""Runs a plan: round after round of tasks, stored as they finish, assembled at the end."""

import threading
import warnings
from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.batch.choose import plan_scene
from roughmdr.batch.collect import Collector
from roughmdr.batch.costs import ensemble_bytes, result_bytes
from roughmdr.batch.foresee import check_foreseen
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.find import check_no_less, find_previous, is_finished, reuse
from roughmdr.batch.resume.reusable import ReusableRows
from roughmdr.batch.resume.writer import CheckpointWriter
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import RunRange, first_error, prepare_all, split_into_tasks
from roughmdr.errors import FailedRuns, RoughmdrError, StoreError, Unfinished, level_outside, warn_limits
from roughmdr.numerics.compiling import compiling
from roughmdr.result.assemble import assemble
from roughmdr.runner.backend import Backend
from roughmdr.runner.cluster import Cluster
from roughmdr.runner.local import Pool, Serial, Threads
from roughmdr.runner.progress import Progress, progress, tell_compiling
from roughmdr.runner.signals import Interrupted, interruptible
from roughmdr.scene import Scene, read
from roughmdr.schema.keywords import named_keywords
from roughmdr.storage.files import NETCDF_ENDINGS, check_ending, check_writable, destination
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.memory import check_memory, describe_available_memory
from roughmdr.variables import FAILED

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

_FORCE = "force"


@named_keywords
def run(
    scene: str | Path | dict[str, Any] | Scene,
    out: str | Path | None = None,
    workers: int = 2,
    scheduler: "str | Client" = "threads",
    resume: bool = True,
    *,
    set: dict[str, Any] | None = None,  # noqa: A002 - as --set
    derivatives: str | Iterable[str] = (),
    quiet: bool = True,
) -> "xr.Dataset":
    """Compute a scene; with ``out``, write the result there as netCDF when all of it is done.

    Parameters
    ----------
    scene : path, dict or Scene
        A TOML file, a dictionary of the same form, or a Scene that was read.
    out : path, optional
        The result file. While the batch runs, what is finished is kept in ``OUT.parts``.
    workers : int
        Number of threads or processes.
    scheduler : str or distributed.Client
        "threads", "processes", or a dask cluster: its address, ``tcp://HOST:PORT`` or ``tls://HOST:PORT``, or a Client.
    resume : bool
        Whether what ``out`` holds, or an earlier run kept beside it, is reused; else it is replaced.
    set : dict, optional
        Keys of the scene, dotted, with the values that they get, as in ``{"adhesion.work": "10 mJ/m^2"}``. A key that
        is set is no longer swept; names of files are relative to the current folder.
    derivatives : iterable of str, optional
        Keys of numbers of the scene, as ``output.derivatives`` has them: of an expected law the result then holds
        ``force_derivative`` and so on, with ``force_derivative_error``, over ``parameter``.
    quiet : bool
        Leave out the progress display.

    Returns
    -------
    xarray.Dataset
        Over the swept keys, ``realization`` and ``step``; the same to the last bit for any workers and scheduler.

    Raises
    ------
    SceneError, OutOfRange, StoreError
        Before anything is written, where the scene or ``out`` is wrong; where no run can be computed, the error of the
        first. Single runs that cannot be computed are marked, and a FailedRuns warning tells of them.
    Unfinished, KeyboardInterrupt
        The batch could not go on; what is done is kept beside ``out``.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "Sixteen surfaces", "seed": 1,
    ...     "material": {"effective_modulus": "1 GPa"},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 50, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ...     "path": {"separation": ["3 um", "1 um", "0 um"]},
    ...     "batch": {"realizations": 16},
    ... })
    >>> dict(result.force.sizes)
    {'realization': 16, 'step': 3}

    A scene file with another work of adhesion: ``rm.run("scene.toml", set={"adhesion.work": "10 mJ/m^2"})``.
    """
    target = None if out is None else Path(out)
    keys = [derivatives] if isinstance(derivatives, str) else list(derivatives)
    plan = plan_scene(read(scene, {**(set or {}), **({"output.derivatives": keys} if keys else {})}))
    result = execute(plan, target, Backend(scheduler, workers), resume=resume, quiet=quiet)
    warn_limits(result.attrs.get("warnings", "").splitlines())
    status = result.variables["status"].values
    if (status == FAILED).any():
        warnings.warn(
            f"{int((status == FAILED).sum())} of {status.size} failed, see remark",
            FailedRuns,
            stacklevel=level_outside(),
        )
    return result.to_xarray()


def execute(
    plan: Plan,
    target: Path | None,
    backend: Backend = Backend(),
    *,
    resume: bool = True,
    quiet: bool = True,
    command: str = "roughmdr.run",
) -> Labelled:
    """Carry out a plan; ``command`` goes into the file's history.

    StoreError, before computing, for a bad target or too little memory.
    """
    backend.check()
    if target is not None:
        check_writable(target, plan.scene.inputs)
        check_ending(target, "result", NETCDF_ENDINGS)
        target = destination(target)
    rounds = Rounds(plan)
    with ExitStack() as stack:
        writer = CheckpointWriter(target, stack)
        reusable = ReusableRows(rounds.keys, _computed_variables(plan), keep_moments=plan.keeps_statistics)
        old: Labelled | None = None
        if target is not None and resume:
            old = None if writer.may_replace(plan.scene.toml) else find_previous(target)
            if old is not None and is_finished(old, plan, rounds.keys):
                if writer.store is not None and writer.store.scene in ("", old.attrs["scene"]):
                    writer.store.clear()  # the run that wrote the result was killed before it could
                return old
            reuse(target, old, writer.store, plan, reusable)
        stack.enter_context(compiling(lambda: tell_compiling(plan.scene.title, quiet=quiet)))
        check_foreseen(plan)
        runs = sum(method.realizations for method in rounds.methods)  # of the first round
        remedy = "fewer steps or realizations, or output.keep = 'statistics', take less"
        check_memory(result_bytes(plan, runs), "the run", remedy)
        if backend.is_local:
            asperities = min(backend.workers, runs) * ensemble_bytes(plan)
            check_memory(asperities, "the asperities of the runs in progress", "fewer asperities or workers take less")
        try:
            with backend.pool() as pool:
                if not resume:
                    writer.clear()
                batch = _Batch(plan, rounds, writer, reusable, pool, backend.runs_per_task, command)
                return batch.run(old, quiet=quiet)
        except (StoreError, MemoryError) as error:
            message = str(error) or f"out of memory, with {describe_available_memory()}"
            if writer.saved_message:
                raise Unfinished(f"{message}; {writer.saved_message}") from None
            if isinstance(error, MemoryError):
                raise Unfinished(message) from None
            raise


def _computed_variables(plan: Plan) -> tuple[str, ...]:
    """Return the variables that are computed: those asked for, and those of an error asked for and of a pull-off."""
    of_error = [] if plan.scene.accuracy is None else [plan.watched]
    of_pull_off = [_FORCE] if plan.control == "separation" and plan.unloads else []
    return tuple(dict.fromkeys([*plan.variables, *of_error, *of_pull_off]))


@dataclass
class _Batch:
    """A plan while it is carried out."""

    _plan: Plan
    _rounds: Rounds
    _writer: CheckpointWriter
    _reusable: ReusableRows
    _pool: Pool
    _runs_per_task: int | None
    _command: str

    def __post_init__(self) -> None:
        plan = self._plan
        watched = None if plan.scene.accuracy is None else plan.watched
        self._variables = _computed_variables(plan)
        self._collector = Collector(self._variables, plan.steps, keep_moments=plan.keeps_statistics, watched=watched)

    def run(self, old: Labelled | None, *, quiet: bool) -> Labelled:
        """Run all rounds; return the result, whose history continues that of the ``old`` one that it may replace."""
        with interruptible(lambda: self._writer.begun, self._saved_message) as stop:
            with progress(self._plan.scene.title, quiet=quiet) as display:
                ranges = self._rounds.begin()
                while ranges:
                    self._round(ranges, display, stop)
                    ranges = self._rounds.next(self._collector)
            return self._finish(old)

    def _finish(self, old: Labelled | None) -> Labelled:
        """Assemble the result and write it."""
        methods, none_done = self._rounds.methods, self._collector.none_done
        cells = [(method.key, method.realizations) for method in methods]
        collected = self._collector.collected(cells)
        failed = collected.diagnostics["status"] == FAILED
        if none_done:
            error = first_error(str(collected.diagnostics["remark"][failed][0]))
            name = self._plan.name_of(int(np.argwhere(failed)[0, 0]), 0)
            raise (type(error) if isinstance(error, RoughmdrError) else Unfinished)(f"{name}: {error}")
        result = assemble(self._plan, methods, collected, self._variables, self._command)
        if old is not None:
            result.attrs["history"] += f"\n{old.attrs['history']}"
            check_no_less(self._writer.target, old, result, self._rounds.keys)
        self._writer.finish(result, complete=not (failed.any() or self._reusable.has_unused(cells)))
        return result

    def _saved_message(self) -> str:
        return self._writer.saved_message or "nothing was written"

    def _round(self, ranges: list[RunRange], display: Progress, stop: threading.Event) -> None:
        """Reuse what there is, compute what is missing."""
        selected: list[tuple[int, int]] = []
        missing = [
            runs._replace(first=first, last=last)
            for runs in ranges
            for first, last in self._reusable.select(runs.key, runs.first, runs.last, selected)
        ]
        for result in self._reusable.read(selected):
            self._collector.add(result)
            display.add(reused=result.realizations)
        tasks = split_into_tasks(self._plan, missing, self._variables, self._pool.workers, self._runs_per_task)
        if not tasks:
            return
        display.add(total=sum(runs.last - runs.first for runs in missing))
        if not isinstance(self._pool, Cluster):
            prepare_all(self._plan, missing)
        if len(tasks) > 1:
            self._writer.begin(self._plan.scene.toml, self._command)
        pool = Serial() if len(tasks) == 1 and isinstance(self._pool, Threads) else self._pool

        def sink(result: TaskResult) -> None:
            self._writer.put(result)
            self._collector.add(result)
            display.add(done=result.realizations)

        pool.compute(tasks, stop, sink)
        if stop.is_set():
            self._writer.flush()
            raise Interrupted(f"interrupted; {self._saved_message()}")
