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

    if result.suffix.lower() == ".toml":
        from roughmdr.scene import read

        print_text(describe_papers(read(result).toml, None, bibtex=bibtex))
        return
    from roughmdr.storage.result_file import is_fit

    if is_fit(result):
        from roughmdr.fitting.stored import read_fit

        fit = read_fit(result)
        warn_of(result, fit.integrity_fault())
        print_text(describe_papers(fit.attrs["scene"], None, bibtex=bibtex))
        return
    data = read_warned(result)
    print_text(describe_papers(data.attrs["scene"], data, bibtex=bibtex))
