"""roughmdr cite: the papers behind a result or a scene."""

from pathlib import Path

import click

from roughmdr.cli.invocation import read_warned, warn_of
from roughmdr.cli.options import FILE
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("result", type=FILE)
@click.option("--bibtex", is_flag=True, help="Print entries of BibTeX.")
def cite(result: Path, bibtex: bool) -> None:
    """Name the papers behind RESULT.

    Those of all that it uses, and no others. RESULT may also be a scene (.toml) or a fit.
    """
    from roughmdr.report.cite import describe_papers
    from roughmdr.storage.result_file import is_fit

    data = None
    if result.suffix.lower() == ".toml":
        from roughmdr.scene import read

        scene = read(result).toml
    elif is_fit(result):
        from roughmdr.fitting.stored import read_fit

        fit = read_fit(result)
        warn_of(result, fit.integrity_fault())
        scene = fit.attrs["scene"]
    else:
        data = read_warned(result)
        scene = data.attrs["scene"]
    print_text(describe_papers(scene, data, bibtex=bibtex))
