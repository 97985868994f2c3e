"""The batch: a plan's tasks over dask's threads, the results into one dataset. The only file that knows dask."""

import time
import warnings
from functools import partial, reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.errors import LimitWarning, RoughmdrError
from roughmdr.labelled import Labelled
from roughmdr.limits import Extremes
from roughmdr.plan import Plan, law_of, make_plan, prepare_all
from roughmdr.progress import Advance, progress
from roughmdr.result import LAWS, assemble
from roughmdr.scene import Scene, read
from roughmdr.store import check_writable, write

if TYPE_CHECKING:
    import xarray as xr


class Shard(NamedTuple):
    """The results of one task: each array begins with the task's runs."""

    variables: dict[str, Floats]
    run_time: Floats
    numerical_error: Floats
    tabor: Floats
    adhesion_law: Floats
    """Numbers as in ``result.LAWS``."""
    extremes: list[Extremes]
    doubts: list[str]
    """What makes the ensembles doubtful."""


def run(
    scene: str | Path | dict[str, Any] | Scene,
    out: str | Path | None = None,
    workers: int = 2,
    scheduler: Literal["threads"] = "threads",
    *,
    quiet: bool = True,
) -> "xr.Dataset":
    """Compute a scene; with ``out``, write the result there as netCDF when all of it is done.

    scene is the path of a TOML file, a dictionary of the same form, or a Scene; ``workers`` is the number of threads.
    The result lies over the swept keys, realization and step and does not depend on ``workers``, to the last bit.
    ``quiet`` leaves out the progress display. SceneError, OutOfRange or StoreError say what is wrong before anything
    is written.
    """
    if scheduler != "threads":
        raise RoughmdrError(f"scheduler is {scheduler!r}; it must be 'threads'")
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
        raise RoughmdrError(f"workers is {workers!r}; it must be a whole number of at least 1")
    target = None if out is None else Path(out)
    result = execute(make_plan(read(scene)), target, workers=workers, quiet=quiet)
    for text in result.attrs.get("warnings", "").splitlines():
        warnings.warn(text, LimitWarning, stacklevel=2)
    return result.to_xarray()


def execute(plan: Plan, target: Path | None, *, workers: int, quiet: bool, command: str = "roughmdr.run") -> Labelled:
    """Do what a plan says; ``command`` goes into the file's history. StoreError, before computing, for a bad target."""
    if target is not None:
        check_writable(target, plan.scene.inputs)
    prepare_all(plan)
    with progress(plan.scene.title, plan.runs, quiet=quiet) as advance:
        shards = _over_threads(plan, workers, advance) if len(plan.tasks) > 1 else _here(plan, advance)
    variables = {
        name: np.concatenate([shard.variables.pop(name) for shard in shards]) for name in plan.scene.output.variables
    }
    beside = {
        name: np.concatenate([getattr(shard, name) for shard in shards])
        for name in ("run_time", "numerical_error", "tabor", "adhesion_law")
    }
    extremes = reduce(Extremes.joined, (each for shard in shards for each in shard.extremes))
    doubts = dict.fromkeys(text for shard in shards for text in shard.doubts)
    result = assemble(plan, variables, [*doubts, *extremes.warnings], command, **beside)
    if target is not None:
        write(result, target)
    return result


def _here(plan: Plan, advance: Advance) -> list[Shard]:
    shards = []
    for runs in plan.tasks:
        shards.append(compute_shard(plan, runs))
        advance(len(runs))
    return shards


def _over_threads(plan: Plan, workers: int, advance: Advance) -> list[Shard]:
    from dask.callbacks import Callback
    from dask.threaded import get

    # A task without arguments: dask would search them for other tasks, and import dask.array to tell them apart.
    keys = [f"shard-{number}" for number in range(len(plan.tasks))]
    graph = {key: (partial(compute_shard, plan, runs),) for key, runs in zip(keys, plan.tasks, strict=True)}

    def done(key: object, result: object, *_: object) -> None:
        if isinstance(result, Shard):
            advance(len(result.run_time))

    with Callback(posttask=done):
        return list(get(graph, keys, num_workers=workers))


def compute_shard(plan: Plan, runs: range) -> Shard:
    """The law of each of the given runs."""
    names, steps = plan.scene.output.variables, plan.cells[0].route.separation.size
    run_time, error, tabor, law = np.empty((4, len(runs)))
    shard = Shard({name: np.empty((len(runs), steps)) for name in names}, run_time, error, tabor, law, [], [])
    for row, number in enumerate(runs):
        (scene, route), realization = plan.run(number)
        started = time.perf_counter()
        try:
            result = law_of(scene, route, realization, names)
        except RoughmdrError as error:
            raise type(error)(f"{plan.name_of(number)}: {error}") from None
        for name in names:
            shard.variables[name][row] = result.variables[name]
        shard.numerical_error[row] = result.numerical_error
        shard.tabor[row] = result.tabor
        shard.adhesion_law[row] = LAWS.index(result.model if scene.work > 0.0 else "none")
        shard.extremes.append(result.extremes)
        shard.doubts.extend(result.doubts)
        shard.run_time[row] = time.perf_counter() - started
    return shard
