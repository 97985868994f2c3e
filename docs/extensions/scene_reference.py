"""The keys of a scene, from the schema that checks it, in place of ``{{ scene keys }}`` on a page."""

import json
import re
from collections.abc import Iterator
from typing import Any

from sphinx.application import Sphinx

from roughmdr.scene.json_schema import scene_schema

_PLACE = "{{ scene keys }}"
_REPEATED = ("second", "correlation")  # tables whose keys are those of the shape parameters once more
_Table = dict[str, Any]


def setup(app: Sphinx) -> dict[str, Any]:
    """Let Sphinx read pages through ``_fill``."""
    app.connect("source-read", _fill)
    return {"parallel_read_safe": True}


def _fill(app: Sphinx, page: str, text: list[str]) -> None:
    if _PLACE in text[0]:
        text[0] = text[0].replace(_PLACE, "\n".join(_lines(scene_schema())))


def _lines(schema: _Table) -> Iterator[str]:
    """Yield the page: keys that stand alone first, then a heading and a table for each section."""
    sections = {name: each for name, each in schema["properties"].items() if each.get("type") == "object"}
    yield "## Keys before the first section"
    yield from _key_table({name: each for name, each in schema["properties"].items() if name not in sections}, {})
    for name, section in sections.items():
        yield f"\n## [{name}]\n"
        yield _escaped(section["description"])
        if name != "sweep":
            yield from _key_table(section["properties"], _sources_of(section))
    yield "\n" + _escaped(
        "Besides mode, which is product or zip, the names of a sweep are those of nearly every number and name in the "
        "tables above, with their section, such as adhesion.work or asperities.height.std: a list of values, or "
        "{ linspace = [first, last], num = ... } or { logspace = [first, last], num = ... }."
    )


def _sources_of(section: _Table) -> dict[str, list[str]]:
    """Return, for the keys of [asperities], the sources that have them; of other sections nothing."""
    sources: dict[str, list[str]] = {}
    for choice in section.get("allOf", []):
        source = choice["if"]["properties"].get("source", {}).get("const")
        for key in choice["then"].get("propertyNames", {}).get("enum", []) if source else []:
            sources.setdefault(key, []).append(source)
    return sources


def _key_table(keys: _Table, sources: dict[str, list[str]]) -> Iterator[str]:
    """Yield a table of keys; with their sources where these differ."""
    yield "\n| key | meaning |" + (" source |" if sources else "")
    yield "|---|---|" + ("---|" if sources else "")
    for key, each in _with_parts(keys):
        row = f"| `{key}` | {_escaped(each.get('description', ''))}{_choices(each)} |"
        yield row + (f" {', '.join(sources.get(key.split('.')[0], []))} |" if sources else "")


def _with_parts(keys: _Table, prefix: str = "") -> Iterator[tuple[str, _Table]]:
    """Yield every key, and after a table the keys in it, with dots, unless they stand in another table as well."""
    for key, each in keys.items():
        yield f"{prefix}{key}", each
        if key in _REPEATED:
            own = {name: part for name, part in each.get("properties", {}).items() if name not in keys}
            yield from _with_parts(own, f"{prefix}{key}.")
            continue
        inner = each.get("items", {}) if "array" in str(each.get("type")) and "properties" not in each else each
        yield from _with_parts(inner.get("properties", {}), f"{prefix}{key}.")


def _choices(each: _Table) -> str:
    """Return the names that a key allows, where its description does not list them."""
    names = each.get("enum") or each.get("items", {}).get("enum") or []
    missing = [name for name in names if json.dumps(name) not in each.get("description", "")]
    return f" Choices: {', '.join(f'`{name}`' for name in names)}." if missing else ""


def _escaped(text: str) -> str:
    """Return text that Markdown shows as it is; what is in quotes or braces as code."""
    parts = re.split(r'("[^"]*"|\{[^}]*\}|\[[^\]]*\])', text)
    return "".join(
        f"`{part}`" if i % 2 else re.sub(r"([*_<|\[\]{}])", r"\\\1", part) for i, part in enumerate(parts)
    ).replace("|", "\\|")
