"""From a TOML file, or a dictionary, to a validated scene; every fault is found before anything is computed."""

import copy
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from roughmdr.complaints import Complaint, complaints
from roughmdr.errors import SceneError
from roughmdr.scene.lines import key_lines, line_of
from roughmdr.scene.sections import Scene

_PATHS = (("asperities", "file"),)
"""Keys that name a file: in a scene relative to the scene, in --set to the current folder."""


def read(source: str | Path | dict[str, Any] | Scene, changes: Iterable[str] = ()) -> Scene:
    """A validated scene with all changes in it.

    source is the path of a TOML file, a dictionary of the same form, or a Scene. ``changes`` are KEY=VALUE with dotted
    keys; a value is TOML, or else a string. SceneError names every fault by file, line, key, value and what is allowed.
    """
    if isinstance(source, Scene):
        source = tomllib.loads(source.toml)
    if isinstance(source, dict):
        path, label, text, table = None, "scene", "", copy.deepcopy(source)
    else:
        path, label, text = Path(source), str(source), _text(Path(source))
        try:
            table = tomllib.loads(text)
        except (ValueError, RecursionError) as error:
            raise SceneError(f"{label}: not valid TOML: {error}") from None
    _resolve_paths(table, path.parent if path else Path())
    changed = _change(table, changes)
    table.setdefault("title", path.stem if path else "scene")
    try:
        return Scene.of(table, path)
    except ValidationError as error:
        lines = key_lines(text)
        found = complaints(error, table, Scene)
        raise SceneError("\n".join(_located(complaint, label, lines, changed) for complaint in found)) from None


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise SceneError(f"{path}: not a text file; a scene is TOML in UTF-8") from None


def _change(table: dict[str, Any], changes: Iterable[str]) -> set[str]:
    changed = set()
    for change in changes:
        key, equals, value = change.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not equals or not all(parts):
            raise SceneError(f"--set {change}: expected KEY=VALUE, like adhesion.work='10 mJ/m^2'")
        inner = table
        for part in parts[:-1]:
            inner = inner.setdefault(part, {})
            if not isinstance(inner, dict):
                raise SceneError(f"--set {change}: {part} is no table")
        inner[parts[-1]] = _value(value)
        if tuple(parts) in _PATHS:
            _resolve_paths(table, Path())
        changed.add(".".join(parts))
    return changed


def _value(text: str) -> Any:
    try:
        table = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return table["value"] if len(table) == 1 else text


def _resolve_paths(table: dict[str, Any], folder: Path) -> None:
    for section, key in _PATHS:
        inner = table.get(section)
        if isinstance(inner, dict) and isinstance(inner.get(key), str):
            inner[key] = str((folder / inner[key]).absolute())


def _located(complaint: Complaint, label: str, lines: dict[str, int], changed: set[str]) -> str:
    if any(complaint.key == key or complaint.key.startswith((f"{key}.", f"{key}[")) for key in changed):
        return f"--set {complaint}"
    line = line_of(complaint.key, lines)
    return f"{label}: {complaint}" if line is None else f"{label}:{line}: {complaint}"
