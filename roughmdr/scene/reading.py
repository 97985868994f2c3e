"""From a TOML file, a result or a dictionary to a validated scene; every fault is found before anything is computed."""

import copy
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.scene.cells import validate
from roughmdr.scene.keys import put
from roughmdr.scene.lines import key_lines, line_of
from roughmdr.scene.sections import Scene
from roughmdr.scene.sweep import flatten

_PATHS = (("asperities", "file"),)
"""Keys that name a file: in a scene relative to the scene, in --set to the current folder."""
_NETCDF = (b"\x89HDF", b"CDF")


def read(source: str | Path | dict[str, Any] | Scene, changes: Iterable[str] = ()) -> Scene:
    """A validated scene with all changes in it.

    source is the path of a TOML file or of a result, which holds its scene, a dictionary of the same form, or a Scene.
    ``changes`` are KEY=VALUE with dotted keys; a value is TOML, or else a string; a key that is set is no longer swept.
    SceneError names every fault by file, line, key, value and what is allowed.
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
    if "sweep" in table:
        table["sweep"] = flatten(table["sweep"])
    _resolve_paths(table, path.parent if path else Path())
    changed = _change(table, changes)
    table.setdefault("title", path.stem if path else "scene")
    scene, faults = validate(table, path)
    if faults or scene is None:
        lines = key_lines(text)
        faults = sorted(faults, key=lambda fault: line_of(fault.key, lines) or 0)
        raise SceneError.of([_located(fault, label, lines, changed) for fault in faults])
    return scene


def _text(path: Path) -> str:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    if content.startswith(_NETCDF):
        return _scene_of_result(path)
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        raise SceneError(f"{path}: not a text file; a scene is TOML in UTF-8") from None


def _scene_of_result(path: Path) -> str:
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            return str(file.getncattr("scene"))
    except (OSError, RuntimeError, AttributeError) as error:
        raise SceneError(f"{path}: a netCDF file, but no result of roughmdr: it holds no scene ({error})") from None


def _change(table: dict[str, Any], changes: Iterable[str]) -> set[str]:
    changed = set()
    for change in changes:
        key, equals, value = change.partition("=")
        parts = [part.strip().strip("\"'") for part in key.split(".")]
        if not equals or not all(parts):
            raise SceneError(f"--set {change}: expected KEY=VALUE, like adhesion.work='10 mJ/m^2'")
        dotted = ".".join(parts)
        try:
            if parts[0] == "sweep" and len(parts) > 1:
                table["sweep"] = flatten(table.get("sweep", {}))
                table["sweep"][".".join(parts[1:])] = _value(value)
            else:
                put(table, dotted, _value(value))
                _no_longer_swept(table, dotted)
        except (RoughmdrError, TypeError) as error:
            raise SceneError(f"--set {change}: {error}") from None
        if tuple(parts[-2:]) in _PATHS:
            _resolve_paths(table, Path())
        changed.add(dotted)
    return changed


def _no_longer_swept(table: dict[str, Any], key: str) -> None:
    sweep = table.get("sweep")
    if isinstance(sweep, dict) and key in sweep:
        del sweep[key]
        if not sweep.keys() - {"mode"}:
            del table["sweep"]


def _value(text: str) -> Any:
    try:
        table = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return table["value"] if len(table) == 1 else text


def _resolve_paths(table: dict[str, Any], folder: Path) -> None:
    def resolved(name: Any) -> Any:
        return str((folder / name).absolute()) if isinstance(name, str) else name

    for section, key in _PATHS:
        inner, sweep = table.get(section), table.get("sweep")
        if isinstance(inner, dict) and key in inner:
            inner[key] = resolved(inner[key])
        swept = f"{section}.{key}"
        if isinstance(sweep, dict) and isinstance(sweep.get(swept), list):
            sweep[swept] = [resolved(name) for name in sweep[swept]]


def _located(fault: Fault, label: str, lines: dict[str, int], changed: set[str]) -> Fault:
    if any(fault.key == key or fault.key.startswith((f"{key}.", f"{key}[")) for key in changed):
        return fault._replace(place="--set")
    line = line_of(fault.key, lines)
    return fault._replace(place=label if line is None else f"{label}:{line}")
