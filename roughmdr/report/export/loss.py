"""The energy lost by loops of loading and unloading, over the overclosure at which they turn."""

from collections.abc import Iterator, Mapping

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.model_error.parts import PLASTIC
from roughmdr.report.export.header import law_lines, model_lines, origin_lines
from roughmdr.report.export.text import Column, Document
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.loops import Loop, loops_of
from roughmdr.result.select import select
from roughmdr.result.view import ResultView
from roughmdr.variables import SEPARATION, swept_name

_ENDS = {swept_name(f"path.separation.{end}") for end in ("start", "stop")}


def loss_document(result: ResultView, chosen: Mapping[str, object], units: UnitSystem) -> Document:
    """Return the energy lost in each loop of the path of a result, or of each cell of a sweep of where it ends.

    StoreError where another key is swept, or where no loading is undone by its unloading.
    """
    view, words = select(result, chosen)
    others = [name for name in view.sweep if name not in _ENDS]
    if others:
        listed = ", ".join(f"{name} ({view.sweep[name]})" for name in others)
        raise StoreError(f"the result has {len(view.cells)} cells, over {listed}: select one of each")
    if view.control != SEPARATION.name or not view.holds("force"):
        raise StoreError("quantity 'loss' needs the force over the separation; run the scene with path.separation")
    loops = sorted((loop for cell in view.cells for loop in loops_of(view, cell)), key=lambda loop: -loop.closest)
    if not loops:
        raise StoreError(
            "no loading of the path is undone by an unloading: give path.unload = true and sweep path.separation.stop, "
            "or a list of separations that comes and goes several times"
        )
    if np.isnan([loop.lost for loop in loops]).all():
        raise StoreError("the force is not known at all steps of any loop: no run was computed, or none to its end")
    return Document(
        "loss", dict(origin_lines(view, words)) | dict(_lines(view, len(loops), units)), _columns(loops, units)
    )


def _columns(loops: list[Loop], units: UnitSystem) -> tuple[Column, ...]:
    """Return a row for each loop, the shallowest first."""
    length, energy, unit = units.length, units.force.size * units.length.size, f"{units.force.name} {units.length.name}"
    closest, lost, error, standard_error, work = np.array(loops).T
    return (
        Column("overclosure", length.name, -closest / length.size),
        Column("energy_lost", unit, lost / energy),
        Column("energy_lost_error", unit, error / energy),
        Column("standard_error", unit, standard_error / energy),
        Column("work_of_loading", unit, work / energy),
    )


def _lines(view: ResultView, count: int, units: UnitSystem) -> Iterator[tuple[str, str]]:
    """Yield what the numbers are, and their errors."""
    yield from law_lines(view)
    yield "quantity", "work of a loading to the overclosure, and that less what the unloading behind it gives back"
    yield "units", units.names
    yield "datum", "overclosure is minus the separation, where the loop turns"
    yield "points", f"{count} loops"
    yield (
        "error",
        "energy_lost_error is that of the trapezoid rule between the steps, jumps included, standard_error that of the "
        "mean over the realisations; that of the model is not in them",
    )
    if view.known(PLASTIC).size:
        yield "memory", "contacts yield: of several loops of one path, each loses what those before have left"
    yield from model_lines(view)
