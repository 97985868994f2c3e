"""roughmdr plot: draw a result."""

from pathlib import Path

import click

from roughmdr.cli.invocation import warn_if_changed
from roughmdr.cli.options import FILE, OUTPUT, fresh_option
from roughmdr.report.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option("-o", "--output", type=OUTPUT, required=True, help="Picture to write: .png, .pdf or .svg.")
@click.option("--variable", "variables", multiple=True, help="Variable to draw; repeatable. Default: all.")
@click.option("--with-expected", is_flag=True, help="Also draw the expected law of the scene.")
@click.option("--with-theory", is_flag=True, help="Also draw the theory curves that apply to the scene.")
@click.option("--with-reference", is_flag=True, help="Also draw the law by boundary elements that RESULT holds.")
@fresh_option
def plot(result: Path, output: Path, variables: tuple[str, ...], fresh: bool, **overlays: bool) -> None:
    """Draw the load-separation law in RESULT.

    An existing picture of the same format is replaced, since RESULT draws it again.
    """
    from roughmdr.pictures.law import save
    from roughmdr.pictures.plot import check_picture, draw_result
    from roughmdr.storage.result_file import read_result

    check_picture(output, [result], fresh=fresh)
    data = read_result(result)
    warn_if_changed(result, data)
    picture = draw_result(data, variables, result, **overlays)
    for title, remark in picture.remarks:
        print_text(f"{title:<12} {remark}")
    save(picture.figure, output)
    print_text(f"picture      {click.format_filename(output)}")
