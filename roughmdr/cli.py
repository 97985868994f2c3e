"""The command line, thin over the library. Exit status: 0 done, 2 wrong input, 130 interrupted, 1 anything else."""

import gc
import os
import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import click

from roughmdr.errors import Fault, RoughmdrError, SceneError

_WRONG_INPUT, _INTERRUPTED = 2, 130


class _Group(click.Group):
    """A command group that turns errors raised on purpose into messages."""

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except RoughmdrError as error:
            _stop(error)
        except (KeyboardInterrupt, click.Abort):
            click.echo("roughmdr: interrupted; nothing was written", err=True)
            # Threads may still compute, and none of them has anything on disk: leave without waiting for them.
            os._exit(_INTERRUPTED)


def _stop(error: RoughmdrError) -> NoReturn:
    """The message on the standard error stream; in colour where that is a terminal and NO_COLOR is not set."""
    faults = error.faults if isinstance(error, SceneError) else ()
    for line in map(_coloured, faults) if faults else str(error).splitlines():
        click.echo(f"roughmdr: {line}", err=True, color=False if os.environ.get("NO_COLOR") else None)
    sys.exit(_WRONG_INPUT)


def _coloured(fault: Fault) -> str:
    message, hint, name = fault.message.partition("did you mean")
    return str(
        fault._replace(
            place=fault.place and click.style(fault.place, bold=True),
            key=fault.key and click.style(fault.key, fg="cyan", bold=True),
            value=fault.value and click.style(fault.value, fg="red"),
            message=message + (hint and click.style(hint + name, fg="green")),
        )
    )


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


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="roughmdr")
def main() -> None:
    """Rough, multi-asperity contact, with and without adhesion: a scene in, a load-separation law out."""


_FILE = click.Path(path_type=Path)
_OUTPUT = click.Path(dir_okay=False, path_type=Path)
_changes = click.option(
    "--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the scene; repeatable."
)
_workers = click.option(
    "--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Number of threads."
)


@main.command()
@click.argument("scene", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The netCDF file to write.")
@_changes
@_workers
@click.option(
    "--scheduler", type=click.Choice(["threads"]), default="threads", expose_value=False, help="What runs the workers."
)
@click.option("--quiet", is_flag=True, help="Say nothing but errors.")
def run(scene: Path, output: Path, changes: tuple[str, ...], workers: int, quiet: bool) -> None:
    """Compute SCENE, a TOML file or a result that holds one, and write its load-separation law."""
    started = time.perf_counter()
    with _loading():
        from roughmdr.describe import describe_result
        from roughmdr.scene import read

        asked = read(scene, changes)  # before anything heavy is loaded
        from roughmdr.plan import make_plan, prepare_all
        from roughmdr.runner import execute

        planned = make_plan(asked)
        prepare_all(planned)
    result = execute(planned, output, workers=workers, quiet=quiet, command=_command())
    if not quiet:
        click.echo(describe_result(result, time.perf_counter() - started))
        click.echo(f"result       {click.format_filename(output)}")


@main.command()
@click.argument("scene", type=_FILE)
@_changes
@_workers
def plan(scene: Path, changes: tuple[str, ...], workers: int) -> None:
    """Say what a run of SCENE will do: tasks, time, memory, and what is left out and why. Nothing is written."""
    from roughmdr.describe import describe_plan
    from roughmdr.scene import read

    asked = read(scene, changes)
    from roughmdr.estimate import estimate
    from roughmdr.plan import make_plan

    planned = make_plan(asked)
    click.echo(describe_plan(planned, estimate(planned, workers), workers))


@main.command()
@click.argument("result", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The picture to write: .png, .pdf or .svg.")
@click.option("--variable", "variables", multiple=True, help="Draw this one; repeatable. Default: all.")
@click.option("--with-expected", is_flag=True, help="Draw the expected law of the scene as well.")
@click.option("--with-theory", is_flag=True, help="Draw the named laws as well that apply to the scene.")
def plot(result: Path, output: Path, variables: tuple[str, ...], with_expected: bool, with_theory: bool) -> None:
    """Draw the load-separation law in RESULT."""
    from roughmdr.plots import plot
    from roughmdr.store import check_writable, read
    from roughmdr.views import asked_variables

    check_writable(output, [result])
    data = read(result)
    names, lines = asked_variables(data, variables), []
    if with_expected or with_theory:
        from roughmdr.comparison import expected_law, named_laws, plan_of

        planned = plan_of(result, data)
        for wanted, title, compared in (
            (with_expected, "expected", expected_law),
            (with_theory, "theory", named_laws),
        ):
            if wanted:
                found = compared(planned, names)
                lines += found.lines
                for line in found.remarks:
                    click.echo(f"{title:<12} {line}")
    plot(data, output, names, lines)
    click.echo(f"picture      {click.format_filename(output)}")


@main.command()
@click.argument("result", type=_FILE)
def info(result: Path) -> None:
    """Say what RESULT holds: sizes, pull-off force with its error, seed, versions, time, and the scene."""
    from roughmdr.describe import describe_origin, describe_result
    from roughmdr.store import read

    data = read(result)
    click.echo(describe_result(data))
    click.echo(describe_origin(data, result.stat().st_size))


@main.command()
@click.argument("scene", type=_OUTPUT)
def new(scene: Path) -> None:
    """Write a starter scene to SCENE: it runs as it is, and its comments list units and choices."""
    from importlib.resources import files

    from roughmdr.errors import StoreError
    from roughmdr.store import check_writable, replacing

    check_writable(scene)
    if scene.exists():
        raise StoreError(f"{scene}: is there already; give a new name")
    with replacing(scene) as temporary:
        temporary.write_bytes(files("roughmdr").joinpath("starter.toml").read_bytes())
    click.echo(f"scene        {click.format_filename(scene)}")


@main.command()
@click.argument("scene", type=_FILE)
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The netCDF file to write.")
@click.option(
    "--realization", type=click.IntRange(0, 999_999_999), default=0, show_default=True, help="Which of the ensembles."
)
@_changes
def generate(scene: Path, output: Path, realization: int, changes: tuple[str, ...]) -> None:
    """Write the asperities that a run of SCENE presses on."""
    from roughmdr.describe import describe_ensemble
    from roughmdr.ensemble import make
    from roughmdr.scene import read
    from roughmdr.store import check_writable, provenance, write

    asked = read(scene, changes)
    for axis in asked.sweep.axes:
        if axis.key.startswith("asperities."):
            raise SceneError(f"sweep: changes {axis.key} from cell to cell; say which with --set {axis.key}=VALUE")
    if realization > 0 and not asked.asperities.drawn:
        raise SceneError(f"--realization {realization}: there is only one, 0; nothing here is drawn")
    check_writable(output, asked.inputs)
    made = make(asked.asperities, asked.seed, realization).labelled()
    write(made._replace(attrs={**provenance(asked.title, _command()), **made.attrs}), output)
    click.echo(describe_ensemble(made))
    click.echo(f"ensemble     {click.format_filename(output)}")
