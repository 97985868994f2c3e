"""What a study is made of, and how it is carried out: numbers into NAME.nc, a picture into NAME.png, and words."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
import xarray as xr

from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Study(NamedTuple):
    """One study."""

    name: str
    """Of its script and of its files."""
    title: str
    measure: Callable[[bool], xr.Dataset]
    """All its numbers; in seconds, and roughly, where the argument is true."""
    draw: Callable[[xr.Dataset], "Figure"]
    tell: Callable[[xr.Dataset], str]
    """What came of it, in Markdown: a few sentences and tables."""

    def carry_out(self, output: Path, quick: bool) -> str:
        """Measure, write both files to a folder, and say what came of it."""
        output.mkdir(parents=True, exist_ok=True)
        result = self.measure(quick).assign_attrs(provenance(self.title, f"{self.name}.py"))
        write_netcdf(Labelled.of(result), output / f"{self.name}.nc")
        with replace_atomically(output / f"{self.name}.png") as temporary:
            self.draw(result).savefig(temporary, dpi=160, format="png")
        return f"## {self.title}\n\n{self.tell(result).strip()}\n"

    @property
    def command(self) -> click.Command:
        """The study as a command."""

        @click.command(help=self.title)
        @click.option(
            "-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies")
        )
        @click.option("--quick", is_flag=True, help="A reduced form: seconds, and rough figures.")
        def main(output: Path, quick: bool) -> None:
            click.echo(self.carry_out(output, quick), nl=False)

        return main


def named(text: str, units: str = "1") -> dict[str, str]:
    """The attributes of a variable."""
    return {"units": units, "long_name": text}


def table(head: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
