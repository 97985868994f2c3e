"""roughmdr export: write the law of a result as a table for a finite-element code."""

from pathlib import Path

import click

from roughmdr.cli.invocation import read_warned
from roughmdr.cli.options import FILE, OUTPUT, fresh_option, pairs
from roughmdr.cli.terminal import Command, print_note, print_text


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option(
    "-o", "--output", type=OUTPUT, required=True, help="File to write: .inp, .mac, .i, .h, .table, .csv or .json."
)
@click.option("--to", required=True, metavar="FORMAT", help="abaqus, calculix, moose, ansys, lammps, c, csv or json.")
@click.option(
    "--quantity",
    default="pressure",
    show_default=True,
    metavar="QUANTITY",
    help="pressure, area, force or loss over the overclosure, conductance or tangential over the pressure, or nodes.",
)
@click.option("--units", default="", metavar="NAMES", help='Length, force and stress, as "mm,N,MPa". Default: SI.')
@click.option("--branch", default="loading", show_default=True, metavar="BRANCH", help="loading or unloading.")
@click.option(
    "--error",
    type=float,
    default=1e-3,
    show_default=True,
    help="Of lines between the points: over the value, below a tenth of the largest over that tenth.",
)
@click.option("--distance", default="", metavar="LENGTH", help="For lammps: of two centres at zero separation.")
@click.option("--select", "selected", multiple=True, metavar="KEY=VALUE", help="Of a sweep: one cell; repeatable.")
@fresh_option
def export(result: Path, output: Path, selected: tuple[str, ...], fresh: bool, **options: str | float) -> None:
    """Write the law of RESULT as a table for a finite-element code, or a function in C.

    It is the mean law per nominal area over the realisations, or the expected one, from first touch on, with as few
    points as the error takes; its header says within which errors it holds. "force" is the whole law of a body, "loss"
    the energy that loops of the path lose, "nodes" are a few asperities whose sum is the expected law. An exported
    file that is there already is replaced, since RESULT gives it again.
    """
    from roughmdr.report.export.write import Export, check_export, document_of, write

    asked = Export(select=pairs("--select", selected), **options)  # type: ignore[arg-type]  # names and types of click
    check_export(output, result, asked, fresh=fresh)
    data = read_warned(result)
    document, told = document_of(data, result, asked)
    for warning in told:
        print_note(warning)
    write(document, output, asked)
    print_text(f"points       {document.header['points']}")
    print_text(f"export       {click.format_filename(output)}")
