"""From the table of a scene to the scene, and to the cells that its sweep makes of it."""

import copy
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from roughmdr.errors import Fault, RoughmdrError
from roughmdr.faults import find_faults
from roughmdr.scene.keys import put, readers
from roughmdr.scene.sections import Scene
from roughmdr.scene.sweep import read_sweep


def validate(table: dict[str, Any], path: Path | None) -> tuple[Scene | None, list[Fault]]:
    """The scene with its cells, or all that is wrong with it."""
    if "sweep" not in table:
        return _read_one(table, path)
    plain = {key: value for key, value in copy.deepcopy(table).items() if key != "sweep"}
    sweep, faults = read_sweep(table["sweep"], dict(readers([Scene], plain)))
    if sweep is not None:
        _fill(plain, next(sweep.cells()), faults)
    base, found = _read_one(plain, path)
    faults += found
    if base is None or sweep is None or faults:
        return None, faults
    cells = []
    for values in sweep.cells():
        cell, found = _read_cell(plain, base, values, path)
        faults += found
        if cell is not None:
            cells.append(cell)
    if faults:
        return None, faults
    return Scene.of(table, path, {"sweep": sweep, **_parts(base)}, tuple(cells)), []


def _read_one(table: dict[str, Any], path: Path | None) -> tuple[Scene | None, list[Fault]]:
    try:
        return Scene.of(table, path), []
    except ValidationError as error:
        return None, find_faults(error, table, Scene)


def _fill(plain: dict[str, Any], first: dict[str, object], faults: list[Fault]) -> None:
    """Put the first value of each swept key that the scene itself leaves out."""
    for key, value in first.items():
        inner: Any = plain
        for part in key.split("."):
            inner = inner.get(part) if isinstance(inner, dict) else None
        if inner is None:
            try:
                put(plain, key, value)
            except RoughmdrError as error:
                faults.append(Fault(f"sweep.{key}", "", str(error)))


def _read_cell(
    plain: dict[str, Any], base: Scene, values: dict[str, object], path: Path | None
) -> tuple[Scene | None, list[Fault]]:
    """One cell of a sweep; parts that no swept key belongs to are taken from ``base``."""
    table = copy.deepcopy(plain)
    for key, value in values.items():
        put(table, key, value)
    swept = {key.split(".")[0] for key in values}
    try:
        return Scene.of(table, path, {name: part for name, part in _parts(base).items() if name not in swept}), []
    except ValidationError as error:
        cell = ", ".join(f"{key} = {value!r}" for key, value in values.items())
        return None, [_in_cell(fault, values, cell) for fault in find_faults(error, table, Scene)]


def _parts(scene: Scene) -> dict[str, Any]:
    return {name: getattr(scene, name) for name in type(scene).model_fields if getattr(scene, name) is not None}


def _in_cell(fault: Fault, values: dict[str, object], cell: str) -> Fault:
    """A fault that only a cell has, at the swept key that it belongs to."""
    if fault.key in values:
        return fault._replace(key=f"sweep.{fault.key}")
    inside = [key for key in values if key.startswith(f"{fault.key}.")]
    return fault._replace(key=f"sweep.{inside[0]}" if inside else fault.key, message=f"{fault.message} (where {cell})")
