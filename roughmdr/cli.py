"""The command line, thin over the library.

Exit status: 0 done, 2 wrong input, 130 interrupted; 1 anything else: runs failed, or what was begun could not go on.
"""

import gc
import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.report.terminal import NOT_ALL, Group, say

if TYPE_CHECKING:
    from roughmdr.runner.cluster import Tls
    from roughmdr.storage.labelled import Labelled


@contextmanager
def _loading() -> Iterator[None]:
    """No search for garbage while packages are loaded: they make many objects to keep, and a tenth of the time goes."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def _command() -> str:
    """What goes into a file's history."""
    return f"roughmdr {shlex.join(sys.argv[1:])}".encode("utf-8", "replace").decode()


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="roughmdr")
def main() -> None:
    """Rough, multi-asperity contact, with and without adhesion: a scene in, a load-separation law out."""


_FILE = click.Path(path_type=Path)
_OUTPUT = click.Path(dir_okay=False, path_type=Path)
_changes = click.option(
    "--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the scene; repeatable."
)
_fresh = click.option("--fresh", is_flag=True, help="Replace what is at the output, whatever it is.")
_workers = click.option(
    "--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Number of threads or processes."
)


@main.command()
@click.argument("scene", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The netCDF file to write.")
@_changes
@_workers
@click.option(
    "--scheduler",
    default="threads",
    show_default=True,
    metavar="threads|processes|tcp://HOST:PORT|tls://HOST:PORT",
    help="What computes: this machine, or the dask cluster whose scheduler is there.",
)
@click.option("--tls-ca", type=_FILE, help="For tls://: the certificate of the authority (PEM).")
@click.option("--tls-cert", type=_FILE, help="For tls://: the certificate of this client (PEM).")
@click.option("--tls-key", type=_FILE, help="For tls://: its key (PEM).")
@click.option(
    "--resume/--fresh",
    default=True,
    show_default=True,
    help="Use again what the output holds already or an interrupted run kept, or start anew.",
)
@click.option("--quiet", is_flag=True, help="Say nothing but errors.")
def run(
    scene: Path,
    output: Path,
    changes: tuple[str, ...],
    workers: int,
    scheduler: str,
    tls_ca: Path | None,
    tls_cert: Path | None,
    tls_key: Path | None,
    resume: bool,
    quiet: bool,
) -> None:
    """Compute SCENE, a TOML file or a result that holds one, and write its load-separation law.

    Finished runs are kept beside the output until all are done: interrupted, killed or out of room, the same command
    goes on from there. Ctrl-C finishes what is under way; twice, it does not.
    """
    started = time.perf_counter()
    with _loading():
        from roughmdr.report.words import describe_failed, describe_result
        from roughmdr.scene import read

        asked = read(scene, changes)  # before anything heavy is loaded
        from roughmdr.batch.plan import make_plan
        from roughmdr.runner.backend import Backend
        from roughmdr.runner.run import execute

        planned = make_plan(asked)
    result = execute(
        planned,
        output,
        Backend(scheduler, workers, _tls(tls_ca, tls_cert, tls_key)),
        resume=resume,
        quiet=quiet,
        command=_command(),
    )
    if not quiet:
        say(describe_result(result, time.perf_counter() - started))
        say(f"result       {click.format_filename(output)}")
    if failed := describe_failed(result):
        if quiet:
            say(f"roughmdr: {failed}", err=True)
        sys.exit(NOT_ALL)


def _tls(ca: Path | None, cert: Path | None, key: Path | None) -> "Tls | None":
    """What --tls-ca, --tls-cert and --tls-key say; None where they say nothing."""
    if ca is None and cert is None and key is None:
        return None
    if ca is None or cert is None or key is None:
        raise RoughmdrError("--tls-ca, --tls-cert and --tls-key go together")
    from roughmdr.runner.cluster import Tls

    return Tls(str(ca), str(cert), str(key))


@main.command()
@click.argument("scene", type=_FILE)
@_changes
@_workers
def plan(scene: Path, changes: tuple[str, ...], workers: int) -> None:
    """Say what a run of SCENE will do: tasks, time, memory, and what is left out and why. Nothing is written."""
    from roughmdr.report.words import describe_plan
    from roughmdr.scene import read

    asked = read(scene, changes)
    from roughmdr.batch.estimate import estimate
    from roughmdr.batch.plan import make_plan

    planned = make_plan(asked)
    say(describe_plan(planned, estimate(planned, workers), workers))


@main.command()
@click.argument("result", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The picture to write: .png, .pdf or .svg.")
@click.option("--variable", "variables", multiple=True, help="Draw this one; repeatable. Default: all.")
@click.option("--with-expected", is_flag=True, help="Draw the expected law of the scene as well.")
@click.option("--with-theory", is_flag=True, help="Draw the named laws as well that apply to the scene.")
@_fresh
def plot(
    result: Path, output: Path, variables: tuple[str, ...], with_expected: bool, with_theory: bool, fresh: bool
) -> None:
    """Draw the load-separation law in RESULT. A picture of the same kind is replaced."""
    from roughmdr.report.plots import format_of, plot
    from roughmdr.result.layout import asked_variables
    from roughmdr.storage.kinds import check_kind
    from roughmdr.storage.store import check_writable, read

    check_writable(output, [result])
    if not fresh:
        check_kind(output, format_of(output))
    data = read(result)
    _warn_of(result, data)
    names, lines = asked_variables(data, variables), []
    if with_expected or with_theory:
        from roughmdr.report.comparison import expected_law, named_laws, plan_of

        planned = plan_of(result, data)
        for wanted, title, compared in (
            (with_expected, "expected", expected_law),
            (with_theory, "theory", named_laws),
        ):
            if wanted:
                found = compared(planned, names)
                lines += found.lines
                for line in found.remarks:
                    say(f"{title:<12} {line}")
    plot(data, output, names, lines)
    say(f"picture      {click.format_filename(output)}")


@main.command()
@click.argument("result", type=_FILE)
@click.option("--cells", is_flag=True, help="List the cells: what became of each, time, errors, remarks.")
def info(result: Path, cells: bool) -> None:
    """Say what RESULT holds: sizes, pull-off force with its error, seed, versions, time, and the scene."""
    from roughmdr.storage.store import read

    data = read(result)
    _warn_of(result, data)
    if cells:
        from roughmdr.report.cells import describe_cells

        say(describe_cells(data))
        return
    from roughmdr.report.words import describe_origin, describe_result

    say(describe_result(data))
    say(describe_origin(data, result.stat().st_size))


def _warn_of(file: Path, result: "Labelled") -> None:
    """Say so where the numbers in a file are not to be believed."""
    if fault := result.what_was_changed():
        say(f"roughmdr: {click.format_filename(file)}: {fault}", err=True)


@main.command()
@click.argument("scene", type=_OUTPUT)
def new(scene: Path) -> None:
    """Write a starter scene to SCENE: it runs as it is, and its comments list units and choices."""
    from importlib.resources import files

    from roughmdr.errors import StoreError
    from roughmdr.storage.store import check_writable, replacing

    check_writable(scene)
    if scene.exists():
        raise StoreError(f"{scene}: is there already; give a new name")
    with replacing(scene) as temporary:
        temporary.write_bytes(files("roughmdr").joinpath("starter.toml").read_bytes())
    say(f"scene        {click.format_filename(scene)}")


@main.command()
@click.argument("scene", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The netCDF file to write.")
@click.option(
    "--realization", type=click.IntRange(0, 999_999_999), default=0, show_default=True, help="Which of the ensembles."
)
@_fresh
@_changes
def generate(scene: Path, output: Path, realization: int, fresh: bool, changes: tuple[str, ...]) -> None:
    """Write the asperities that a run of SCENE presses on. Other asperities are replaced."""
    from roughmdr.ensemble import make
    from roughmdr.report.words import describe_ensemble
    from roughmdr.scene import read
    from roughmdr.storage.kinds import check_kind
    from roughmdr.storage.store import check_writable, provenance, write

    asked = read(scene, changes)
    for axis in asked.sweep.axes:
        if axis.key.startswith("asperities."):
            raise SceneError(f"sweep: changes {axis.key} from cell to cell; say which with --set {axis.key}=VALUE")
    if realization > 0 and not asked.asperities.drawn:
        raise SceneError(f"--realization {realization}: there is only one, 0; nothing here is drawn")
    check_writable(output, asked.inputs)
    if not fresh:
        check_kind(output, "ensemble")
    made = make(asked.asperities, asked.seed, realization).labelled()
    write(made._replace(attrs={**provenance(asked.title, _command()), **made.attrs}), output)
    say(describe_ensemble(made))
    say(f"ensemble     {click.format_filename(output)}")
