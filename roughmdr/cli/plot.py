"""roughmdr plot: draw a result."""

from pathlib import Path
from typing import Any

import click

from roughmdr.cli.invocation import warn_of
from roughmdr.cli.options import FILE, OUTPUT, fresh_option, pairs
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("file", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="Picture to write: .png, .pdf or .svg.")
@click.option("--kind", metavar="KIND", help="law, sweep, map, asperity, convergence or fit. Default: what fits FILE.")
@click.option("--variable", "variables", multiple=True, help="Variable to draw; of a law repeatable. Default: all.")
@click.option("--x", metavar="NAME", help="Of a law: variable to draw over. Of a sweep: swept key along the axis.")
@click.option("--per-area", is_flag=True, help="Divide by the nominal area.")
@click.option("--log/--linear", default=None, help="Logarithmic axis or not. Default: where a law is exponential.")
@click.option(
    "--at", multiple=True, metavar="QUANTITY=VALUE", help='Of a sweep: where on the loading, as "force=1 mN".'
)
@click.option("--select", multiple=True, metavar="KEY=VALUE", help="Of a sweep: one value of a key; repeatable.")
@click.option("--step", metavar="STEP", help='Of a map or an asperity: step, from 0, or "pull-off".')
@click.option("--realization", type=click.IntRange(min=0), help="Of a map or an asperity: realisation, from 0.")
@click.option("--asperity", type=click.IntRange(min=0), help="Of an asperity: its number, from the highest down.")
@click.option("--with-expected", is_flag=True, help="Also draw the expected law; of pairs as if independent.")
@click.option("--with-theory", is_flag=True, help="Also draw the theory curves that apply to the scene.")
@click.option("--with-reference", is_flag=True, help="Also draw the law by boundary elements that FILE holds.")
@click.option("--style", metavar="STYLE", help="Style of matplotlib: its name or file.")
@fresh_option
def plot(file: Path, output: Path, style: str | None, fresh: bool, at: tuple[str, ...], **options: Any) -> None:
    """Draw what FILE holds: a result, asperities or a fit.

    Of a result the law is drawn, or, of a sweep of many cells, the pull-off against what was swept. An existing picture
    of the same format is replaced, since FILE draws it again.
    """
    from roughmdr.pictures.kinds import draw_request
    from roughmdr.pictures.request import Request, drawable
    from roughmdr.pictures.style import PICTURE_ENDINGS, save, styled
    from roughmdr.storage.result_file import check_output

    check_output(output, "picture", PICTURE_ENDINGS, [file], fresh=fresh)
    options["variables"] = tuple(options["variables"])
    if (step := options["step"]) is not None and step.isdigit():
        options["step"] = int(step)
    options["select"] = pairs("--select", options["select"])
    options["at"] = pairs("--at", at)
    source = drawable(file)
    warn_of(file, source.doubt)
    with styled(style):
        picture = draw_request(source, Request(**options))
        for title, remark in picture.remarks:
            print_text(f"{title:<12} {remark}")
        save(picture.figure, output)
    print_text(f"picture      {click.format_filename(output)}")
