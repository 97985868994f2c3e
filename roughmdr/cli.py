"""The command line, thin over the library. Exit status: 0 done, 2 wrong input, 130 interrupted, 1 anything else."""

import os
import shlex
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from roughmdr.errors import RoughmdrError

if TYPE_CHECKING:
    import xarray as xr

_WRONG_INPUT, _INTERRUPTED = 2, 130


class _Group(click.Group):
    """A command group that turns errors raised on purpose into messages."""

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except RoughmdrError as error:
            _stop(f"roughmdr: {error}".replace("\n", "\nroughmdr: "), _WRONG_INPUT)
        except (KeyboardInterrupt, click.Abort):
            click.echo("roughmdr: interrupted; nothing was written", err=True)
            # Threads may still compute, and none of them has anything on disk: leave without waiting for them.
            os._exit(_INTERRUPTED)


def _stop(message: str, status: int) -> NoReturn:
    click.echo(message, err=True)
    sys.exit(status)


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="roughmdr")
def main() -> None:
    """Rough, multi-asperity contact, with and without adhesion: a scene in, a load-separation law out."""


_OUTPUT = click.Path(dir_okay=False, path_type=Path)


@main.command()
@click.argument("scene", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The netCDF file to write.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the scene; repeatable.")
@click.option("--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Number of threads.")
@click.option(
    "--scheduler", type=click.Choice(["threads"]), default="threads", expose_value=False, help="What runs the workers."
)
@click.option("--quiet", is_flag=True, help="Say nothing but errors.")
def run(scene: Path, output: Path, changes: tuple[str, ...], workers: int, quiet: bool) -> None:
    """Compute SCENE and write its load-separation law."""
    from roughmdr.plan import make_plan
    from roughmdr.runner import execute
    from roughmdr.scene import read

    started = time.perf_counter()
    command = "roughmdr " + shlex.join(sys.argv[1:])
    result = execute(make_plan(read(scene, changes)), output, workers=workers, quiet=quiet, command=command)
    if not quiet:
        click.echo(_summary(result.to_xarray(), time.perf_counter() - started))
        click.echo(f"result       {output}")


@main.command()
@click.argument("result", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=_OUTPUT, required=True, help="The picture to write: .png, .pdf or .svg.")
@click.option("--variable", "variables", multiple=True, help="Draw this one; repeatable. Default: all.")
def plot(result: Path, output: Path, variables: tuple[str, ...]) -> None:
    """Draw the load-separation law in RESULT."""
    from roughmdr.plots import plot
    from roughmdr.store import read

    plot(read(result).to_xarray(), output, list(variables))
    click.echo(f"picture      {output}")


def _summary(result: "xr.Dataset", elapsed: float) -> str:
    from roughmdr.analysis import pull_off_force

    count, steps = result.sizes["realization"], result.sizes["step"]
    held = [str(name) for name in result.data_vars if result[name].dims == ("realization", "step")]
    size = f"{count} realisation{'s' * (count > 1)} x {steps} steps"
    lines = [f"computed     {result.attrs['title']}: {size}; {', '.join(held)}"]
    if "force" in held:
        pull_off = pull_off_force(result)
        if pull_off.mean == 0.0:
            text = "none: the force is never tensile on this path"
        elif count == 1:
            text = f"{pull_off.mean:.4g} N (one realisation: no standard error)"
        else:
            error = f"{pull_off.standard_error:.2g}"
            text = f"{pull_off.mean:.4g} N ± {error} N (mean and standard error over {count} realisations)"
        lines.append(f"pull-off     {text}")
    lines.append(
        f"run time     {elapsed:.2f} s, of them {float(result['run_time'].sum()):.3g} s in the realisations; "
        f"numerical error at most {float(result['numerical_error'].max()):.1e} of the largest force"
    )
    left_out = result.attrs["left_out"].splitlines()
    return "\n".join([*lines, *(f"{'left out' if i == 0 else '':<12} {line}" for i, line in enumerate(left_out))])
