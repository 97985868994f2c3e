"""Make a study, a figure or a benchmark: python pipelines/study.py NAME [--quick]; of all studies together with all."""

import os
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

import click
from studies.study import REDUCED, Study, table

from roughmdr.storage.files import replace_atomically

TOGETHER = (
    "work_precision", "coupling", "stability", "left_out", "stated_error", "random_scenes", "versus_bem",
    "conductance", "at_pressure", "versus_adhesive_bem", "coupled_pull_off", "hills", "adhesive_hills", "spectrum",
    "trust", "traps",
)  # fmt: skip
"""Studies that "all" carries out, one after the other."""
APART = ("accuracy", "asked", "asperity_error", "versus_lammps", "versus_saturated")
"""Studies that "all" leaves out."""
MODULES = {
    **{name: f"studies.{name}" for name in (*TOGETHER, *APART)},
    **{name: f"figures.{name}" for name in ("adhesion_range", "interaction", "one_asperity", "springs", "summits")},
    **{name: f"benchmarks.{name}" for name in ("batch", "foreseen", "scaling")},
}
"""Modules that hold a ``STUDY``, by its name."""


class Done(NamedTuple):
    """A study that has been run."""

    name: str
    seconds: float
    text: str  # printed report; empty where the study failed

    @property
    def row(self) -> list[str]:
        """Its row in the table at the head of the report."""
        reduced = [line.removeprefix(REDUCED) for line in self.text.splitlines() if line.startswith(REDUCED)]
        return [self.name, f"{self.seconds:.0f}", "".join(reduced) or ("all" if self.text else "failed")]


def study(name: str) -> Study:
    """Return a study by its name."""
    found: Study = import_module(MODULES[name]).STUDY
    return found


def run(name: str, output: Path, quick: bool) -> Done:
    """Run a study in a process of its own, where BLAS has one thread: several take longer for small matrices."""
    command = [sys.executable, __file__, name, "-o", str(output), *["--quick"] * quick]
    started = time.perf_counter()
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    return Done(name, time.perf_counter() - started, "" if done.returncode else done.stdout)


def report(done: list[Done], quick: bool) -> str:
    """Return the time of each study and what it has of its full form, and then what each study found."""
    form = "in reduced forms; `make studies-full` carries out all of each" if quick else "in full"
    head = f"# Results of the studies\n\n{sum(one.seconds for one in done):.0f} s, {form}.\n"
    times = f"{table(['study', 's', 'carried out'], [one.row for one in done])}\n"
    return "\n".join([head, times, *(one.text or f"## {one.name}\n\nfailed\n" for one in done)])


def run_all(output: Path, quick: bool) -> None:
    """Write the files of each study, and report.md after each; go on where one fails."""
    output.mkdir(parents=True, exist_ok=True)
    done = list[Done]()
    for name in TOGETHER:
        done.append(run(name, output, quick))
        click.echo(f"{name}: {done[-1].seconds:.0f} s", err=True)
        with replace_atomically(output / "report.md") as temporary:
            temporary.write_text(report(done, quick))
    click.echo(output / "report.md")
    failed = [one.name for one in done if not one.text]
    if failed:
        raise click.ClickException(f"failed: {', '.join(failed)}")


@click.command()
@click.argument("name", type=click.Choice([*MODULES, "all"]))
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"),
              show_default=True, help="Folder to write to.")  # fmt: skip
@click.option("--quick", is_flag=True, help="A reduced form, with rough figures, that says what it leaves out.")
def main(name: str, output: Path, quick: bool) -> None:
    """Write NAME.nc and any pictures of it, and print what was found; of all studies together, report.md as well."""
    if name == "all":
        run_all(output, quick)
    else:
        click.echo(study(name).carry_out(output, quick), nl=False)


if __name__ == "__main__":
    main()
