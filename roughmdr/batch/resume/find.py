"""What is there of earlier runs: a result at the output, shards that were kept; and whether they are of use."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.keys import changes, versions
from roughmdr.batch.resume.reusable import ReusableRows
from roughmdr.batch.resume.store import ShardStore
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_file import read_result
from roughmdr.variables import CURVE_VARIABLES, DONE, FAILED

_MOST_CHANGES = 5
_SHAPING = ("title", "output", "batch", "accuracy", "sweep")
"""Parts of a scene that say what a result looks like and how many realisations it has."""
_WAYS_OUT = "give another output, or --fresh (resume=False) to replace it"


def find_previous(target: Path) -> Labelled | None:
    """The result at ``target``, None where nothing is; StoreError where it is none, or was changed later."""
    if not target.exists():
        return None
    try:
        old = read_result(target)
    except StoreError as error:
        raise StoreError(f"{error}. It is there already: {_WAYS_OUT}") from None
    if fault := old.integrity_fault():
        raise StoreError(f"{target}: {fault}: {_WAYS_OUT}")
    return old


def is_finished(old: Labelled, plan: Plan, keys: Sequence[set[str]]) -> bool:
    """Whether a result is just what is asked for; ``keys`` are those that each cell may have."""
    asked, was = (parse_toml(text) for text in (plan.scene.toml, old.attrs["scene"]))
    same = all(asked.get(part) == was.get(part) for part in _SHAPING)
    same = same and list(asked.get("sweep", ())) == list(was.get("sweep", ()))  # in this order are its dimensions
    held = _keys(old)
    same = same and len(held) == len(keys) and all(key in may for key, may in zip(held, keys, strict=True))
    return same and not (old.variables["status"].values == FAILED).any()


def _keys(old: Labelled) -> list[str]:
    return old.coordinates["cell_key"].values.ravel().tolist() if "cell_key" in old.coordinates else []


def reuse(target: Path, old: Labelled | None, parts: ShardStore | None, plan: Plan, held: ReusableRows) -> None:
    """Add what there is of earlier runs to ``held``: the shards that were kept, and the curves of a result.

    StoreError, saying what changed, where there are results and none of them is of use.
    """
    matches, there = False, list[str]()
    if parts is not None and not parts.empty:
        found = [held.add(read) for read in parts.held()]
        matches = any(found)
        if not matches and any(one is not None for one in found):  # else all are damaged, and nothing is lost
            there += _what_changed(parts.scene, parts.versions, plan)
    if old is not None and held.wants(_keys(old)):
        matches = True
        if less := _what_would_go(old, plan, held):
            raise StoreError(f"{target}: holds {less}, which this scene does not ask for: {_WAYS_OUT}")
        if "realization" in old.sizes:
            shard = _shard_of(old)
            held.add(lambda: shard)
    elif old is not None:  # kept runs that would take its place are no excuse
        matches = False
        there += _what_changed(old.attrs["scene"], old.attrs.get("versions", "other versions"), plan)
    if there and not matches:
        unique = list(dict.fromkeys(there))
        more = f" and {len(unique) - _MOST_CHANGES} more" if len(unique) > _MOST_CHANGES else ""
        raise StoreError(
            f"{target}: holds results of another scene: {'; '.join(unique[:_MOST_CHANGES])}{more}: {_WAYS_OUT}"
        )


def _what_would_go(old: Labelled, plan: Plan, held: ReusableRows) -> str:
    """Name the part of a result that would be lost: cells, variables, curves or realisations; empty for nothing."""
    strangers = sum(not held.wants([key]) for key in _keys(old))
    if strangers:
        return f"{strangers} cell{'s' * (strangers > 1)} more"
    asked = plan.scene.output
    if unasked := [name for name in _variables(old) if name not in asked.variables]:
        return ", ".join(unasked)
    if "realization" in old.sizes and asked.keep == "statistics":
        return "the curves of its realisations"
    if plan.scene.accuracy is not None:  # how many there will be is not known yet, see check_no_less
        return ""
    count = max(_counts(old).values(), default=0)
    return f"{count} realisations" if count > plan.scene.batch.realizations else ""


def check_no_less(target: Path, old: Labelled, new: Labelled, keys: Sequence[set[str]]) -> None:
    """StoreError where a result has fewer realisations of a cell than the one at ``target`` whose place it would take.

    With [accuracy] that is known only when it is there, and so it is of runs that failed; ``keys`` as in is_finished.
    """
    cell_of = {key: number for number, may in enumerate(keys) for key in may}
    counts = _counts(new)
    found = [max(counts.get(key, 0) for key in may) for may in keys]
    for key, count in _counts(old).items():
        if count > found[cell_of[key]]:
            raise StoreError(
                f"{target}: holds {count} realisations of a cell, of which there would be {found[cell_of[key]]}: "
                f"{_WAYS_OUT}"
            )


def _variables(old: Labelled) -> list[str]:
    """The variables of a law that a result holds, as curves or as statistics."""
    return [name for name in CURVE_VARIABLES if name in old.variables or f"{name}_mean" in old.variables]


def _counts(result: Labelled) -> dict[str, int]:
    """By the key of each cell, how many realisations of it a result holds."""
    done = result.variables["status"].values == DONE
    if "realization" in result.sizes:
        each = done.reshape(-1, done.shape[-1])
        counts = (each * np.arange(1, each.shape[1] + 1)).max(axis=1)
    else:
        counts = np.where(done, result.variables["realization_count"].values, 0).ravel()
    return dict(zip(_keys(result), counts.astype(int).tolist(), strict=True))


def _what_changed(scene: str, made_with: str, plan: Plan) -> list[str]:
    """Why no cell of a plan is one of a scene, in words."""
    try:
        changed = list(changes(scene, plan.scene.toml))
    except ValueError:
        changed = ["its scene cannot be read"]
    if made_with != versions():
        changed.append(f"it was made with {made_with}, this is {versions()}")
    reads = any(cell.scene.asperities.inputs for cell in plan.cells)
    return changed or ["a file that it reads holds something else" if reads else "its cells are others"]


def _shard_of(old: Labelled) -> TaskResult:
    """The curves of a result that were computed, as a shard."""
    status = old.variables["status"]
    cells = status.values.reshape(-1, status.values.shape[-1])
    cell, first = np.nonzero(cells == DONE)
    names = [name for name in CURVE_VARIABLES if name in old.variables]

    def column(name: str, default: float) -> np.ndarray:
        if name not in old.variables:
            return np.full(cell.size, default)
        return old.variables[name].values.reshape(cells.shape)[cell, first]

    tabor = column("tabor_number", np.inf)
    nothing = np.empty((cell.size, 0, 0))
    return TaskResult(
        keys=tuple(_keys(old)),
        variables=tuple(names),
        cell=cell,
        first=first,
        size=np.ones(cell.size, dtype=np.int64),
        values=np.stack([old.variables[name].values.reshape(*cells.shape, -1)[cell, first] for name in names], axis=1),
        spread=nothing,
        least=nothing,
        greatest=nothing,
        run_time=column("run_time", 0.0),
        numerical_error=column("numerical_error", 0.0),
        tabor=np.where(np.isnan(tabor), np.inf, tabor),
        law=column("adhesion_law", 0).astype(np.int64),
        slope=column("edge_slope", 0.0),
        extent=column("profile_extent", 0.0),
        status=np.full(cell.size, DONE, dtype=np.int64),
        remark=_remarks(old)[cell, first],
    )


def _remarks(old: Labelled) -> NDArray[np.str_]:
    shape = old.variables["status"].values.shape
    remarks = old.coordinates["remark"].values if "remark" in old.coordinates else np.full(shape, "")
    return remarks.astype(str).reshape(-1, shape[-1])
