"""roughmdr run: compute the law of a scene."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roughmdr.cli.invocation import command_line, without_garbage_collection
from roughmdr.cli.options import FILE, OUTPUT, changes_option, json_option, workers_option
from roughmdr.cli.terminal import INCOMPLETE, Command, print_document, print_text
from roughmdr.errors import RoughmdrError

if TYPE_CHECKING:
    from roughmdr.runner.backend import Backend
    from roughmdr.runner.cluster import Tls


@click.command(cls=Command)
@click.argument("scene", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="netCDF file to write.")
@changes_option
@workers_option
@click.option(
    "--scheduler",
    default="threads",
    show_default=True,
    metavar="threads|processes|tcp://HOST:PORT|tls://HOST:PORT",
    help="Compute on this machine, or on the dask cluster with its scheduler at this address.",
)
@click.option("--tls-ca", type=FILE, help="For tls://: certificate of the authority (PEM).")
@click.option("--tls-cert", type=FILE, help="For tls://: certificate of this client (PEM).")
@click.option("--tls-key", type=FILE, help="For tls://: key of this client (PEM).")
@click.option(
    "--resume/--fresh",
    default=True,
    show_default=True,
    help="Reuse what the output or an interrupted run already contains, or start anew.",
)
@click.option("--derivatives", default="", metavar="KEYS", help="Numbers of the scene to differentiate the law by.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
@click.option("--verbose", is_flag=True, help="Also print what was left out, and why.")
@json_option
@click.pass_context
def run(
    ctx: click.Context, /, scene: Path, output: Path, changes: tuple[str, ...], resume: bool, **others: Any
) -> None:
    """Compute the load-separation law of SCENE.

    SCENE is a TOML file, or a result, which contains its scene. Finished runs are kept beside the output until all are
    done. If the command is interrupted or killed, or the disk is full, the same command continues from there. Ctrl-C
    waits for the current runs; a second Ctrl-C does not.
    """
    started = time.perf_counter()
    quiet, verbose, as_json = (others.pop(name) for name in ("quiet", "verbose", "as_json"))
    if quiet and verbose:
        raise click.UsageError("--quiet and --verbose exclude each other")
    with without_garbage_collection():
        from roughmdr.report.summary import describe_failed, describe_result
        from roughmdr.scene import read

        if keys := [key.strip() for key in others.pop("derivatives").split(",") if key.strip()]:
            changes = (*changes, f"output.derivatives={keys}")
        validated = read(scene, changes)  # before anything heavy is imported
        from roughmdr.batch.choose import plan_scene
        from roughmdr.result.view import ResultView
        from roughmdr.runner.run import execute

        planned = plan_scene(validated)
    silent = quiet or as_json
    done = execute(planned, output, _backend(**others), resume=resume, quiet=silent, command=command_line())
    result = ResultView(done)
    elapsed, failed = time.perf_counter() - started, describe_failed(result)
    if as_json:
        from roughmdr.report.documents import fault
        from roughmdr.report.result_document import result_table

        faults = [fault(failed)] if failed else []
        print_document(ctx, INCOMPLETE if failed else 0, faults=faults, result=result_table(result, output, elapsed))
    elif not quiet:
        print_text(describe_result(result, elapsed, left_out=verbose))
        print_text(f"result       {click.format_filename(output)}")
    elif failed:
        print_text(f"roughmdr: {failed}", err=True)
    if failed:
        sys.exit(INCOMPLETE)


def _backend(workers: int, scheduler: str, **tls_files: Path | None) -> "Backend":
    from roughmdr.runner.backend import Backend

    return Backend(scheduler, workers, _tls(**tls_files))


def _tls(**files: Path | None) -> "Tls | None":
    """Return the TLS files, None if none is given; RoughmdrError if only some are."""
    given = {option.removeprefix("tls_"): str(file) for option, file in files.items() if file is not None}
    if not given:
        return None
    if len(given) < len(files):
        raise RoughmdrError("--tls-ca, --tls-cert and --tls-key must be given together")
    from roughmdr.runner.cluster import Tls

    return Tls(**given)
