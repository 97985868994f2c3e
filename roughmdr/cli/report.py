"""roughmdr report: write a result or a fit as a page."""

from pathlib import Path

import click

from roughmdr.cli.invocation import warn_of
from roughmdr.cli.options import FILE, OUTPUT, fresh_option
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="Page to write: .html.")
@fresh_option
def report(result: Path, output: Path, fresh: bool) -> None:
    """Write RESULT, or a fit, as one page of HTML.

    It shows pictures, errors, scene, provenance, and what to cite, and needs no other file. A page that is there
    already is replaced, since RESULT writes it again.
    """
    from roughmdr.pictures.request import drawable
    from roughmdr.report.page import check_page, write_page

    check_page(output, result, fresh=fresh)
    source = drawable(result)
    warn_of(result, source.doubt)
    write_page(source, output)
    print_text(f"report       {click.format_filename(output)}")
