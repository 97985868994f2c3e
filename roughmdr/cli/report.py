"""roughmdr report: write a result as a page."""

from pathlib import Path

import click

from roughmdr.cli.invocation import read_warned
from roughmdr.cli.options import FILE, OUTPUT, fresh_option
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="Page to write: .html.")
@fresh_option
def report(result: Path, output: Path, fresh: bool) -> None:
    """Write RESULT as one page of HTML.

    It shows pictures, errors, scene, provenance, and what to cite, and needs no other file. A page that is there
    already is replaced, since RESULT writes it again.
    """
    from roughmdr.report.page import check_page, write_page

    check_page(output, result, fresh=fresh)
    write_page(read_warned(result), result, output)
    print_text(f"report       {click.format_filename(output)}")
