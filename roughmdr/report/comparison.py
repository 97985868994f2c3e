"""What stands beside a result in its picture: the expected law of its scene, and the named laws that apply to it."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.batch.plan import Cell, Plan, make_plan, simulate_realization
from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.curves import EXPECTED, Line, separations
from roughmdr.report.named import LAWS, TheoryCurve
from roughmdr.scene import read
from roughmdr.schema.wording import in_cells
from roughmdr.storage.labelled import Labelled
from roughmdr.theory.equal_summits import Variable

# What a law says of a variable, and whether that is of a unit of nominal area.
_SAID_AS: dict[str, tuple[Variable, bool]] = {
    "force": ("pressure", True),
    "contact_area": ("contact_fraction", True),
    "contact_count": ("contact_density", True),
    "pressure": ("pressure", False),
    "contact_fraction": ("contact_fraction", False),
}
_SAME = 1e-9  # of the largest separation


class Comparison(NamedTuple):
    """What laws say, and what is to be said of them."""

    lines: list[Line]
    remarks: list[str]
    """Whether they are drawn, and if not why."""


def plan_of(file: Path, result: Labelled) -> Plan:
    """The plan of the scene that the result in ``file`` holds.

    SceneError where that scene cannot be read again, StoreError where the result has other cells or other separations.
    """
    plan, held = make_plan(read(file)), separations(result)
    asked = np.array([cell.path.separation for cell in plan.cells])
    if held.size != asked.size or np.abs(held.reshape(asked.shape) - asked).max() > _SAME * np.abs(asked).max():
        raise StoreError(f"{file}: its separations are not those of the scene that it holds")
    return plan


def expected_law(plan: Plan, names: list[str]) -> Comparison:
    """The expected law of each cell of a plan, in these variables."""
    return _compare(plan, EXPECTED, "", lambda cell: _expected(cell, names))


def named_laws(plan: Plan, names: list[str]) -> Comparison:
    """The named laws, in each cell to which they apply, in those of the variables that they speak of.

    Their names stand before the remarks.
    """
    lines, remarks = [], []
    for name, law in LAWS.items():
        found = _compare(plan, name, law.note, _saying(law, names))
        lines += found.lines
        remarks += [f"{name}: {text}" for text in found.remarks]
    return Comparison(lines, remarks)


def _compare(plan: Plan, law: str, note: str, say: Callable[[Cell], dict[str, Floats]]) -> Comparison:
    lines, remarks = [], []
    for number, cell in enumerate(plan.cells):
        try:
            said = say(cell)
        except RoughmdrError as error:
            remarks.append(f"not drawn: {error}")
            continue
        remarks.append(f"drawn{note and f'; {note}'}")
        lines += [Line(law, name, number, cell.path.separation, values) for name, values in said.items()]
    return Comparison(lines, in_cells(remarks, len(plan.cells)))


def _expected(cell: Cell, names: list[str]) -> dict[str, Floats]:
    if reason := cell.scene.asperities.reason_against("expected"):
        raise RoughmdrError(reason)
    return simulate_realization(cell.scene, cell.path, 0, names, "expected").variables


def _saying(law: TheoryCurve, names: list[str]) -> Callable[[Cell], dict[str, Floats]]:
    """What a law says of a cell; RoughmdrError where it says nothing."""
    spoken_of = [name for name in names if name in _SAID_AS and _SAID_AS[name][0] in law.variables]

    def say(cell: Cell) -> dict[str, Floats]:
        if not spoken_of:
            raise RoughmdrError(f"it says nothing of {', '.join(names)}")
        said = {variable: law.over(cell, variable) for variable in {_SAID_AS[name][0] for name in spoken_of}}
        area = cell.scene.asperities.nominal_area
        if area is None:
            raise AssertionError("laws of asperities that are drawn, and those are on a patch")
        return {name: said[_SAID_AS[name][0]] * (area if _SAID_AS[name][1] else 1.0) for name in spoken_of}

    return say
