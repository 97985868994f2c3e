"""All the studies that make the numbers trusted, one after the other, and a report of what came of them.

    python pipelines/studies.py -o results/studies

Writes NAME.nc and NAME.png of each study, and report.md.
"""

import subprocess
import sys
import time
from pathlib import Path

import click

from roughmdr.storage.atomic import replace_atomically

NAMES = ("work_precision", "stability", "left_out", "stated_error", "random_scenes")


def carried_out(name: str, output: Path, *, quick: bool) -> str | None:
    """What one study says, from a process of its own, None where it failed; its run time goes to the error stream."""
    started = time.perf_counter()
    command = [sys.executable, str(Path(__file__).with_name(f"{name}.py")), "-o", str(output)]
    done = subprocess.run([*command, *(["--quick"] if quick else [])], stdout=subprocess.PIPE, text=True, check=False)
    click.echo(f"{name}: {time.perf_counter() - started:.0f} s", err=True)
    return None if done.returncode else f"{done.stdout}\n![{name}]({name}.png)\n"


@click.command(help=(__doc__ or "").split("\n", maxsplit=1)[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="A reduced form of each: seconds, and rough figures.")
def main(output: Path, quick: bool) -> None:
    """Carry out all studies and write report.md; one that fails does not keep the others from it."""
    parts, failed = ["# What the studies found\n"], list[str]()
    for name in NAMES:
        part = carried_out(name, output, quick=quick)
        if part is None:
            failed.append(name)
        parts.append(f"## {name}\n\nfailed\n" if part is None else part)
        output.mkdir(parents=True, exist_ok=True)
        with replace_atomically(output / "report.md") as temporary:
            temporary.write_text("\n".join(parts))
    click.echo(output / "report.md")
    if failed:
        raise click.ClickException(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
