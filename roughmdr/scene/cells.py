"""Validation of a scene's table: the scene itself and the cells of its sweep, or everything that is wrong."""

import copy
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from roughmdr.errors import Fault, RoughmdrError
from roughmdr.scene.keys import entry_at, is_within, key_readers, set_key
from roughmdr.scene.scene import Scene
from roughmdr.scene.sweep import describe_cell, read_sweep
from roughmdr.schema.faults import find_faults, with_likely_names
from roughmdr.schema.quantities import Reader

_SectionCache = dict[tuple[str, tuple[tuple[str, object], ...]], tuple[dict[str, Any], Any]]
"""Sections by their name and their swept keys with values, each as a table and validated."""


def validate(table: dict[str, Any], path: Path | None) -> tuple[Scene | None, list[Fault]]:
    """Return the scene with its cells, or all its faults."""
    if "sweep" not in table:
        return _validate_one(table, path, {})
    base_table = {key: value for key, value in copy.deepcopy(table).items() if key != "sweep"}
    sweep, faults = read_sweep(table["sweep"], _allowed_keys(base_table, table["sweep"]))
    first = {} if sweep is None else next(sweep.cells())
    filled, fill_faults = _fill_missing(base_table, first)
    base, base_faults = _validate_one(base_table, path, {})
    # Faults of a value that was only filled in are found again in the cells.
    faults += fill_faults + [fault for fault in base_faults if fault.key not in filled]
    if base is None and not faults:
        base, faults = _validate_cell(base_table, first, path, {}, {})
    if base is None or sweep is None or faults:
        return None, faults
    sections = {name: getattr(base, name) for name in Scene.model_fields if name != "sweep"}
    cache: _SectionCache = {}
    cells, wrong = [], dict[Fault, list[dict[str, object]]]()
    for values in sweep.cells():
        cell, cell_faults = _validate_cell(base_table, values, path, sections, cache)
        for fault in cell_faults:
            wrong.setdefault(fault, []).append(values)
        if cell is not None:
            cells.append(cell)
    for fault, where in wrong.items():
        several = f"in {len(where)} cells, first " if len(where) > 1 else ""
        faults.append(fault._replace(message=f"{fault.message} ({several}where {describe_cell(where[0])})"))
    if faults:
        return None, faults
    given = {name: sections[name] for name in base.model_fields_set}
    return Scene.of(table, path, {"sweep": sweep, **given}, tuple(cells)), []


def _allowed_keys(base_table: dict[str, Any], sweep: object) -> dict[str, Reader]:
    """Return the keys that a scene can have, with those of every distribution that is swept."""
    allowed = dict(key_readers([Scene], base_table))
    for key, entries in sweep.items() if isinstance(sweep, dict) else ():
        if key in allowed and key.endswith(".distribution") and isinstance(entries, list):
            for entry in entries:
                other = copy.deepcopy(base_table)
                with suppress(RoughmdrError):
                    set_key(other, key, entry)
                allowed |= dict(key_readers([Scene], other))
    return allowed


def _validate_one(
    table: dict[str, Any], path: Path | None, validated: dict[str, Any]
) -> tuple[Scene | None, list[Fault]]:
    try:
        return Scene.of(table, path, validated), []
    except ValidationError as error:
        faults = find_faults(error, table, Scene)
        likely = with_likely_names(error, table, Scene)
        more = [] if likely is None else _validate_one(likely, path, validated)[1]
        return None, faults + [fault for fault in more if fault not in faults]


def _fill_missing(base_table: dict[str, Any], first: dict[str, object]) -> tuple[set[str], list[Fault]]:
    """Set the swept keys that the scene leaves out to their first values; return these keys, and faults."""
    filled, faults = set(), []
    for key, value in first.items():
        if entry_at(key, base_table) is None:
            try:
                set_key(base_table, key, value)
                filled.add(key)
            except RoughmdrError as error:
                faults.append(Fault(f"sweep.{key}", "", str(error)))
    return filled, faults


def _validate_cell(
    base_table: dict[str, Any],
    values: dict[str, object],
    path: Path | None,
    sections: dict[str, Any],
    cache: _SectionCache,
) -> tuple[Scene | None, list[Fault]]:
    """Validate one cell of a sweep, reusing the validated ``sections`` that no swept key belongs to.

    A swept section is taken from ``cache`` if it was validated with the same values before, and is added to it.
    """
    swept: dict[str, tuple[tuple[str, object], ...]] = {}
    for key, value in values.items():
        name = key.split(".")[0]
        swept[name] = (*swept.get(name, ()), (key, value))
    table, validated = dict(base_table), {name: section for name, section in sections.items() if name not in swept}
    for name, own_values in swept.items():
        if (name, own_values) in cache:
            table[name], validated[name] = cache[name, own_values]
            continue
        table[name] = _copy_tables(table.get(name, {}))
        for key, value in own_values:
            try:
                set_key(table, key, value)
            except RoughmdrError as error:
                return None, [Fault(f"sweep.{key}", "", str(error))]
    cell, faults = _validate_one(table, path, validated)
    if cell is not None:
        cache |= {(name, own_values): (table[name], getattr(cell, name)) for name, own_values in swept.items()}
    for number, fault in enumerate(faults):
        if inner := [key for key in values if is_within(key, fault.key)]:
            faults[number] = fault._replace(key=f"sweep.{inner[0]}")
    return cell, faults


def _copy_tables(value: Any) -> Any:
    """Copy tables within tables and lists, but not the values in them."""
    if isinstance(value, list):
        return [_copy_tables(inner) for inner in value] if any(isinstance(each, dict) for each in value) else value
    return {key: _copy_tables(inner) for key, inner in value.items()} if isinstance(value, dict) else value
