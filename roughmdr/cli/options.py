"""Arguments and options that several commands share."""

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
