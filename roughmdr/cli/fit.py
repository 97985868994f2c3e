"""roughmdr fit: fit parameters of a scene to a measured curve."""

import re
from pathlib import Path
from typing import Any

import click

from roughmdr.cli.invocation import command_line
from roughmdr.cli.options import FILE, OUTPUT, changes_option, fresh_option, pairs, workers_option
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("measured", type=FILE, nargs=-1, required=True)
@click.argument("scene", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="netCDF file to write.")
@click.option(
    "--free",
    required=True,
    metavar="KEY,...",
    help='Keys of the scene to fit; "offset" is the zero of the separations, "baseline" and "baseline_slope" are the '
    "line of the load without contact.",
)
@click.option("--shared", default="", metavar="KEY,...", help="Free keys that have one value for all curves.")
@click.option("--bounds", multiple=True, metavar="KEY=LOW..HIGH", help="Bounds of a free key; repeatable.")
@click.option(
    "--prior", "priors", multiple=True, metavar="KEY=MEAN+-STD", help="What is known of a free key; repeatable."
)
@click.option("--model", type=click.Choice(["auto"]), help="Choose the adhesion model by the curve.")
@click.option("--posterior", is_flag=True, help="Draw from the posterior too, some hundred times as long.")
@changes_option
@fresh_option
@workers_option
def fit(measured: tuple[Path, ...], scene: Path, output: Path, free: str, **others: Any) -> None:
    """Fit parameters of SCENE to a measured curve, or to each of many.

    The curve is that in MEASURED, the law the expected one of SCENE. Several files, or a column "curve" with names,
    give several curves.

    MEASURED is CSV with columns such as "separation [um]", "remote [um]" of a machine's spring or "piezo [um]" behind a
    cantilever (remote is minus that), and "force [mN]" or "pressure [kPa]", in the order of the measurement, loading
    then unloading; "force_error [mN]" weights the points. Or a text export of an AFM program.
    SCENE gives all else and the values to start from. The fitted scene is in the output: "roughmdr run" computes it.
    """
    from roughmdr.fitting.fit import FitOptions, fit_labelled
    from roughmdr.fitting.words import describe_fit

    keys, shared = ([key.strip() for key in each.split(",") if key.strip()] for each in (free, others.pop("shared")))
    known: dict[str, Any] = {
        option: {key: re.split(sign, str(each)) for key, each in pairs(f"--{name}", others.pop(option)).items()}
        for option, name, sign in (("bounds", "bounds", r"\.\."), ("priors", "prior", r"\+-|±"))
    }
    known |= {name: others.pop(name) for name in ("model", "posterior", "workers")}
    options = FitOptions(**known, shared=shared, quiet=False)
    curves = measured[0] if len(measured) == 1 else list(measured)
    result = fit_labelled(curves, scene, keys, output, options, command=command_line(), **others)
    print_text(describe_fit(result))
    print_text(f"fit          {click.format_filename(output)}")
