"""The framework of a study or a figure: measure into NAME.nc, draw PNG files, and report in Markdown."""

import math
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import xarray as xr

from roughmdr.errors import LimitWarning
from roughmdr.storage.files import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf
from roughmdr.storage.result_file import provenance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
else:  # matplotlib is loaded where something is drawn
    Axes = Figure = Any

__all__ = ["Axes", "Draw", "Figure", "Study", "blank", "in_two_processes", "named", "table", "timed",
           "without_limits"]  # fmt: skip
Draw: TypeAlias = Callable[[xr.Dataset], Figure]
REDUCED = "Reduced form: "  # begins the line of a report that says what its study leaves out


class Study(NamedTuple):
    """A study or a figure, given by its functions."""

    name: str  # name of its command and of its files
    title: str
    measure: Callable[[bool], xr.Dataset]  # return all numbers; a reduced form, in seconds, where the argument is true
    draw: Draw | dict[str, Draw]  # the picture NAME.png, or pictures by their names
    report: Callable[[xr.Dataset], str]  # return a few sentences and tables in Markdown
    reduced: str  # part of the full form that the reduced one has

    def carry_out(self, output: Path, quick: bool) -> str:
        """Measure, write all files to the folder ``output``, and return the report; all say where they are reduced."""
        output.mkdir(parents=True, exist_ok=True)
        words = f"{REDUCED}{self.reduced}." if quick else ""
        result = self.measure(quick)
        result = result.assign_attrs(
            provenance(self.title, f"study.py {self.name}"), **{"comment": words} if quick else {}
        )
        write_netcdf(Labelled.of(result), output / f"{self.name}.nc")
        pictures = self.draw if isinstance(self.draw, dict) else {self.name: self.draw}
        for name, draw in pictures.items():
            with replace_atomically(output / f"{name}.png") as temporary:
                figure = draw(result)
                figure.text(0.5, 0.0, words, ha="center", va="top", color="tab:red")  # below all that is drawn
                figure.savefig(temporary, dpi=160, format="png", bbox_inches="tight" if quick else None)
        links = " ".join(f"![{name}]({name}.png)" for name in pictures)
        return "\n\n".join(filter(None, (f"## {self.title}", words, self.report(result).strip(), links))) + "\n"


def in_two_processes(function: Callable[[Any], Any], items: Iterable[Any], chunksize: int = 1) -> list[Any]:
    """Return what a function makes of each item, in two processes that begin anew."""
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        return list(pool.map(function, items, chunksize=chunksize))


def timed(action: Callable[[], Any], repeats: int = 1, enough: float = math.inf) -> tuple[Any, float]:
    """Return what an action returns, and the shortest of some run times [s], of those that begin within ``enough``."""
    seconds = list[float]()
    while len(seconds) < repeats and sum(seconds) < enough:
        started = time.perf_counter()
        found = action()
        seconds.append(time.perf_counter() - started)
    return found, min(seconds)


@contextmanager
def without_limits() -> Iterator[None]:
    """Leave warnings unsaid of slopes and the like, which say nothing of the numbers that are compared."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        yield


def blank(width: float, height: float) -> Figure:
    """Return an empty figure of a size [inches]."""
    from matplotlib import figure

    return figure.Figure(figsize=(width, height), layout="constrained")


def named(long_name: str, units: str = "1") -> dict[str, str]:
    """Return the attributes of a variable."""
    return {"units": units, "long_name": long_name}


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
