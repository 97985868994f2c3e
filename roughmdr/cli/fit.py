"""roughmdr fit: fit parameters of a scene to a measured curve."""

from pathlib import Path

import click

from roughmdr.cli.invocation import command_line
from roughmdr.cli.options import FILE, OUTPUT, changes_option, fresh_option
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("measured", type=FILE)
@click.argument("scene", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="netCDF file to write.")
@click.option(
    "--free",
    required=True,
    metavar="KEY,...",
    help='Keys of the scene to fit; "offset" is the zero of the separations.',
)
@changes_option
@fresh_option
def fit(measured: Path, scene: Path, output: Path, free: str, changes: tuple[str, ...], fresh: bool) -> None:
    """Fit parameters of SCENE to a measured curve.

    The curve is that in MEASURED, the law the expected one of SCENE.

    MEASURED is CSV with columns such as "separation [um]", "remote [um]" of a machine's spring or "piezo [um]" behind a
    cantilever (remote is minus that), and "force [mN]" or "pressure [kPa]", in the order of the measurement, loading
    then unloading; "force_error [mN]" weights the points.
    SCENE gives all else and the values to start from. The fitted scene is in the output: "roughmdr run" computes it.
    """
    from roughmdr.fitting.fit import fit_labelled
    from roughmdr.fitting.words import describe_fit

    keys = [key.strip() for key in free.split(",") if key.strip()]
    result = fit_labelled(measured, scene, keys, output, changes=changes, fresh=fresh, command=command_line())
    print_text(describe_fit(result))
    print_text(f"fit          {click.format_filename(output)}")
