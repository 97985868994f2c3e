"""The file of the JSON Schema, and the line by which a scene names it to editors."""

import json
from pathlib import Path

from roughmdr.errors import StoreError
from roughmdr.storage.files import check_ending, check_writable, replace_atomically

TITLE = "A scene of roughmdr"
FILE_NAME = "roughmdr.schema.json"
DIRECTIVE = f"#:schema {FILE_NAME}\n"
"""First line of a scene, as taplo and the editors that use it understand it: the schema is in the same folder."""
_MAX_BYTES = 2**24


def schema_text() -> str:
    """Return the schema as JSON."""
    from roughmdr.scene.json_schema import scene_schema

    return json.dumps({"title": TITLE, **scene_schema()}, ensure_ascii=False, indent=1)


def write_schema(path: Path) -> None:
    """Write the schema."""
    text = schema_text()
    with replace_atomically(path) as temporary:
        temporary.write_text(f"{text}\n", encoding="utf-8")


def check_schema_file(path: Path, *, fresh: bool) -> None:
    """Raise StoreError where no schema can be written to ``path``, or something else is there and is not ``fresh``."""
    check_writable(path)
    check_ending(path, "schema", [".json"])
    if path.exists() and not fresh and _read(path).get("title") != TITLE:
        raise StoreError(f"{path}: exists already and is no schema of scenes: give another output, or --fresh")


def put_beside(scene: Path) -> str:
    """Write the schema to the folder of a scene unless something is there by its name; say which of it happened."""
    path = scene.with_name(FILE_NAME)
    try:
        if path.is_symlink() or path.exists():
            same = _read(path) == json.loads(schema_text())
            again = "" if same else f"; it is not that of this version, which is written by: roughmdr schema -o {path}"
            return f"{path} is there already, and is kept{again}"
        write_schema(path)
    except (StoreError, OSError) as error:
        return f"none: {error}"
    return f"{path}, by which editors complete and check scenes"


def _read(path: Path) -> dict[str, object]:
    """Return the JSON object in a file; an empty one where there is none."""
    try:
        if not path.is_file() or path.stat().st_size > _MAX_BYTES:
            return {}
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}
