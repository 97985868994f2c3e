"""Run all studies one after the other and write a report: python pipelines/all_studies.py -o results/studies."""

import subprocess
import sys
import time
from pathlib import Path

import click
from studies.study import OUTPUT, QUICK

from roughmdr.storage.files import replace_atomically

NAMES = (
    "work_precision", "coupling", "stability", "left_out", "stated_error", "random_scenes", "versus_bem",
    "conductance", "versus_adhesive_bem", "coupled_pull_off", "hills", "adhesive_hills", "spectrum", "trust", "traps",
)  # fmt: skip


@click.command(help=__doc__)
@OUTPUT
@QUICK
def main(output: Path, quick: bool) -> None:
    """Write NAME.nc and NAME.png of each study, run in a process of its own, and report.md after each.

    Go on where one fails.
    """
    output.mkdir(parents=True, exist_ok=True)
    forms = "Reduced forms; `make studies-full` carries out all of each study.\n" if quick else ""
    parts, failed = [f"# Results of the studies\n\n{forms}"], list[str]()
    for name in NAMES:
        started = time.perf_counter()
        command = [sys.executable, str(Path(__file__).with_name(f"{name}.py")), "-o", str(output)]
        done = subprocess.run([*command, *["--quick"] * quick], stdout=subprocess.PIPE, text=True, check=False)
        took = f"{name}: {time.perf_counter() - started:.0f} s"
        click.echo(took, err=True)
        if done.returncode:
            failed.append(name)
        parts.append(
            f"## {name}\n\nfailed\n" if done.returncode else f"{done.stdout}\n{took}\n\n![{name}]({name}.png)\n"
        )
        with replace_atomically(output / "report.md") as temporary:
            temporary.write_text("\n".join(parts))
    click.echo(output / "report.md")
    if failed:
        raise click.ClickException(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
