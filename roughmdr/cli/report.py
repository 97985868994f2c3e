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
    from roughmdr.report.page import check_page, page_of
    from roughmdr.storage.files import replace_atomically

    check_page(output, result, fresh=fresh)
    data = read_warned(result)
    with replace_atomically(output) as temporary:
        temporary.write_text(page_of(data, result), encoding="utf-8")
    print_text(f"report       {click.format_filename(output)}")
