"""From the table of a scene to the scene, and to the cells that its sweep makes of it."""

import copy
from collections import Counter
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from roughmdr.errors import Fault, RoughmdrError
from roughmdr.faults import find_faults
from roughmdr.scene.keys import put, readers
from roughmdr.scene.sections import Scene
from roughmdr.scene.sweep import in_words, read_sweep


def validate(table: dict[str, Any], path: Path | None) -> tuple[Scene | None, list[Fault]]:
    """The scene with its cells, or all that is wrong with it."""
    if "sweep" not in table:
        return _read(table, path, {})
    plain = {key: value for key, value in copy.deepcopy(table).items() if key != "sweep"}
    sweep, faults = read_sweep(table["sweep"], dict(readers([Scene], plain)))
    if sweep is not None:
        faults += _fill(plain, next(sweep.cells()))
    base, found = _read(plain, path, {})
    faults += found
    if base is None or sweep is None or faults:
        return None, faults
    parts = {name: getattr(base, name) for name in base.model_fields_set}
    cells, faults_of_cells, first = [], Counter[Fault](), dict[Fault, str]()
    for values in sweep.cells():
        cell, found = _read_cell(plain, values, path, parts)
        for fault in found:
            faults_of_cells[fault] += 1
            first.setdefault(fault, in_words(values))
        if cell is not None:
            cells.append(cell)
    if faults_of_cells:
        return None, [_counted(fault, count, first[fault]) for fault, count in faults_of_cells.items()]
    return Scene.of(table, path, {"sweep": sweep, **parts}, tuple(cells)), []


def _read(table: dict[str, Any], path: Path | None, ready: dict[str, Any]) -> tuple[Scene | None, list[Fault]]:
    try:
        return Scene.of(table, path, ready), []
    except ValidationError as error:
        return None, find_faults(error, table, Scene)


def _fill(plain: dict[str, Any], first: dict[str, object]) -> list[Fault]:
    """Put the first value of each swept key that the scene itself leaves out."""
    faults = []
    for key, value in first.items():
        inner: Any = plain
        for part in key.split("."):
            inner = inner.get(part) if isinstance(inner, dict) else None
        if inner is None:
            try:
                put(plain, key, value)
            except RoughmdrError as error:
                faults.append(Fault(f"sweep.{key}", "", str(error)))
    return faults


def _read_cell(
    plain: dict[str, Any], values: dict[str, object], path: Path | None, parts: dict[str, Any]
) -> tuple[Scene | None, list[Fault]]:
    """One cell of a sweep; those of the read ``parts`` that no swept key belongs to are taken as they are."""
    table = copy.deepcopy(plain)
    for key, value in values.items():
        try:
            put(table, key, value)
        except RoughmdrError as error:
            return None, [Fault(f"sweep.{key}", "", str(error))]
    swept = {key.split(".")[0] for key in values}
    cell, faults = _read(table, path, {name: part for name, part in parts.items() if name not in swept})
    return cell, [_at_swept_key(fault, values) for fault in faults]


def _at_swept_key(fault: Fault, values: dict[str, object]) -> Fault:
    swept = [key for key in values if key == fault.key or key.startswith(f"{fault.key}.")]
    return fault._replace(key=f"sweep.{swept[0]}") if swept else fault


def _counted(fault: Fault, count: int, first: str) -> Fault:
    """A fault of some cells, with the first of them."""
    where = f"where {first}" if count == 1 else f"in {count} cells, first where {first}"
    return fault._replace(message=f"{fault.message} ({where})")
