"""Run all studies one after the other and write a report of their results."""

import subprocess
import sys
import time
from pathlib import Path

import click

from roughmdr.storage.files import replace_atomically
from studies.study import OUTPUT, QUICK

NAMES = ("work_precision", "stability", "left_out", "stated_error", "random_scenes")
COMMANDS = Path(__file__).parents[1]


def report_of(name: str, output: Path, *, quick: bool) -> str | None:
    """Return the report of one study, run in a process of its own, or None where it failed; print its run time."""
    started = time.perf_counter()
    command = [sys.executable, str(COMMANDS / f"{name}.py"), "-o", str(output), *(["--quick"] if quick else [])]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    click.echo(f"{name}: {time.perf_counter() - started:.0f} s", err=True)
    return None if done.returncode else f"{done.stdout}\n![{name}]({name}.png)\n"


@click.command(help=__doc__)
@OUTPUT
@QUICK
def main(output: Path, quick: bool) -> None:
    """Write NAME.nc and NAME.png of each study, and report.md after each; go on where one fails."""
    output.mkdir(parents=True, exist_ok=True)
    parts, failed = ["# Results of the studies\n"], list[str]()
    for name in NAMES:
        part = report_of(name, output, quick=quick)
        if part is None:
            failed.append(name)
        parts.append(part or f"## {name}\n\nfailed\n")
        with replace_atomically(output / "report.md") as temporary:
            temporary.write_text("\n".join(parts))
    click.echo(output / "report.md")
    if failed:
        raise click.ClickException(f"failed: {', '.join(failed)}")
