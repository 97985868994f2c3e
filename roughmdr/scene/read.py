"""Reading a scene from a TOML file, a result or a dictionary; every fault is found before anything is computed."""

import copy
import os
import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial, reduce
from operator import getitem
from pathlib import Path
from typing import Any, NamedTuple, cast

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.scene.cells import validate
from roughmdr.scene.keys import is_within, set_key
from roughmdr.scene.scene import Scene
from roughmdr.scene.sweep import flatten
from roughmdr.schema.toml_text import key_lines, line_of, parse_toml, unquote_key
from roughmdr.schema.units import to_plain
from roughmdr.schema.wording import printable, short_repr
from roughmdr.storage.files import check_regular_file, is_open_pipe, is_zarr
from roughmdr.storage.reading import read_attribute, read_dimensions

_NETCDF_MAGIC = (b"\x89HDF", b"CDF")
_MAX_BYTES = 2**24


def read(
    source: str | Path | dict[str, Any] | Scene,
    changes: Iterable[str] | Mapping[str, Any] = (),
    amend: Callable[[dict[str, Any]], None] | None = None,
) -> Scene:
    """Return a validated scene with all changes applied.

    ``source`` is the path of a TOML file or of a result, which contains its scene, a dictionary of the same form, or a
    Scene. ``changes`` are KEY=VALUE with dotted keys, a value in TOML or else a string, or a dictionary of such keys
    and values; a key that is set is no longer swept. ``amend`` is given the changed table, which is not validated yet,
    to change it further. SceneError names every fault by file, line, key, value and what is allowed.
    """
    if isinstance(changes, Mapping):
        applied = [_named_change(key, value) for key, value in changes.items()]
    else:
        applied = [_parse_change(change) for change in changes]
    if isinstance(source, Scene) and not applied and amend is None:
        return source
    path, label, text, table = _read_table(source)
    try:
        _normalise(table, path.parent if path else Path())
    except OSError as error:
        raise SceneError(f"{label}: the current folder cannot be determined: {error.strerror}") from None
    try:
        for change in applied:
            _apply_change(table, change)
        if amend is not None:
            amend(table)
        stem = path.stem if path else "scene"
        table.setdefault("title", "".join(letter if letter.isprintable() else "?" for letter in stem))
        scene, faults = validate(table, path)
    except RecursionError:
        raise SceneError(f"{label}: its tables are nested too deeply") from None
    lines = key_lines(text)
    if faults or scene is None:
        faults = sorted(faults, key=lambda fault: line_of(fault.key, lines) or 0)
        raise SceneError.of([_add_location(fault, label, lines, applied) for fault in faults])
    known = source._locate if isinstance(source, Scene) and not applied else None
    scene._locate = known or partial(_add_location, label=label, lines=lines, applied=applied)
    return scene


def with_numbers(scene: Scene, numbers: Mapping[str, float]) -> Scene:
    """Return a validated scene without a sweep with other numbers [SI] of dotted keys; SceneError as ``read``.

    Only the sections that hold them are validated anew, and what must agree between sections.
    """
    table, names = dict(scene._table), {key.split(".")[0] for key in numbers}
    table |= {name: copy.deepcopy(table[name]) for name in names}
    for key, number in numbers.items():
        set_key(table, key, number)
    try:
        sections = {name: type(getattr(scene, name)).model_validate(table[name]) for name in names}
        changed: Any = scene.model_copy(update=sections)
        changed._sections_agree()
    except ValueError:
        return read(table)
    changed._table = table
    return cast(Scene, changed)


def _read_table(source: object) -> tuple[Path | None, str, str, dict[str, Any]]:
    """Return the file that a scene is read from, if any, what messages call it, its text and its table."""
    if isinstance(source, Scene):
        return source.file, "scene", "", parse_toml(source.toml)
    if isinstance(source, dict):
        return None, "scene", "", to_plain(source)
    if not isinstance(source, str | os.PathLike):
        raise SceneError(f"scene is {short_repr(source)}; it must be a path, a dictionary or a Scene")
    path, label = Path(source), str(source)
    text = _read_text(path)
    try:
        return path, label, text, parse_toml(text)
    except ValueError as error:
        raise SceneError(f"{label}: not valid TOML: {error}{_unquoted_unit_hint(str(error), text)}") from None


def _read_text(path: Path) -> str:
    """Return the TOML in a file, a pipe or a result."""
    if is_zarr(path):
        return _scene_of_result(path, "a Zarr store")
    try:
        if not is_open_pipe(path):
            check_regular_file(path)
        with path.open("rb") as file:
            content = file.read(max(map(len, _NETCDF_MAGIC)))
            if not content.startswith(_NETCDF_MAGIC):
                content += file.read(_MAX_BYTES)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    except RoughmdrError as error:
        raise SceneError(f"{path}: {error}") from None
    if content.startswith(_NETCDF_MAGIC):
        return _scene_of_result(path, "a netCDF file")
    if len(content) > _MAX_BYTES:
        raise SceneError(f"{path}: is longer than {_MAX_BYTES} bytes, the most that a scene can have")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError(f"{path}: not a text file; a scene is TOML in UTF-8") from None


def _scene_of_result(path: Path, kind: str) -> str:
    try:
        text, arrays = read_attribute(path, "scene"), read_dimensions(path)
    except RoughmdrError as error:
        raise SceneError(f"{path}: {kind}, but no result of roughmdr with a scene in it ({error})") from None
    if "failure" in arrays:
        raise SceneError(f"{path}: has fits of many curves, each of another scene: fit one alone to have its own")
    return text


def _unquoted_unit_hint(message: str, text: str) -> str:
    """Return a hint if the line that a message of tomllib names has a number with a unit but without quotes."""
    number = re.search(r"line (\d+)", message)
    line = text.split("\n")[int(number[1]) - 1] if number else ""
    bare = re.search(r"=\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?\s*[A-Za-zµμ%/][^#,}\]]*)", line)
    return f'; a number with a unit stands in quotes: "{bare[1].strip()}"' if bare else ""


class _Change(NamedTuple):
    """A key that gets another value."""

    by: str  # option or argument that sets it
    name: str  # of the change, in messages
    key: str
    value: Any


def _parse_change(change: str) -> _Change:
    """Read KEY=VALUE."""
    key, equals, value = change.partition("=")
    dotted = unquote_key(key)
    if not change.isprintable() and change.encode("utf-8", "replace").decode() != change:
        raise SceneError(f"--set {change!r}: is not UTF-8")
    if not equals or not all(dotted.split(".")):
        raise SceneError(f"--set {printable(change)}: expected KEY=VALUE, like adhesion.work='10 mJ/m^2'")
    return _Change("--set", printable(change), dotted, _parse_value(value))


def _named_change(key: object, value: object) -> _Change:
    """Check a key with its value as they stand in a dictionary."""
    dotted = unquote_key(key) if isinstance(key, str) else ""
    if not all(dotted.split(".")):
        raise SceneError(f"set: {short_repr(key)} is no key; expected dotted keys, like 'adhesion.work'")
    return _Change("set", printable(dotted), dotted, to_plain(value))


def _apply_change(table: dict[str, Any], change: _Change) -> None:
    """Apply a change to a table."""
    dotted, parts = change.key, change.key.split(".")
    alone: dict[str, Any] = reduce(lambda inner, part: {part: inner}, reversed(parts), change.value)
    _normalise(alone, Path())
    try:
        if parts[0] == "sweep":
            sweep = {} if parts == ["sweep"] else table.get("sweep", {})
            if not isinstance(sweep, dict) or not isinstance(alone["sweep"], dict):
                raise RoughmdrError("sweep is not a table")
            table["sweep"] = sweep | {key: _merge_range(sweep.get(key), new) for key, new in alone["sweep"].items()}
        else:
            set_key(table, dotted, reduce(getitem, parts, alone))
            _remove_from_sweep(table, dotted)
    except RoughmdrError as error:
        raise SceneError(f"{change.by} {change.name}: {error}") from None


def _merge_range(before: Any, after: Any) -> Any:
    """Return ``after``, with the ends of a linspace or logspace ``before`` if it sets num alone, else with its num."""
    if not isinstance(before, dict) or not isinstance(after, dict):
        return after
    kept = before if after.keys() <= {"num"} else {key: entry for key, entry in before.items() if key == "num"}
    return {**kept, **after}


def _remove_from_sweep(table: dict[str, Any], key: str) -> None:
    """Remove a key from the sweep, with the keys inside it and those that it is inside of."""
    sweep = table.get("sweep")
    if not isinstance(sweep, dict):
        return
    fixed = [swept for swept in sweep if is_within(swept, key) or is_within(key, swept)]
    for swept in fixed:
        del sweep[swept]
    if fixed and not sweep.keys() - {"mode"}:
        del table["sweep"]


def _parse_value(text: str) -> Any:
    try:
        table = parse_toml(f"value = {text}")
    except ValueError:
        return text
    return table["value"] if len(table) == 1 else text


def _normalise(table: dict[str, Any], folder: Path) -> None:
    """Dot the keys of the sweep, and make names of files of asperities, which are relative to ``folder``, absolute."""

    def absolute(name: Any) -> Any:
        return str((folder / name).absolute()) if isinstance(name, str) else name

    if "sweep" in table:
        table["sweep"] = flatten(table["sweep"])
    asperities, sweep = table.get("asperities"), table.get("sweep")
    if isinstance(asperities, dict) and "file" in asperities:
        asperities["file"] = absolute(asperities["file"])
    if isinstance(sweep, dict) and isinstance(sweep.get("asperities.file"), list):
        sweep["asperities.file"] = [absolute(name) for name in sweep["asperities.file"]]


def _add_location(fault: Fault, label: str, lines: dict[str, int], applied: list[_Change]) -> Fault:
    for change in applied:
        if is_within(fault.key, change.key):
            return fault._replace(location=change.by)
    line = line_of(fault.key, lines)
    return fault._replace(location=label if line is None else f"{label}:{line}")
