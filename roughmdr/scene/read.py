"""From a TOML file, a result or a dictionary to a validated scene; every fault is found before anything is computed."""

import os
import re
from collections.abc import Iterable
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any

import numpy as np

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.scene.cells import validate
from roughmdr.scene.keys import put
from roughmdr.scene.line_numbers import key_lines, line_of
from roughmdr.scene.sections import Scene
from roughmdr.scene.sweep import flatten
from roughmdr.schema.toml_text import table_of
from roughmdr.schema.wording import printable, shown
from roughmdr.storage.files import check_ordinary, is_open_pipe
from roughmdr.storage.netcdf import load_text

_PATHS = (("asperities", "file"),)
"""Keys that name a file: in a scene relative to the scene, in --set to the current folder."""
_NETCDF = (b"\x89HDF", b"CDF")
_MOST = 2**24  # bytes


def read(source: str | Path | dict[str, Any] | Scene, changes: Iterable[str] = ()) -> Scene:
    """A validated scene with all changes in it.

    source is the path of a TOML file or of a result, which holds its scene, a dictionary of the same form, or a Scene.
    ``changes`` are KEY=VALUE with dotted keys; a value is TOML, or else a string; a key that is set is no longer swept.
    SceneError names every fault by file, line, key, value and what is allowed.
    """
    changes = list(changes)
    if isinstance(source, Scene):
        if not changes:
            return source
        path, label, text, table = source.file, "scene", "", table_of(source.toml)
    elif isinstance(source, dict):
        path, label, text, table = None, "scene", "", _plain(source)
    elif not isinstance(source, str | os.PathLike):
        raise SceneError(f"scene is {shown(source)}; it must be a path, a dictionary or a Scene")
    else:
        path, label, text = Path(source), str(source), _text(Path(source))
        try:
            table = table_of(text)
        except ValueError as error:
            raise SceneError(f"{label}: not valid TOML: {error}{_hint(str(error), text)}") from None
    try:
        _settle(table, path.parent if path else Path())
    except OSError as error:
        raise SceneError(f"{label}: the current folder cannot be told: {error.strerror}") from None
    try:
        changed = {_change(table, change) for change in changes}
        stem = path.stem if path else "scene"
        table.setdefault("title", "".join(letter if letter.isprintable() else "?" for letter in stem))
        scene, faults = validate(table, path)
    except RecursionError:
        raise SceneError(f"{label}: its tables are nested too deeply") from None
    if faults or scene is None:
        lines = key_lines(text)
        faults = sorted(faults, key=lambda fault: line_of(fault.key, lines) or 0)
        raise SceneError.of([_located(fault, label, lines, changed) for fault in faults])
    return scene


def _text(path: Path) -> str:
    """The TOML in a file, a pipe or a result."""
    try:
        content = _content(path)
    except RoughmdrError as error:
        raise SceneError(f"{path}: {error}") from None
    if content.startswith(_NETCDF):
        return _scene_of_result(path)
    if len(content) > _MOST:
        raise SceneError(f"{path}: is longer than {_MOST} bytes, the most that a scene can have")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError(f"{path}: not a text file; a scene is TOML in UTF-8") from None


def _content(path: Path) -> bytes:
    """The bytes of a file or a pipe, as many as a scene may have and some more; of a netCDF file only the first."""
    if not is_open_pipe(path):
        check_ordinary(path)
    try:
        with path.open("rb") as file:
            first = file.read(max(map(len, _NETCDF)))
            return first if first.startswith(_NETCDF) else first + file.read(_MOST)
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None


def _hint(message: str, text: str) -> str:
    """What may be wrong on the line that a message of tomllib names."""
    number = re.search(r"line (\d+)", message)
    line = text.split("\n")[int(number[1]) - 1] if number else ""
    bare = re.search(r"=\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?\s*[A-Za-zµμ%/][^#,}\]]*)", line)
    return f'; a number with a unit stands in quotes: "{bare[1].strip()}"' if bare else ""


def _scene_of_result(path: Path) -> str:
    try:
        return load_text(path, "scene")
    except RoughmdrError as error:
        raise SceneError(f"{path}: a netCDF file, but no result of roughmdr: it holds no scene ({error})") from None


def _change(table: dict[str, Any], change: str) -> str:
    """Make one change; its dotted key."""
    key, equals, value = change.partition("=")
    parts = [part.strip().strip("\"'") for part in key.split(".")]
    if not change.isprintable() and change.encode("utf-8", "replace").decode() != change:
        raise SceneError(f"--set {change!r}: is not UTF-8")
    if not equals or not all(parts):
        raise SceneError(f"--set {printable(change)}: expected KEY=VALUE, like adhesion.work='10 mJ/m^2'")
    dotted = ".".join(parts)
    alone: dict[str, Any] = {}
    put(alone, dotted, _value(value))
    _settle(alone, Path())
    try:
        if parts[0] == "sweep":
            sweep = {} if parts == ["sweep"] else table.get("sweep", {})
            if not isinstance(sweep, dict) or not isinstance(alone["sweep"], dict):
                raise RoughmdrError("sweep is no table")
            table["sweep"] = {**sweep, **{key: _merged(sweep.get(key), entry) for key, entry in alone["sweep"].items()}}
        else:
            put(table, dotted, reduce(getitem, parts, alone))
            _no_longer_swept(table, dotted)
    except RoughmdrError as error:
        raise SceneError(f"--set {printable(change)}: {error}") from None
    return dotted


def _merged(before: Any, after: Any) -> Any:
    """A range of a sweep with a part of it changed; anything else as it is after the change."""
    if not isinstance(before, dict) or not isinstance(after, dict):
        return after
    kept = before if after.keys() <= {"num"} else {key: entry for key, entry in before.items() if key == "num"}
    return {**kept, **after}


def _no_longer_swept(table: dict[str, Any], key: str) -> None:
    """Take out what is swept of a key, of a part of it, or of the whole that it is a part of."""
    sweep = table.get("sweep")
    if not isinstance(sweep, dict):
        return
    fixed = [swept for swept in sweep if f"{swept}.".startswith(f"{key}.") or f"{key}.".startswith(f"{swept}.")]
    for swept in fixed:
        del sweep[swept]
    if fixed and not sweep.keys() - {"mode"}:
        del table["sweep"]


def _value(text: str) -> Any:
    try:
        table = table_of(f"value = {text}")
    except ValueError:
        return text
    return table["value"] if len(table) == 1 else text


def _plain(value: Any) -> Any:
    """What a scene in Python holds, as TOML would: arrays, tuples and sets as lists, numpy's numbers as Python's."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, set | frozenset):
        return sorted(map(_plain, value), key=repr)
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [_plain(entry) for entry in value] if isinstance(value, list | tuple) else value


def _settle(table: dict[str, Any], folder: Path) -> None:
    """Dot the keys of a sweep, and make the names of files absolute, which are relative to ``folder``."""

    def absolute(name: Any) -> Any:
        return str((folder / name).absolute()) if isinstance(name, str) else name

    if "sweep" in table:
        table["sweep"] = flatten(table["sweep"])
    for section, key in _PATHS:
        inner, sweep = table.get(section), table.get("sweep")
        if isinstance(inner, dict) and key in inner:
            inner[key] = absolute(inner[key])
        swept = f"{section}.{key}"
        if isinstance(sweep, dict) and isinstance(sweep.get(swept), list):
            sweep[swept] = [absolute(name) for name in sweep[swept]]


def _located(fault: Fault, label: str, lines: dict[str, int], changed: set[str]) -> Fault:
    if any(fault.key == key or fault.key.startswith((f"{key}.", f"{key}[")) for key in changed):
        return fault._replace(place="--set")
    line = line_of(fault.key, lines)
    return fault._replace(place=label if line is None else f"{label}:{line}")
