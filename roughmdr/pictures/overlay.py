"""Curves drawn over a result: the expected law of its scene, and the theory curves that apply to it."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from roughmdr.batch.plan import Cell, Plan, make_plan
from roughmdr.batch.realization import simulate_realization
from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.law import EXPECTED, INDEPENDENT, Overlay, OverlayLine
from roughmdr.pictures.theory_curves import THEORY_CURVES, TheoryCurve
from roughmdr.result.view import ResultView
from roughmdr.scene import read
from roughmdr.schema.wording import count_by_cell
from roughmdr.variables import LATERAL

# Variables of a result: the theory's variable, and whether it is per unit of nominal area.
_THEORY_VARIABLES: dict[str, tuple[str, bool]] = {
    "force": ("pressure", True),
    "contact_area": ("contact_fraction", True),
    "contact_count": ("contact_density", True),
    "pressure": ("pressure", False),
    "contact_fraction": ("contact_fraction", False),
    "thermal_conductance": ("conductance", True),
}
_SEPARATION_RTOL = 1e-9  # difference of equal separations, over the largest


def plan_of_result(file: Path | None, result: ResultView) -> Plan:
    """Return the plan of the scene in a result, which was read from ``file`` unless that is None.

    SceneError if that scene cannot be read again, StoreError if the result has other cells or other separations.
    """
    if result.control != "separation":
        lateral = result.control == LATERAL.name
        where = "a lateral path" if lateral else "a path of loads, of a preload or behind a spring"
        raise StoreError(f"{file or 'result'}: theories and the expected law need path.separation; this is {where}")
    plan, stored = make_plan(read(file or result.scene)), result.path
    planned = np.array([cell.values for cell in plan.cells])
    if (
        stored.size != planned.size
        or np.abs(stored.reshape(planned.shape) - planned).max() > _SEPARATION_RTOL * np.abs(planned).max()
    ):
        raise StoreError(f"{file or 'result'}: its separations are not those of the scene in it")
    return plan


def overlay_expected(plan: Plan, names: list[str]) -> Overlay:
    """Return the expected law of each cell in these variables; of asperities in pairs as if they were independent."""

    def evaluate(cell: Cell) -> dict[str, Floats]:
        alone = cell.scene.model_copy(update={"interaction": None})
        scene = alone if cell.scene.needs_positions else cell.scene
        if reason := scene.reason_against("expected"):
            raise RoughmdrError(reason)
        return simulate_realization(scene, cell.path, 0, names, "expected").variables

    def remark(cell: Cell) -> str:
        return "of independent asperities" * cell.scene.needs_positions

    found = _evaluate_cells(plan, EXPECTED, remark, evaluate)
    pairs = [plan.cells[line.cell].scene.needs_positions for line in found.lines]
    lines = [line._replace(label=INDEPENDENT) if each else line for line, each in zip(found.lines, pairs, strict=True)]
    return Overlay(lines, found.remarks)


def overlay_theory(plan: Plan, names: list[str], x: str = "separation") -> Overlay:
    """Return the theory curves in each cell to which they apply, in those of the variables that they give, and ``x``.

    Remarks begin with the name of the theory curve, or with those that have the same one.
    """
    found = {
        label: _evaluate_cells(plan, label, curve.remark, partial(_evaluate_curve, curve, names, x))
        for label, curve in THEORY_CURVES.items()
    }
    labels: dict[str, list[str]] = {}
    for label, overlay in found.items():
        for remark in overlay.remarks:
            labels.setdefault(remark, []).append(label)
    lines = [line for overlay in found.values() for line in overlay.lines]
    return Overlay(lines, [f"{', '.join(alike)}: {remark}" for remark, alike in labels.items()])


def _evaluate_cells(
    plan: Plan, label: str, remark: Callable[[Cell], str], evaluate: Callable[[Cell], dict[str, Floats]]
) -> Overlay:
    lines, remarks = [], []
    for number, cell in enumerate(plan.cells):
        try:
            variables = evaluate(cell)
        except RoughmdrError as error:
            remarks.append(f"not drawn: {error}")
            continue
        remarks.append("; ".join(filter(None, ("drawn", remark(cell)))))
        lines += [OverlayLine(label, name, number, cell.path.separation, values) for name, values in variables.items()]
    return Overlay(lines, count_by_cell(remarks, len(plan.cells)))


def _evaluate_curve(curve: TheoryCurve, names: list[str], x: str, cell: Cell) -> dict[str, Floats]:
    """Return those of the variables that a theory curve gives in a cell; RoughmdrError if it gives none."""
    bodies, elastic = cell.scene.unlike, "elastic bodies under a flat"
    if bodies != curve.bodies:
        raise RoughmdrError(f"for {curve.bodies or elastic}; the scene is of {bodies or elastic}")
    known = {name: _THEORY_VARIABLES[name] for name in [*names, x] if name in _THEORY_VARIABLES}
    given = {name: (variable, per_area) for name, (variable, per_area) in known.items() if variable in curve.variables}
    if not given.keys() - {x} or x not in {"separation", *given}:
        raise RoughmdrError(f"it gives no {' or '.join(names)}" + f" over {x}" * (x != "separation"))
    values = {variable: curve.evaluate(cell, variable) for variable in {variable for variable, _ in given.values()}}
    area = cell.scene.asperities.nominal_area
    if area is None:
        raise AssertionError("theory curves apply to random asperities, which are on a patch")
    return {name: values[variable] * (area if per_area else 1.0) for name, (variable, per_area) in given.items()}
