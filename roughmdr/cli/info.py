"""roughmdr info: tell what a result contains."""

from pathlib import Path

import click

from roughmdr.cli.invocation import warn_of
from roughmdr.cli.options import FILE, json_option
from roughmdr.report.terminal import Command, print_document, print_text


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option("--cells", is_flag=True, help="List the cells of the sweep: status, time, errors, remarks.")
@json_option
@click.pass_context
def info(ctx: click.Context, result: Path, cells: bool, as_json: bool) -> None:
    """Tell what RESULT contains.

    Prints sizes, the pull-off force with its error, run time, seed, versions and the scene.
    """
    from roughmdr.report.info import describe
    from roughmdr.storage.result_file import read_result

    data = read_result(result)
    warn_of(result, data.integrity_fault())
    if as_json:
        from roughmdr.report.result_document import result_table

        print_document(ctx, result=result_table(data, result))
    else:
        print_text(describe(data, result, cells=cells))
