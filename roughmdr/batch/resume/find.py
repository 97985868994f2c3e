"""Finds earlier runs, the result at the output and stored task results, and decides whether they can be reused."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from roughmdr.batch.moments import ROWS as KNOWN_ROWS, KnownMoments
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.keys import changes, versions
from roughmdr.batch.resume.store import CheckpointStore
from roughmdr.batch.task_result import TaskResult, complete
from roughmdr.batch.tasks import RunRange
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Ints
from roughmdr.scene.identity import LAYOUT
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.files import before_of, is_zarr
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_file import read_result
from roughmdr.variables import DONE, FAILED, LAW_VARIABLES, PULL_OFF_NUMBERS, RUN_DIAGNOSTICS

Reader = Callable[[], TaskResult | None]  # reads a task result; None where it is damaged
_MAX_CHANGES = 5  # most changes that a message lists
_AT_ONCE = 2**20  # most numbers of a variable that are copied at a time, 8 MB
_REMEDY = "give another output, or --fresh (resume=False) to replace it"


class ReusableRows:
    """By the keys of the cells. Only where the rows are is in memory; they are read again when they are needed."""

    def __init__(self, keys: Sequence[set[str]], variables: Sequence[str], *, keep_moments: bool) -> None:
        self._keys = set[str]().union(*keys)
        self._variables, self._keep_moments = variables, keep_moments
        self._readers: list[Reader] = []
        self._rows: dict[str, list[tuple[int, int, int, int]]] = {}
        """First realisation, minus their number, so that long rows come first, and number of the reader and row."""
        self._has_more = False

    def matches(self, keys: Sequence[str]) -> bool:
        """Return whether a cell of this run has one of the keys."""
        return not self._keys.isdisjoint(keys)

    def add(self, read: Reader) -> bool | None:
        """Note the rows of a task result; return whether it has cells of this run, in whatever variables.

        None where it cannot be read.
        """
        result = read()
        if result is None:
            return None
        self._has_more |= not self._keys.issuperset(result.keys)
        if not self.matches(result.keys):
            return False
        self._has_more |= not set(self._variables).issuperset(result.variables)
        if self._usable(result) is not None:
            columns = zip(result.cell.tolist(), result.first.tolist(), result.size.tolist(), strict=True)
            for row, (cell, first, size) in enumerate(columns):
                if (key := result.keys[cell]) in self._keys:
                    self._rows.setdefault(key, []).append((first, -size, len(self._readers), row))
            self._readers.append(read)
        return True

    def has_unused(self, cells: Sequence[tuple[str, int]]) -> bool:
        """Return whether there is more than these cells need, each given by its key and number of realisations."""
        return self._has_more or any(
            first - minus_size > count for key, count in cells for first, minus_size, *_ in self._rows.get(key, ())
        )

    def _usable(self, result: TaskResult) -> TaskResult | None:
        single = (result.size == 1).all()
        return result.with_variables(self._variables) if self._keep_moments or single else None

    def missing(self, ranges: Sequence[RunRange], selected: list[tuple[int, int]]) -> list[RunRange]:
        """Return the runs without rows; append the rows of the others to ``selected``."""
        missing = list[RunRange]()
        for runs in ranges:
            first = runs.first
            for begin, minus_size, number, row in sorted(self._rows.get(runs.key, ())):
                if first <= begin and begin - minus_size <= runs.last:
                    missing.append(runs._replace(first=first, last=begin))
                    selected.append((number, row))
                    first = begin - minus_size
            missing.append(runs._replace(first=first))
        return [runs for runs in missing if runs.first < runs.last]

    def read(self, selected: Sequence[tuple[int, int]]) -> Iterator[TaskResult]:
        """Yield the rows that were selected."""
        rows_of: dict[int, list[int]] = {}
        for number, row in selected:
            rows_of.setdefault(number, []).append(row)
        for number, rows in rows_of.items():
            whole = self._readers[number]()
            usable = None if whole is None else self._usable(whole)
            if usable is None:
                raise StoreError("a stored task result has been damaged: is another program at work in its folder?")
            yield usable.select_rows(np.array(rows, dtype=np.int64))


def find_previous(target: Path, *, alone: bool = True) -> Labelled | None:
    """Return the result at ``target``, None where no file is; StoreError where it is no result, or was changed.

    Without other processes at work, ``alone``, a store that was being replaced by a killed one is put back.
    """
    if alone and not target.exists() and is_zarr(before_of(target)):
        before_of(target).rename(target)
    if not target.exists():
        return None
    try:
        old = read_result(target)
    except StoreError as error:
        raise StoreError(f"{error}. It is there already: {_REMEDY}") from None
    if fault := old.integrity_fault():
        raise StoreError(f"{target}: {fault}: {_REMEDY}")
    return old


def is_finished(old: Labelled, plan: Plan, keys: Sequence[set[str]]) -> bool:
    """Return whether a result is just what is asked for; ``keys`` are those that each cell may have."""
    new_scene, old_scene = (parse_toml(text) for text in (plan.scene.toml, old.attrs["scene"]))
    old_keys = _keys(old)
    return (
        all(new_scene.get(part) == old_scene.get(part) for part in LAYOUT)
        and list(new_scene.get("sweep", ())) == list(old_scene.get("sweep", ()))  # the order of its dimensions
        and len(old_keys) == len(keys)
        and all(key in each for key, each in zip(old_keys, keys, strict=True))
        and FAILED not in old.variables["status"].values
    )


def _keys(old: Labelled) -> list[str]:
    return old.coordinates["cell_key"].values.ravel().tolist() if "cell_key" in old.coordinates else []


def reuse(
    target: Path, old: Labelled | None, store: CheckpointStore | None, plan: Plan, reusable: ReusableRows
) -> None:
    """Add what there is of earlier runs to ``reusable``: stored task results, and the curves of a result.

    StoreError, saying what changed, where there are results and none of them can be reused.
    """
    matches, reasons = False, list[str]()
    if store is not None and not store.empty:
        added = [reusable.add(reader) for reader in store.readers()]
        matches = any(added)
        if not matches and any(each is not None for each in added):  # else all are damaged, and nothing is lost
            reasons += _what_changed(store.scene, store.versions, plan)
    if old is not None and reusable.matches(_keys(old)):
        matches = True
        if lost := _what_would_be_lost(old, plan, reusable):
            raise StoreError(f"{target}: holds {lost}, which this scene does not ask for: {_REMEDY}")
        if "realization" in old.sizes and (not plan.unloads or set(PULL_OFF_NUMBERS) <= set(old.variables)):
            for read in _task_results_of(old):
                reusable.add(read)
    elif old is not None:  # stored task results that match do not allow to replace a result that does not
        matches = False
        reasons += _what_changed(old.attrs["scene"], old.attrs.get("versions", "other versions"), plan)
    if reasons and not matches:
        unique = list(dict.fromkeys(reasons))
        more = f" and {len(unique) - _MAX_CHANGES} more" if len(unique) > _MAX_CHANGES else ""
        changed = "; ".join(unique[:_MAX_CHANGES]) + more
        raise StoreError(f"{target}: holds results of another scene: {changed}: {_REMEDY}")


def _what_would_be_lost(old: Labelled, plan: Plan, reusable: ReusableRows) -> str:
    """Name the part of a result that would be lost: cells, variables, curves or realisations; empty for nothing."""
    if others := sum(not reusable.matches([key]) for key in _keys(old)):
        return f"{others} cell{'s' * (others > 1)} more"
    output = plan.scene.output
    names = [name for name in LAW_VARIABLES if name in old.variables or f"{name}_mean" in old.variables]
    if unasked := [name for name in names if name not in plan.variables]:
        return ", ".join(unasked)
    if "realization" in old.sizes and output.keep == "statistics":
        return "the curves of its realisations"
    if plan.scene.accuracy is not None:  # how many there will be is not known yet, see check_no_less
        return ""
    count = max(_counts(old).values(), default=0)
    return f"{count} realisations" if count > plan.scene.batch.realizations else ""


def check_no_less(target: Path | None, old: Labelled, new: Labelled, keys: Sequence[set[str]]) -> None:
    """StoreError where a result has fewer realisations of a cell than the ``old`` one at ``target`` that it replaces.

    With [accuracy], or where runs failed, that is known only at the end; ``keys`` as in is_finished.
    """
    counts = _counts(new)
    new_counts = {key: max(counts.get(other, 0) for other in each) for each in keys for key in each}
    for key, count in _counts(old).items():
        if count > new_counts[key]:
            lost = f"holds {count} realisations of a cell, of which there would be {new_counts[key]}"
            raise StoreError(f"{target}: {lost}: {_REMEDY}")


def _counts(result: Labelled) -> dict[str, int]:
    """Return how many realisations of each cell a result holds, by the key of the cell."""
    done = result.variables["status"].values == DONE
    if "realization" in result.sizes:
        runs = done.reshape(-1, done.shape[-1])
        counts = (runs * np.arange(1, runs.shape[1] + 1)).max(axis=1)  # up to the last that is done
    else:
        counts = np.where(done, result.variables["realization_count"].values, 0).ravel()
    return dict(zip(_keys(result), counts.astype(int).tolist(), strict=True))


def _what_changed(scene: str, old_versions: str, plan: Plan) -> list[str]:
    """Say why no cell of a plan is one of a scene."""
    try:
        changed = list(changes(scene, plan.scene.toml))
    except ValueError:
        changed = ["its scene cannot be read"]
    if old_versions != versions():
        changed.append(f"it was made with {old_versions}, this is {versions()}")
    reads = any(cell.scene.asperities.inputs for cell in plan.cells)
    return changed or ["a file that it reads holds something else" if reads else "its cells are others"]


def _task_results_of(old: Labelled) -> Iterator[Reader]:
    """Yield readers of the curves of a result that were computed, of so few that a copy takes little memory."""
    status = old.variables["status"].values
    cell, first = np.nonzero(status.reshape(-1, status.shape[-1]) == DONE)
    together = max(1, _AT_ONCE // old.sizes["step"])
    for begin in range(0, cell.size, together):
        rows = slice(begin, begin + together)
        yield partial(_task_result_of, old, cell[rows], first[rows])


def _task_result_of(old: Labelled, cell: Ints, first: Ints) -> TaskResult:
    """Return some curves of a result as if one task had computed them."""
    shape = -1, old.sizes["realization"]
    arrays = old.variables | old.coordinates
    names = [name for name in LAW_VARIABLES if name in old.variables]
    curves = [arrays[name].values.reshape(-1, *arrays[name].values.shape[-2:])[cell, first] for name in names]
    pull_offs = np.full((cell.size, len(KNOWN_ROWS), len(PULL_OFF_NUMBERS)), np.nan)
    if set(PULL_OFF_NUMBERS) <= set(arrays):
        numbers = np.stack([arrays[name].values.reshape(shape)[cell, first] for name in PULL_OFF_NUMBERS], axis=1)
        pull_offs = np.array([KnownMoments.of(each).table for each in numbers]).reshape(pull_offs.shape)
    stated = {name: arrays[name].values.reshape(shape)[cell, first] for name in RUN_DIAGNOSTICS if name in arrays}
    return TaskResult(
        keys=tuple(_keys(old)),
        variables=tuple(names),
        cell=cell,
        first=first,
        size=np.ones(cell.size, dtype=np.int64),
        moments=(np.stack(curves, axis=1),),
        pull_offs=pull_offs,
        diagnostics=complete(stated, cell.size),
    )
