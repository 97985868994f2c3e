"""The command line, thin over the library.

Exit status: 0 done, 1 runs failed or a batch had to stop, 2 wrong input, 130 interrupted.
"""

import gc
import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.report.terminal import INCOMPLETE, Group, print_text

if TYPE_CHECKING:
    from roughmdr.runner.backend import Backend
    from roughmdr.runner.cluster import Tls
    from roughmdr.storage.labelled import Labelled


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Suspend garbage collection during imports: it would take a tenth of their time and find nothing."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def _command_line() -> str:
    """Return the command as it is recorded in a file's history."""
    return f"roughmdr {shlex.join(sys.argv[1:])}".encode("utf-8", "replace").decode()


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="roughmdr")
def main() -> None:
    """Simulate the contact of rough surfaces, with and without adhesion.

    A scene file says what to compute; the result is a load-separation law. "roughmdr new" writes a scene to begin with.
    """


_FILE = click.Path(path_type=Path)
_OUTPUT = click.Path(dir_okay=False, path_type=Path)
_changes = click.option(
    "--set", "changes", multiple=True, metavar="KEY=VALUE", help="Set a key of the scene; repeatable."
)
_fresh = click.option("--fresh", is_flag=True, help="Replace an existing output of any kind.")
_workers = click.option(
    "--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Number of threads or processes."
)


@main.command()
@click.argument("scene", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="netCDF file to write.")
@_changes
@_workers
@click.option(
    "--scheduler",
    default="threads",
    show_default=True,
    metavar="threads|processes|tcp://HOST:PORT|tls://HOST:PORT",
    help="Compute on this machine, or on the dask cluster with its scheduler at this address.",
)
@click.option("--tls-ca", type=_FILE, help="For tls://: certificate of the authority (PEM).")
@click.option("--tls-cert", type=_FILE, help="For tls://: certificate of this client (PEM).")
@click.option("--tls-key", type=_FILE, help="For tls://: key of this client (PEM).")
@click.option(
    "--resume/--fresh",
    default=True,
    show_default=True,
    help="Reuse what the output or an interrupted run already contains, or start anew.",
)
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
@click.option("--verbose", is_flag=True, help="Also print what was left out, and why.")
def run(
    scene: Path, output: Path, changes: tuple[str, ...], resume: bool, quiet: bool, verbose: bool, **where: Any
) -> None:
    """Compute the load-separation law of SCENE.

    SCENE is a TOML file, or a result, which contains its scene. Finished runs are kept beside the output until all are
    done. If the command is interrupted or killed, or the disk is full, the same command continues from there. Ctrl-C
    waits for the current runs; a second Ctrl-C does not.
    """
    if quiet and verbose:
        raise click.UsageError("--quiet and --verbose exclude each other")
    started = time.perf_counter()
    with _without_garbage_collection():
        from roughmdr.report.summary import describe_failed, describe_result
        from roughmdr.scene import read

        validated = read(scene, changes)  # before anything heavy is imported
        from roughmdr.batch.plan import make_plan
        from roughmdr.runner.run import execute

        planned = make_plan(validated)
    result = execute(planned, output, _backend(**where), resume=resume, quiet=quiet, command=_command_line())
    if not quiet:
        print_text(describe_result(result, time.perf_counter() - started, left_out=verbose))
        print_text(f"result       {click.format_filename(output)}")
    if failed := describe_failed(result):
        if quiet:
            print_text(f"roughmdr: {failed}", err=True)
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


@main.command()
@click.argument("scene", type=_FILE)
@_changes
@_workers
def plan(scene: Path, changes: tuple[str, ...], workers: int) -> None:
    """Tell what a run of SCENE will do.

    Prints the number of runs and tasks, time and memory, and what is left out and why. Nothing is computed.
    """
    from roughmdr.report.summary import describe_plan
    from roughmdr.scene import read

    validated = read(scene, changes)
    from roughmdr.batch.estimate import estimate
    from roughmdr.batch.foresee import foresee_cells
    from roughmdr.batch.plan import make_plan

    planned = make_plan(validated)
    print_text(describe_plan(planned, estimate(planned, workers), foresee_cells(planned), workers))


@main.command()
@click.argument("result", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="Picture to write: .png, .pdf or .svg.")
@click.option("--variable", "variables", multiple=True, help="Variable to draw; repeatable. Default: all.")
@click.option("--with-expected", is_flag=True, help="Also draw the expected law of the scene.")
@click.option("--with-theory", is_flag=True, help="Also draw the theory curves that apply to the scene.")
@click.option("--with-reference", is_flag=True, help="Also draw the law by boundary elements that RESULT holds.")
@_fresh
def plot(result: Path, output: Path, variables: tuple[str, ...], fresh: bool, **overlays: bool) -> None:
    """Draw the load-separation law in RESULT.

    An existing picture of the same format is replaced, since RESULT draws it again.
    """
    from roughmdr.report.picture import check_picture, draw_result
    from roughmdr.report.plots import save
    from roughmdr.storage.result_file import read_result

    check_picture(output, [result], fresh=fresh)
    data = read_result(result)
    _warn_if_changed(result, data)
    picture = draw_result(data, variables, result, **overlays)
    for title, remark in picture.remarks:
        print_text(f"{title:<12} {remark}")
    save(picture.figure, output)
    print_text(f"picture      {click.format_filename(output)}")


@main.command()
@click.argument("result", type=_FILE)
@click.option("--cells", is_flag=True, help="List the cells of the sweep: status, time, errors, remarks.")
def info(result: Path, cells: bool) -> None:
    """Tell what RESULT contains.

    Prints sizes, the pull-off force with its error, run time, seed, versions and the scene.
    """
    from roughmdr.report.info import describe
    from roughmdr.storage.result_file import read_result

    data = read_result(result)
    _warn_if_changed(result, data)
    print_text(describe(data, result, cells=cells))


def _warn_if_changed(file: Path, result: "Labelled") -> None:
    """Print a warning if the numbers in a file cannot be trusted."""
    if fault := result.integrity_fault():
        print_text(f"roughmdr: {click.format_filename(file)}: {fault}", err=True)


@main.command()
@click.argument("scene", type=_OUTPUT)
def new(scene: Path) -> None:
    """Write a starter scene to SCENE. It runs as it is; its comments list units and choices."""
    from importlib.resources import files

    from roughmdr.errors import StoreError
    from roughmdr.storage.files import check_ending, check_writable, replace_atomically

    check_writable(scene)
    check_ending(scene, "scene", [".toml"])
    if scene.exists():
        raise StoreError(f"{scene}: exists already; give a new name")
    with replace_atomically(scene) as temporary:
        temporary.write_bytes(files("roughmdr").joinpath("starter.toml").read_bytes())
    print_text(f"scene        {click.format_filename(scene)}")


@main.command()
@click.argument("scene", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, help="netCDF file to write; not needed with --cutoffs.")
@click.option(
    "--realization", type=click.IntRange(0, 999_999_999), default=0, show_default=True, help="Which realisation."
)
@click.option("--cutoffs", metavar="LENGTHS", help='Of a map: tabulate its summits for cutoffs, as "0.2 um, 0.4 um".')
@_fresh
@_changes
def generate(
    scene: Path, output: Path | None, realization: int, cutoffs: str | None, fresh: bool, changes: tuple[str, ...]
) -> None:
    """Write the asperities of one realisation of SCENE.

    An existing file of asperities is left alone unless it holds the very ones.
    """
    from roughmdr.ensemble import make
    from roughmdr.report.summary import describe_ensemble
    from roughmdr.scene import read
    from roughmdr.storage.files import NETCDF_ENDINGS, check_ending, check_writable
    from roughmdr.storage.netcdf_writing import write_netcdf
    from roughmdr.storage.result_file import check_nothing_lost, check_same_kind, provenance

    validated = read(scene, changes)
    for axis in validated.sweep.axes:
        if axis.key.startswith("asperities."):
            raise SceneError(f"sweep: changes {axis.key} from cell to cell; choose one with --set {axis.key}=VALUE")
    if cutoffs is not None:
        from roughmdr.report.cutoffs import tabulate_cutoffs

        print_text(tabulate_cutoffs(validated, cutoffs))
    if output is None:
        if cutoffs is None:
            raise click.MissingParameter(param_hint="'-o' / '--output'", param_type="option")
        return
    if realization > 0 and not validated.asperities.is_random:
        raise SceneError(f"--realization {realization}: there is only realisation 0; nothing in this scene is random")
    check_writable(output, validated.inputs)
    check_ending(output, "file of asperities", NETCDF_ENDINGS)
    if not fresh:
        check_same_kind(output, "ensemble")
    ensemble = make(validated.asperities, validated.seed, realization).labelled()
    if not fresh:
        check_nothing_lost(output, ensemble)
    write_netcdf(ensemble._replace(attrs={**provenance(validated.title, _command_line()), **ensemble.attrs}), output)
    print_text(describe_ensemble(ensemble))
    print_text(f"ensemble     {click.format_filename(output)}")
