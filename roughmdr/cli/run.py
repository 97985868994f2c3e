"""roughmdr run: compute the law of a scene, or a part of its runs."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roughmdr.cli.invocation import command_line, without_garbage_collection
from roughmdr.cli.options import FILE, changes_option, json_option, workers_option
from roughmdr.cli.terminal import INCOMPLETE, Command, print_document, print_text
from roughmdr.errors import RoughmdrError

if TYPE_CHECKING:
    from roughmdr.batch.plan import Plan
    from roughmdr.batch.resume.share import Share
    from roughmdr.runner.backend import Backend
    from roughmdr.storage.labelled import Labelled


@click.command(cls=Command)
@click.argument("scene", type=FILE)
@click.option("-o", "--output", type=FILE, required=True, help="netCDF file, or Zarr store, to write.")
@changes_option
@workers_option
@click.option(
    "--scheduler",
    metavar="threads|processes|tcp://HOST:PORT|tls://HOST:PORT",
    help="Compute on this machine, or on the dask cluster with its scheduler at this address. Default: threads, or for "
    "long runs of asperities in pairs processes.",
)
@click.option("--tls-ca", "tls_ca_file", type=FILE, help="For tls://: certificate of the authority (PEM).")
@click.option("--tls-cert", "tls_client_cert", type=FILE, help="For tls://: certificate of this client (PEM).")
@click.option("--tls-key", "tls_client_key", type=FILE, help="For tls://: key of this client (PEM).")
@click.option(
    "--resume/--fresh",
    default=True,
    show_default=True,
    help="Reuse what the output or an interrupted run already contains, or start anew.",
)
@click.option("--part", metavar="NUMBER/COUNT", help="Compute this part of the runs only; see roughmdr join.")
@click.option("--derivatives", default="", metavar="KEYS", help="Numbers of the scene to differentiate the law by.")
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
@click.option("--verbose", is_flag=True, help="Also print what was left out, and why.")
@json_option
@click.pass_context
def run(
    ctx: click.Context,
    /,
    scene: Path,
    output: Path,
    changes: tuple[str, ...],
    resume: bool,
    part: str | None,
    **others: Any,
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
    quiet |= as_json
    with without_garbage_collection():
        from roughmdr.scene import read

        share = None if part is None else _share(part)
        if keys := [key.strip() for key in others.pop("derivatives").split(",") if key.strip()]:
            changes = (*changes, f"output.derivatives={keys}")
        validated = read(scene, changes)  # before anything heavy is imported
        from roughmdr.batch.choose import plan_scene
        from roughmdr.runner.run import execute

        planned = plan_scene(validated)
    options = {"resume": resume, "quiet": quiet, "command": command_line()}
    if share is not None:
        from roughmdr.runner.shares import compute_share

        part_done = compute_share(planned, output, share, backend(planned, **others), **options)
        _print_share(ctx, *part_done, quiet=quiet, as_json=as_json)
        return
    done = execute(planned, output, backend(planned, **others), **options)
    print_done(ctx, done, output, started, quiet=quiet, verbose=verbose, as_json=as_json)


def _share(text: str) -> "Share":
    from roughmdr.batch.resume.share import Share

    return Share.parse(text)


def _print_share(ctx: click.Context, folder: Path | None, failures: list[str], *, quiet: bool, as_json: bool) -> None:
    """Tell what is kept of a part of the runs; exit with status 1 if runs failed."""
    from roughmdr.batch.resume.kept import Kept
    from roughmdr.report.parts import describe_parts, parts_table

    kept = None if folder is None else Kept(folder)
    text = "kept         nothing: there are fewer runs than parts" if kept is None else describe_parts(kept)
    table = {"parts": kept and parts_table(kept)} if as_json else {}
    _end(ctx, f"{len(failures)} runs failed: {failures[0]}" if failures else "", "" if quiet else text, **table)


def print_done(
    ctx: click.Context, done: "Labelled", output: Path, started: float, *, quiet: bool, as_json: bool, verbose: bool
) -> None:
    """Tell what a result holds; exit with status 1 if runs failed."""
    from roughmdr.report.summary import describe_failed, describe_result
    from roughmdr.result.view import ResultView

    result, elapsed, text, table = ResultView(done), time.perf_counter() - started, "", dict[str, Any]()
    if as_json:
        from roughmdr.report.result_document import result_table

        table["result"] = result_table(result, output, elapsed)
    elif not quiet:
        told = describe_result(result, elapsed, left_out=verbose)
        text = f"{told}\nresult       {click.format_filename(output)}"
    _end(ctx, describe_failed(result), text, **table)


def _end(ctx: click.Context, failed: str, text: str, **table: Any) -> None:
    """Print a table for --json, else a text, else why runs failed; exit with status 1 if some did."""
    if table:
        from roughmdr.report.documents import fault

        print_document(ctx, INCOMPLETE if failed else 0, faults=[fault(failed)] if failed else [], **table)
    elif text:
        print_text(text)
    elif failed:
        print_text(f"roughmdr: {failed}", err=True)
    if failed:
        sys.exit(INCOMPLETE)


def backend(plan: "Plan", workers: int, scheduler: str | None, **tls: Path | None) -> "Backend":
    """Return where runs are computed, from the options of the command; RoughmdrError if some files of TLS lack."""
    from roughmdr.batch.estimate import suits_processes
    from roughmdr.runner.backend import Backend

    scheduler = scheduler or ("processes" if suits_processes(plan, workers) else "threads")
    given = {option: str(file) for option, file in tls.items() if file is not None}
    if 0 < len(given) < len(tls):
        raise RoughmdrError("--tls-ca, --tls-cert and --tls-key must be given together")
    return Backend(scheduler, workers, given)
