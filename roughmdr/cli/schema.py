"""roughmdr schema: the JSON Schema of the scene file."""

from pathlib import Path

import click

from roughmdr.cli.options import OUTPUT, fresh_option
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.option("-o", "--output", type=OUTPUT, help="JSON file to write; printed without it.")
@fresh_option
def schema(output: Path | None, fresh: bool) -> None:
    """Print the JSON Schema of scenes.

    Editors complete and check scenes by it; "roughmdr new" writes it beside a new scene. An existing file is replaced
    only if it is such a schema.
    """
    from roughmdr.scene.schema_file import check_schema_file, schema_text, write_schema

    if output is None:
        print_text(schema_text())
        return
    check_schema_file(output, fresh=fresh)
    write_schema(output)
    print_text(f"schema       {click.format_filename(output)}")
