"""Arguments and options that several commands share."""

from collections.abc import Sequence
from pathlib import Path

import click

FILE = click.Path(path_type=Path)
OUTPUT = click.Path(dir_okay=False, path_type=Path)
changes_option = click.option(
    "--set", "changes", multiple=True, metavar="KEY=VALUE", help="Set a key of the scene; repeatable."
)
fresh_option = click.option("--fresh", is_flag=True, help="Replace an existing output of any kind.")
json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON document, also on errors, and nothing else."
)
workers_option = click.option(
    "--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Number of threads or processes."
)


def pairs(option: str, texts: Sequence[str]) -> dict[str, object]:
    """Read several KEY=VALUE, numbers or texts, each key once."""
    found: dict[str, object] = {}
    for text in texts:
        key, equals, value = map(str.strip, text.partition("="))
        if not (key and equals and value):
            raise click.UsageError(f"{option} {text}: expected KEY=VALUE")
        if key in found:
            raise click.UsageError(f"{option} {text}: {key} has a value already, {found[key]}")
        try:
            found[key] = float(value)
        except ValueError:
            found[key] = value
    return found
