"""From the table of a scene to the scene, and to the cells that its sweep makes of it."""

import copy
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from roughmdr.errors import Fault, RoughmdrError
from roughmdr.scene.keys import put, readers
from roughmdr.scene.sections import Scene
from roughmdr.scene.sweep import in_words, read_sweep
from roughmdr.schema.faults import find_faults, with_likely_names
from roughmdr.schema.quantities import Reader

_Known = dict[tuple[str, tuple[tuple[str, object], ...]], tuple[dict[str, Any], Any]]
"""Parts of a scene, as tables and read, by their names and what is swept of them."""


def validate(table: dict[str, Any], path: Path | None) -> tuple[Scene | None, list[Fault]]:
    """The scene with its cells, or all that is wrong with it."""
    if "sweep" not in table:
        return _read(table, path, {})
    plain = {key: value for key, value in copy.deepcopy(table).items() if key != "sweep"}
    sweep, faults = read_sweep(table["sweep"], _known(plain, table["sweep"]))
    first = {} if sweep is None else next(sweep.cells())
    filled, found = _fill(plain, first)
    base, faults_of_base = _read(plain, path, {})
    # What is wrong with a value that was only filled in is for the cells to find.
    faults += found + [fault for fault in faults_of_base if fault.key not in filled]
    if base is None and not faults:
        base, faults = _read_cell(plain, first, path, {}, {})
    if base is None or sweep is None or faults:
        return None, faults
    parts = {name: getattr(base, name) for name in Scene.model_fields if name != "sweep"}
    known: _Known = {}
    cells, faults_of_cells, where = [], Counter[Fault](), dict[Fault, str]()
    for values in sweep.cells():
        cell, found = _read_cell(plain, values, path, parts, known)
        for fault in found:
            faults_of_cells[fault] += 1
            where.setdefault(fault, in_words(values))
        if cell is not None:
            cells.append(cell)
    if faults_of_cells:
        return None, [_counted(fault, count, where[fault]) for fault, count in faults_of_cells.items()]
    given = {name: parts[name] for name in base.model_fields_set}
    return Scene.of(table, path, {"sweep": sweep, **given}, tuple(cells)), []


def _known(plain: dict[str, Any], sweep: object) -> dict[str, Reader]:
    """The keys that a scene can have; those of every distribution that is swept too."""
    known = dict(readers([Scene], plain))
    for key, entries in sweep.items() if isinstance(sweep, dict) else ():
        if key in known and key.endswith(".distribution") and isinstance(entries, list):
            for entry in entries:
                other = copy.deepcopy(plain)
                with suppress(RoughmdrError):
                    put(other, key, entry)
                known |= dict(readers([Scene], other))
    return known


def _read(table: dict[str, Any], path: Path | None, ready: dict[str, Any]) -> tuple[Scene | None, list[Fault]]:
    try:
        return Scene.of(table, path, ready), []
    except ValidationError as error:
        faults = find_faults(error, table, Scene)
        likely = with_likely_names(error, table, Scene)
        more = [] if likely is None else _read(likely, path, ready)[1]
        return None, faults + [fault for fault in more if fault not in faults]


def _fill(plain: dict[str, Any], first: dict[str, object]) -> tuple[set[str], list[Fault]]:
    """Put the first value of each swept key that the scene itself leaves out; which these are, and what is wrong."""
    filled, faults = set(), []
    for key, value in first.items():
        inner: Any = plain
        for part in key.split("."):
            inner = inner.get(part) if isinstance(inner, dict) else None
        if inner is None:
            try:
                put(plain, key, value)
                filled.add(key)
            except RoughmdrError as error:
                faults.append(Fault(f"sweep.{key}", "", str(error)))
    return filled, faults


def _read_cell(
    plain: dict[str, Any], values: dict[str, object], path: Path | None, parts: dict[str, Any], known: _Known
) -> tuple[Scene | None, list[Fault]]:
    """One cell of a sweep; those of the read ``parts`` that no swept key belongs to are taken as they are.

    Swept parts are taken from ``known``, where one was read with the same values before, and put there.
    """
    swept: dict[str, tuple[tuple[str, object], ...]] = {}
    for key, value in values.items():
        name = key.split(".")[0]
        swept[name] = (*swept.get(name, ()), (key, value))
    alike = {name: known[name, own] for name, own in swept.items() if (name, own) in known}
    ready = {name: part for name, part in parts.items() if name not in swept}
    table = {name: _copied(part) if name in swept and name not in alike else part for name, part in plain.items()}
    table |= {name: part_table for name, (part_table, _) in alike.items()}
    for name, own in swept.items():
        if name in alike:
            continue
        for key, value in own:
            try:
                put(table, key, value)
            except RoughmdrError as error:
                return None, [Fault(f"sweep.{key}", "", str(error))]
    cell, faults = _read(table, path, ready | {name: part for name, (_, part) in alike.items()})
    if cell is not None:
        for name, own in swept.items():
            known[name, own] = table[name], getattr(cell, name)
    return cell, [_at_swept_key(fault, values) for fault in faults]


def _copied(table: Any) -> Any:
    """Tables within tables anew; what stands in them is the same."""
    return {key: _copied(value) for key, value in table.items()} if isinstance(table, dict) else table


def _at_swept_key(fault: Fault, values: dict[str, object]) -> Fault:
    swept = [key for key in values if key == fault.key or key.startswith(f"{fault.key}.")]
    return fault._replace(key=f"sweep.{swept[0]}") if swept else fault


def _counted(fault: Fault, count: int, first: str) -> Fault:
    """A fault of some cells, with the first of them."""
    where = f"where {first}" if count == 1 else f"in {count} cells, first where {first}"
    return fault._replace(message=f"{fault.message} ({where})")
