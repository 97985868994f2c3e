"""The command line, thin over the library: a file for each command.

Exit status: 0 done, 1 runs failed or a batch had to stop, 2 wrong input, 130 interrupted.
"""

import click

from roughmdr.cli.cite import cite
from roughmdr.cli.export import export
from roughmdr.cli.fit import fit
from roughmdr.cli.generate import generate
from roughmdr.cli.info import info
from roughmdr.cli.join import join
from roughmdr.cli.new import new
from roughmdr.cli.plan import plan
from roughmdr.cli.plot import plot
from roughmdr.cli.report import report
from roughmdr.cli.run import run
from roughmdr.cli.schema import schema
from roughmdr.cli.terminal import Group
from roughmdr.cli.warm import warm


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="roughmdr")
def main() -> None:
    """Simulate the contact of rough surfaces, with and without adhesion.

    A scene file says what to compute; the result is a load-separation law. "roughmdr new" writes a scene to begin with.
    """


for command in (cite, export, fit, generate, info, join, new, plan, plot, report, run, schema, warm):
    main.add_command(command)
