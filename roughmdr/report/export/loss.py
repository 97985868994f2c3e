"""The energy lost by loops of loading and unloading, over the overclosure at which they turn."""

from collections.abc import Iterator, Mapping

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import PLASTIC
from roughmdr.report.export.header import mean_lines, model_lines, origin_lines
from roughmdr.report.export.text import Column, Document
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.loops import Loop, loops_of, standard_error_of
from roughmdr.result.select import select
from roughmdr.result.view import ResultView
from roughmdr.variables import SEPARATION

_ENDS = "path_separation_"
"""Beginning of the names of swept keys that say where a loading begins or ends."""


def loss_document(result: ResultView, chosen: Mapping[str, object], units: UnitSystem) -> Document:
    """Return the energy lost in each loop of the path of a result, or of each cell of a sweep of where it ends.

    StoreError where another key is swept, or where no unloading goes back to where its loading began.
    """
    view, words = select(result, chosen)
    if view.control != SEPARATION.name or not view.holds("force"):
        raise StoreError("quantity 'loss' needs the force over the separation; run the scene with path.separation")
    others = [name for name in view.swept(view.cells[0]) if not name.startswith(_ENDS)]
    if others and len(view.cells) > 1:
        raise StoreError(f"the result has {len(view.cells)} cells, over {', '.join(others)}: select one of each")
    loops = [(loop, standard_error_of(view, cell, loop)) for cell in view.cells for loop in loops_of(view, cell)]
    if not loops:
        raise StoreError(
            "no unloading of the path goes back to where its loading began: give path.unload = true and sweep "
            "path.separation.stop, or a list of separations that comes and goes several times"
        )
    if np.isnan([loop.energy_lost for loop, _ in loops]).all():
        raise StoreError("the force is not known at all steps of any loop: no run was computed, or none to its end")
    loops.sort(key=lambda each: (-each[0].closest, -each[0].start))
    return Document(
        "loss", dict(origin_lines(view, words)) | dict(_lines(view, len(loops), units)), _columns(loops, units)
    )


def _columns(loops: list[tuple[Loop, float]], units: UnitSystem) -> tuple[Column, ...]:
    """Return the columns, with a row for each loop and its standard error, the shallowest first."""
    length, energy, unit = units.length, units.force.size * units.length.size, f"{units.force.name} {units.length.name}"
    start, closest, lost, error, work = np.array([loop[1:] for loop, _ in loops]).T
    return (
        Column("overclosure", length.name, 0.0 - closest / length.size),
        Column("energy_lost", unit, lost / energy),
        Column("energy_lost_error", unit, error / energy),
        Column("standard_error", unit, np.array([each for _, each in loops]) / energy),
        Column("work_of_loading", unit, work / energy),
        Column("start", length.name, 0.0 - start / length.size),
    )


def _lines(view: ResultView, count: int, units: UnitSystem) -> Iterator[tuple[str, str]]:
    """Yield what the numbers are, and their errors."""
    yield from mean_lines(view)
    yield "quantity", "energy lost by a loop from the overclosure start to the overclosure and back to start"
    yield "units", units.names
    yield "datum", "overclosure is minus the separation of the scene; adhesion loses energy before it is 0, too"
    yield "points", f"{count} loop{'s' * (count > 1)}"
    yield (
        "error",
        "energy_lost_error is by the steps, jumps included, plus the force at both ends times the length of the loop, "
        "since contacts there hold energy: begin out of contact to make it small; nan of fewer than four steps a leg. "
        "standard_error is that of the mean over the realisations, nan of one and of statistics. The error of the "
        "model is in neither",
    )
    if view.known(PLASTIC).size:
        yield "memory", "contacts yield: of several loops of one path, each loses what those before have left"
    yield from model_lines(view)
