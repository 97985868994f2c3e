"""roughmdr generate: write the asperities of a scene."""

from pathlib import Path

import click

from roughmdr.cli.invocation import command_line
from roughmdr.cli.options import FILE, OUTPUT, changes_option, fresh_option
from roughmdr.cli.terminal import Command, print_text
from roughmdr.errors import SceneError


@click.command(cls=Command)
@click.argument("scene", type=FILE)
@click.option("-o", "--output", type=OUTPUT, help="netCDF file to write; not needed with --cutoffs.")
@click.option(
    "--realization", type=click.IntRange(0, 999_999_999), default=0, show_default=True, help="Which realisation."
)
@click.option("--cutoffs", metavar="LENGTHS", help='Of a map: tabulate its summits for cutoffs, as "0.2 um, 0.4 um".')
@fresh_option
@changes_option
def generate(
    scene: Path, output: Path | None, realization: int, cutoffs: str | None, fresh: bool, changes: tuple[str, ...]
) -> None:
    """Write the asperities of one realisation of SCENE.

    An existing file of asperities is left alone unless it holds the very ones.
    """
    from roughmdr.ensemble import make
    from roughmdr.report.summary import describe_ensemble
    from roughmdr.scene import read
    from roughmdr.storage.files import NETCDF_ENDINGS
    from roughmdr.storage.netcdf_store import write_netcdf
    from roughmdr.storage.result_file import check_nothing_lost, check_output, provenance

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
    check_output(output, "file of asperities", NETCDF_ENDINGS, validated.inputs, kind="ensemble", fresh=fresh)
    ensemble = make(validated.asperities, validated.seed, realization).labelled()
    if not fresh:
        check_nothing_lost(output, ensemble)
    write_netcdf(ensemble._replace(attrs={**provenance(validated.title, command_line()), **ensemble.attrs}), output)
    print_text(describe_ensemble(ensemble))
    print_text(f"ensemble     {click.format_filename(output)}")
