"""roughmdr join: put the parts of a batch together."""

import time
from pathlib import Path

import click

from roughmdr.cli.invocation import command_line, without_garbage_collection
from roughmdr.cli.options import FILE, fresh_option, json_option, workers_option
from roughmdr.cli.run import print_done
from roughmdr.cli.terminal import Command


@click.command(cls=Command)
@click.argument("output", type=FILE)
@workers_option
@fresh_option
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
@json_option
@click.pass_context
def join(ctx: click.Context, /, output: Path, workers: int, fresh: bool, quiet: bool, as_json: bool) -> None:
    """Write OUTPUT from the parts that "roughmdr run ... -o OUTPUT --part NUMBER/COUNT" has kept beside it.

    Names the parts that are missing or not done. Runs that failed are tried again. The numbers are those of one run of
    the whole batch, to the last bit.
    """
    started = time.perf_counter()
    with without_garbage_collection():
        from roughmdr.runner.backend import Backend
        from roughmdr.runner.shares import join as joined
    quiet |= as_json
    done = joined(output, Backend(workers=workers), fresh=fresh, quiet=quiet, command=command_line())
    print_done(ctx, done, output, started, quiet=quiet, as_json=as_json, verbose=False)
