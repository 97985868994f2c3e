"""roughmdr info: tell what a result contains, or how far a batch is."""

import math
import os
import time
from contextlib import suppress
from pathlib import Path

import click

from roughmdr.cli.invocation import read_warned, warn_of
from roughmdr.cli.options import FILE, json_option
from roughmdr.cli.terminal import Command, print_document, print_text
from roughmdr.errors import StoreError

_PAUSE = 1.0  # time [s] between two looks at a batch
_MORE = 1.1  # factor by which runs are more before the law so far is told again


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option("--cells", is_flag=True, help="List the cells of the sweep: status, time, errors, remarks.")
@click.option("--follow", is_flag=True, help="Tell how far a batch is, and its law so far, until it ends.")
@json_option
@click.pass_context
def info(ctx: click.Context, result: Path, cells: bool, follow: bool, as_json: bool) -> None:
    """Tell what RESULT contains.

    Prints sizes, the pull-off force with its error, run time, seed, versions and the scene. RESULT may also be
    OUT.nc.parts, while a run is at work or after it was interrupted: prints how far it is. Where only parts of a batch
    are there (--part), prints how far each is.
    """
    if follow:
        if as_json:
            raise click.UsageError("--follow and --json exclude each other")
        result = _follow(result)
    if result.name.endswith(".parts") and result.is_dir():
        _info_parts(ctx, result, cells=cells, as_json=as_json)
        return
    if _is_missing(result):
        from roughmdr.batch.resume.share import Share
        from roughmdr.storage.files import destination

        output, parts = destination(result), result.with_name(f"{result.name}.parts")
        if os.path.isdir(parts):
            raise StoreError(f"{result}: is not written yet; what is finished is told by: roughmdr info {parts}")
        if (shares := Share.all_beside(output)) and not as_json:
            from roughmdr.report.parts import describe_shares

            print_text(describe_shares([share.folder(output) for share in shares]))
            return
    from roughmdr.report.summary import describe
    from roughmdr.storage.result_file import is_fit

    if not as_json and is_fit(result):
        from roughmdr.fitting.stored import read_fit
        from roughmdr.fitting.words import describe_fit

        fit = read_fit(result)
        warn_of(result, fit.integrity_fault())
        print_text(describe_fit(fit))
        return

    data = read_warned(result)
    if as_json:
        from roughmdr.report.result_document import result_table

        print_document(ctx, result=result_table(data, result))
    else:
        print_text(describe(data, result, cells=cells))


def _follow(result: Path) -> Path:
    """Print how far a batch is until no run is at work; return its result, or the folder of its parts without one."""
    from roughmdr.batch.resume.kept import Kept, SoFar, progress_of
    from roughmdr.batch.resume.manifest import MANIFEST
    from roughmdr.batch.resume.store import store_folder
    from roughmdr.report.parts import describe_progress, law_lines
    from roughmdr.schema.wording import format_table
    from roughmdr.storage.files import destination

    folder = result if result.name.endswith(".parts") else store_folder(destination(result))
    output = folder.with_name(folder.name.removesuffix(".parts"))
    so_far, first, started, last, told = None, 0, 0.0, "", 0
    while os.path.isdir(folder):
        try:
            kept = Kept(folder)
        except StoreError:  # it has just ended
            break
        if so_far is None and (kept.scene or kept.holder is None):
            so_far, first, started = SoFar(progress_of(kept)), kept.runs, time.monotonic()
        if so_far is not None:
            done = kept.runs - first
            line = describe_progress(kept, so_far.progress, (time.monotonic() - started) / done if done else math.inf)
            if line != last:
                print_text(line)
                last = line
            law = None if kept.holder is None else so_far.law(kept)  # else it is told at the end
            if law is not None and law.moments.size > _MORE * told:
                print_text(format_table(law_lines(so_far.progress, law)))
                told = law.moments.size
        if kept.holder is None:
            with suppress(OSError):  # the result was written, though runs failed
                if output.stat().st_mtime >= (folder / MANIFEST).stat().st_mtime:
                    return output
            return folder
        time.sleep(_PAUSE)
    return output if output.exists() else result


def _is_missing(path: Path) -> bool:
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return True
    except (OSError, ValueError):  # a circle of links, or a name that is too long or has NUL: reading tells which
        pass
    return False


def _info_parts(ctx: click.Context, folder: Path, *, cells: bool, as_json: bool) -> None:
    from roughmdr.batch.resume.kept import Kept
    from roughmdr.report.parts import describe_parts, parts_table

    kept = Kept(folder)
    if as_json:
        print_document(ctx, parts=parts_table(kept))
    else:
        print_text(describe_parts(kept, cells=cells))
