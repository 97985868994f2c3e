"""Run all studies one after the other and write a report: python pipelines/all_studies.py -o results/studies."""

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import click
from studies.study import OUTPUT, QUICK, REDUCED, table

from roughmdr.storage.files import replace_atomically

NAMES = (
    "work_precision", "coupling", "stability", "left_out", "stated_error", "random_scenes", "versus_bem",
    "conductance", "versus_adhesive_bem", "coupled_pull_off", "hills", "adhesive_hills", "spectrum", "trust", "traps",
)  # fmt: skip


class Done(NamedTuple):
    """A study that has been run."""

    name: str
    seconds: float
    text: str
    """What it printed; nothing where it failed."""

    @property
    def row(self) -> list[str]:
        """Its row in the table at the head of the report."""
        reduced = [line.removeprefix(REDUCED) for line in self.text.splitlines() if line.startswith(REDUCED)]
        return [self.name, f"{self.seconds:.0f}", "".join(reduced) or ("all" if self.text else "failed")]

    @property
    def part(self) -> str:
        """Its part of the report."""
        return f"{self.text}\n![{self.name}]({self.name}.png)\n" if self.text else f"## {self.name}\n\nfailed\n"


def run(name: str, output: Path, quick: bool) -> Done:
    """Run a study in a process of its own, where BLAS has one thread: several take longer for small matrices."""
    command = [sys.executable, str(Path(__file__).with_name(f"{name}.py")), "-o", str(output), *["--quick"] * quick]
    started = time.perf_counter()
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    return Done(name, time.perf_counter() - started, "" if done.returncode else done.stdout)


def report(done: list[Done], quick: bool) -> str:
    """Return the time of each study and what it has of its full form, and then what each study found."""
    form = "in reduced forms; `make studies-full` carries out all of each" if quick else "in full"
    head = f"# Results of the studies\n\n{sum(one.seconds for one in done):.0f} s, {form}.\n"
    times = f"{table(['study', 's', 'carried out'], [one.row for one in done])}\n"
    return "\n".join([head, times, *(one.part for one in done)])


@click.command(help=__doc__)
@OUTPUT
@QUICK
def main(output: Path, quick: bool) -> None:
    """Write NAME.nc and NAME.png of each study, and report.md after each; go on where one fails."""
    output.mkdir(parents=True, exist_ok=True)
    done = list[Done]()
    for name in NAMES:
        done.append(run(name, output, quick))
        click.echo(f"{name}: {done[-1].seconds:.0f} s", err=True)
        with replace_atomically(output / "report.md") as temporary:
            temporary.write_text(report(done, quick))
    click.echo(output / "report.md")
    failed = [one.name for one in done if not one.text]
    if failed:
        raise click.ClickException(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
