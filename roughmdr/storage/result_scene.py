"""The scene in a file, as far as summaries of results rely on it."""

from collections.abc import Iterator

from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import adheres
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.wording import printable

_OF_THE_FILE = ("title", "seed")  # keys outside any section
_RANGES = ("linspace", "logspace")
_NAMES = (
    "asperities.source",
    "asperities.model",
    "asperities.shape",
    "adhesion.model",
    "interaction.model",
    "interaction.boundary",
    "interaction.beyond",
    "batch.estimator",
)
"""Keys whose values are names."""


def scene_faults(text: str) -> Iterator[str]:
    """Find why a text is not the scene of a result."""
    try:
        table = parse_toml(text)
    except ValueError as error:
        yield f"its scene cannot be read: not valid TOML: {error}"
        return
    sections = [name for name, value in table.items() if name not in _OF_THE_FILE and not isinstance(value, dict)]
    if sections:
        yield f"{printable(sections[0])} in its scene is no table"
        return
    for key, swept in table.get("sweep", {}).items():
        ends = [swept[kind] for kind in _RANGES if kind in swept] if isinstance(swept, dict) else [swept]
        if key != "mode" and not all(isinstance(each, list) for each in ends):
            yield f"sweep.{printable(key)} in its scene is no list or range"
            return
    for key in _NAMES:
        section, name = key.split(".")
        own, swept = table.get(section, {}).get(name, ""), table.get("sweep", {}).get(key)
        if not all(isinstance(value, str) for value in [own, *(swept if isinstance(swept, list) else [])]):
            yield f"{key} in its scene is no name"
    variables = table.get("output", {}).get("variables", [])
    if not isinstance(variables, list) or not all(isinstance(name, str) for name in variables):
        yield "output.variables in its scene are no names"
    try:
        adheres(table)
    except RoughmdrError as error:
        yield f"adhesion.work in its scene: {error}"
