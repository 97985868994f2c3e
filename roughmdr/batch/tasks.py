"""Tasks: which runs are computed together, what is compiled for them, and how a worker computes them."""

import math
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr import errors
from roughmdr.aggregate import LoadingPath, LoadSeparation, prepare
from roughmdr.batch.costs import seconds
from roughmdr.batch.moments import KnownMoments, Moments, MomentTree
from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.realization import simulate_realization
from roughmdr.batch.resume.keys import check_versions, versions
from roughmdr.batch.resume.locks import claims_in
from roughmdr.batch.resume.manifest import Runs
from roughmdr.batch.task_result import ResultRow, Row, TaskResult, merge_rows, row_of
from roughmdr.errors import RoughmdrError
from roughmdr.loading.pull_off import PullOff
from roughmdr.scene import Scene
from roughmdr.storage.room import IN_MEMORY
from roughmdr.variables import ADHESION_CODES, DONE, FAILED, RUN_DIAGNOSTICS

_SINGLE_TASK = 0.1  # a batch that takes less [s] is one task: to load dask takes as long
_MIN_SECONDS, _USUAL_SECONDS, _MAX_SECONDS = 0.05, 0.1, 3.0  # run time of a task [s]
_MANY = 4000  # number of tasks from which each may take longer than usual
_TASKS_PER_WORKER = 8  # least number of tasks for each worker, so that all workers finish together
_MAX_BYTES = 2**24  # size of the curves of a task [byte], if it has more than one


class RunRange(NamedTuple):
    """Realisations first ... last - 1 of a cell, and all that it takes to compute them."""

    key: str
    cell: Cell
    estimator: str
    first: int
    last: int


class Task(NamedTuple):
    """Runs that a worker computes in one go."""

    ranges: tuple[RunRange, ...]
    variables: tuple[str, ...]
    keep_moments: bool  # whether moments are kept, not curves
    versions: str
    claimed_in: Path | None = None  # folder in which the runs are claimed from other processes before

    @property
    def runs(self) -> list[Runs]:
        """All runs, as they are claimed."""
        return [Runs(each.key, each.first, each.last) for each in self.ranges]

    def result_of(self, rows: Sequence[ResultRow]) -> TaskResult:
        """Make the result of rows, whose cells are indices of the ranges."""
        return TaskResult.of([runs.key for runs in self.ranges], self.variables, rows, self.ranges[0].cell.steps)


def split_into_tasks(
    plan: Plan, ranges: Sequence[RunRange], variables: Sequence[str], workers: int, runs_per_task: int | None = None
) -> list[Task]:
    """Split runs, in their order, into tasks of about the same duration, or of ``runs_per_task`` runs each."""
    if runs_per_task is None:
        costs = [seconds(runs.cell, runs.estimator) for runs in ranges]
        total = sum(cost * (runs.last - runs.first) for cost, runs in zip(costs, ranges, strict=True))
        usual = max(_USUAL_SECONDS, min(total / _MANY, _MAX_SECONDS))
        size = max(_MIN_SECONDS, min(total / (_TASKS_PER_WORKER * workers), usual))
        size = size if total > _SINGLE_TASK else math.inf
    else:
        costs, size = [1.0] * len(ranges), float(runs_per_task)
    curve_bytes = 8 * len(variables) * plan.steps
    most = IN_MEMORY if size == math.inf else _MAX_BYTES
    max_runs = 2**62 if plan.keeps_statistics else max(1, most // curve_bytes)
    groups: list[list[RunRange]] = [[]]
    filled, count = 0.0, 0
    for cost, runs in zip(costs, ranges, strict=True):
        first = runs.first
        while first < runs.last:
            if filled >= size or count >= max_runs:
                groups.append([])
                filled, count = 0.0, 0
            fitting = math.ceil(min((size - filled) / cost, runs.last - first))
            added = min(max(fitting, 1), max_runs - count)
            groups[-1].append(runs._replace(first=first, last=first + added))
            first, filled, count = first + added, filled + added * cost, count + added
    return [Task(tuple(group), tuple(variables), plan.keeps_statistics, versions()) for group in groups if group]


def prepare_all(plan: Plan, ranges: Iterable[RunRange]) -> None:
    """Compile what these runs of a plan need, before several threads or a clock need it, and nothing else."""
    prepared: set[tuple[object, ...]] = set()
    variables = plan.scene.output.variables
    for stage in reversed(plan.scene.stages):
        variables = stage.inner_variables(variables)
    for cell, estimator in ((runs.cell, runs.estimator) for runs in ranges):
        scene, path = cell.scene, cell.path
        adhesion, asperities = scene.adhesion_model, scene.asperities
        if replacing := [stage for stage in scene.stages if stage.replaces_contacts]:
            replacing[0].prepare(scene, drawn=estimator != "expected")
            continue
        shape, draws = asperities.shape_name, estimator != "expected"
        kind = shape, adhesion.work > 0.0, adhesion.candidates, adhesion.tabor_known, draws, scene.needs_positions
        if kind in prepared:
            continue
        prepared.add(kind)
        if draws or scene.material.hardness is not None:
            prepare(shape, adhesion, scene.interaction, variables, unload=plan.unloads)
        if draws:
            continue
        from roughmdr import expected

        one = LoadingPath.along(path.separation[:1], unload=False, adhesive=scene.work > 0.0)
        modulus = scene.effective_modulus
        with suppress(RoughmdrError):  # the run itself will report it
            expected.prepare(asperities, one, effective_modulus=modulus, adhesion=adhesion, variables=variables)


def compute(task: Task) -> TaskResult | None:
    """Compute a task, unless another process does; a run that cannot be computed is marked as failed, and its remark
    says why.
    """
    check_versions(task.versions)
    if task.claimed_in is not None and not claims_in(task.claimed_in).take(task.runs):
        return None
    rows: list[ResultRow] = []
    for number, runs in enumerate(task.ranges):
        each = (_run(runs, realization, task.variables) for realization in range(runs.first, runs.last))
        rows += [row._replace(cell=number) for row in (_merged(each) if task.keep_moments else each)]
    return task.result_of(rows)


def _merged(rows: Iterable[ResultRow]) -> Iterator[ResultRow]:
    """Yield blocks of merged realisations; those that fail stand alone."""
    tree, pull_offs, diagnostics = MomentTree[Moments](), MomentTree[KnownMoments](), dict[int, Row]()
    for row in rows:
        if row.diagnostics["status"] == FAILED:
            yield row
        else:
            tree.add(row.first, row.moments)
            pull_offs.add(row.first, row.pull_off)
            diagnostics[row.first] = row.diagnostics
    for first, moments in tree.blocks.items():
        merged = merge_rows([diagnostics[realization] for realization in range(first, first + moments.size)])
        yield ResultRow(0, first, moments, pull_offs.blocks[first], merged)


def _run(runs: RunRange, realization: int, names: Sequence[str]) -> ResultRow:
    """Compute one realisation."""
    scene, started = runs.cell.scene, time.perf_counter()
    try:
        result = simulate_realization(scene, runs.cell.controlled, realization, list(names), runs.estimator)
        values, pull_off = np.array([result.variables[name] for name in names]), result.pull_off
        known = {"status": DONE, **diagnostics_of(result, scene)}
    except Exception as error:  # whatever it is, the other runs go on
        values, pull_off = np.full((len(names), runs.cell.steps), math.nan), PullOff()
        remark = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        known = {"status": FAILED, "remark": remark}
    diagnostics = row_of(run_time=time.perf_counter() - started, **known)
    return ResultRow(0, realization, Moments.of(values), KnownMoments.of(np.array(pull_off)), diagnostics)


def diagnostics_of(result: LoadSeparation, scene: Scene) -> dict[str, object]:
    """Return the diagnostics of a realisation that its result tells, by their names in ``RUN_DIAGNOSTICS``."""
    return {
        **{name: value for name, value in result._asdict().items() if name in RUN_DIAGNOSTICS},
        **result.model_error.named,
        **result.yielding(),
        "edge_slope": result.extremes.slope,
        "profile_extent": result.extremes.extent,
        "tabor_number": result.tabor if result.tabor < math.inf else math.nan,
        "adhesion_law": ADHESION_CODES.index(result.model if scene.work > 0.0 else "none"),
        "remark": "\n".join(result.warnings),
    }


def failed(task: Task, remark: str) -> TaskResult:
    """Return the result of a task that could not be computed at all."""
    moments = Moments.of(np.full((len(task.variables), task.ranges[0].cell.steps), math.nan))
    pull_off, diagnostics = KnownMoments.of(np.array(PullOff())), row_of(run_time=0.0, status=FAILED, remark=remark)
    runs = [(number, each) for number, runs in enumerate(task.ranges) for each in range(runs.first, runs.last)]
    return task.result_of([ResultRow(*run, moments, pull_off, diagnostics) for run in runs])


def first_error(remark: str) -> Exception:
    """Return the error that the remark of a failed run tells, to be raised again."""
    name, _, message = remark.partition(": ")
    kind = getattr(errors, name, None)
    return kind(message) if isinstance(kind, type) and issubclass(kind, RoughmdrError) else RuntimeError(remark)
