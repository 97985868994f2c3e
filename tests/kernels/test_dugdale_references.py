"""Adhesion of finite range against tables made with 25 digits and more (``data_gen/dugdale_references.py``).

With X the distance to the fold of a state's branch: 1e-12 of the natural scales, + 1e-15/sqrt(X) where the state is
sought, and 1e-11 + 1e-14/X for the stiffness. A contact radius is part of the cohesive radius and is measured by it;
where it is sought, so is its share 2 E* a of the stiffness.
"""

import json
import math
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numba
import numpy as np
import pytest
import xarray as xr
from forms import large_where_compiled
from test_references import mp, shape_of

import roughmdr as rm
from roughmdr.shapes import SHAPES, Shape

DATA = Path(__file__).parent.parent / "data"
Row = dict[str, Any]
Control = Literal["displacement", "force"]
CONTROLS: dict[Control, str] = {"displacement": "indentation", "force": "force"}


class Case(NamedTuple):
    """One asperity, its states, and the units that its table counts lengths [m] and moduli [Pa] by."""

    name: str
    shape: Shape
    effective_modulus: float
    work: float
    strength: float
    pull_off: dict[str, Row]
    rows: list[Row]
    length: float = 1.0
    pressure: float = 1.0

    @property
    def law(self) -> dict[str, Any]:
        return {
            "effective_modulus": self.effective_modulus,
            "work": self.work,
            "strength": self.strength,
            "adhesion": "dugdale",
        }

    def unit(self, quantity: str) -> float:
        powers = {"contact_radius": (1, 0), "cohesive_radius": (1, 0), "indentation": (1, 0)}
        length, pressure = {**powers, "force": (2, 1), "stiffness": (1, 1)}[quantity]
        return self.length**length * self.pressure**pressure

    def exact(self, row: Row, quantity: str) -> Any:
        return mp.mpf(row[quantity]) * mp.mpf(self.unit(quantity))

    def scale(self, quantity: str) -> float:
        """Return the size of the pull-off: depth under fixed grips, force under dead load."""
        control = {"indentation": "displacement", "force": "force"}[quantity]
        return abs(float(self.exact(self.pull_off[control], quantity)))


def maugis() -> list[Case]:
    """Maugis's units stretched by powers of two, which keeps every number what it is."""
    found = []
    length, pressure = 2.0**-23, 2.0**31
    for case in json.loads((DATA / "maugis.json").read_text())["cases"]:
        shape, work = rm.Paraboloid(radius=length), 1.0 / math.pi * length * pressure
        strength = case["lambda"] / 2.0 * pressure
        name = f"maugis-{case['lambda']:g}"
        found.append(
            Case(name, shape, 0.75 * pressure, work, strength, case["pull_off"], case["rows"], length, pressure)
        )
    return found


def shapes() -> list[Case]:
    found = []
    for shape in sorted(SHAPES.keys() - {"mdr_table"}):  # known by its g: ``shapes/test_mdr_table.py``
        for number, case in enumerate(json.loads((DATA / f"dugdale_{shape}.json").read_text())["cases"]):
            law = (case["modulus"], case["work"], case["strength"])
            found.append(Case(f"{shape}-{number}", shape_of(shape, case), *law, case["pull_off"], case["rows"]))
    return found


SLOW = ("tabulated", "power_series", "sphere")
"""Shapes that take minutes when they are not compiled."""
CASES = [
    pytest.param(case, id=case.name)
    for case in [*maugis(), *shapes()]
    if not (numba.config.DISABLE_JIT and case.name.startswith(SLOW))
]


ROUNDINGS = 16 * np.finfo(float).eps
"""Rounding error of the distance to the fold, from those of the control and its scale."""


def bounds(case: Case, row: Row, X: float, sought: bool, slack: float = 0.0) -> dict[str, float]:
    """How far each answer may be off, with the distance ``X`` to the fold; the state is given, or ``sought``, and then
    ``slack`` is by how much a moves with the roundings of the control.
    """
    forward = 1e-12 + (1e-15 / math.sqrt(X) if sought else 0.0)
    exact = {name: abs(float(case.exact(row, name))) for name in ("contact_radius", "cohesive_radius", "stiffness")}
    radius = forward * exact["cohesive_radius"] + slack
    rigid = 2.0 * case.effective_modulus  # stiffness per contact radius
    stiffness = (1e-11 + 1e-14 / X) * max(exact["stiffness"], rigid * exact["contact_radius"])
    return {
        "contact_radius": radius,
        "cohesive_radius": radius,
        "stiffness": stiffness + (rigid * radius if sought else 0.0),
        **{name: forward * max(abs(float(case.exact(row, name))), case.scale(name)) for name in CONTROLS.values()},
    }


def compare(case: Case, row: Row, got: xr.Dataset, allowed: dict[str, float]) -> None:
    for quantity, bound in allowed.items():
        error = abs(float(mp.mpf(float(got[quantity])) - case.exact(row, quantity)))
        assert error <= bound, (quantity, float(got[quantity]), error, bound, row)
    assert float(got.contact_area) == pytest.approx(math.pi * float(got.contact_radius) ** 2, rel=1e-15)


def flat_of(shape: Shape) -> float:
    """The radius [m] of the part that is flat."""
    if isinstance(shape, rm.Tabulated):
        return float(max(r for r in shape.columns["r"] if shape.f(r) == 0.0))
    return float(getattr(shape, "flat_radius", 0.0))


@pytest.mark.few(20)
@pytest.mark.parametrize("case", CASES)
def test_at_a_contact_radius(case: Case) -> None:
    if isinstance(case.shape, rm.FlatPunch):
        return
    flat = flat_of(case.shape)
    rows = [row for row in case.rows if float(row["contact_radius"]) > flat]
    radii = [float(case.exact(row, "contact_radius")) for row in rows]
    got = rm.indent(case.shape, **case.law, contact_radius=radii)
    for i, row in enumerate(rows):
        X = row["answers"].get("displacement", 1.0)
        compare(case, row, got.isel(contact_radius=i), bounds(case, row, X, sought=False))


@pytest.mark.few(1)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("control", CONTROLS)
def test_on_a_slow_retraction(case: Case, control: Control) -> None:
    rows = [row for row in case.rows if control in row["answers"]]
    quantity = CONTROLS[control]
    values = np.array([float(case.exact(row, quantity)) for row in rows])
    got = rm.indent(case.shape, **case.law, **{quantity: values})
    # Where a begins to grow it is a root of the control and moves more than the control does, and k with it.
    width = 1e-9 * (np.abs(values) + case.scale(quantity))
    beside = rm.indent(case.shape, **case.law, **{quantity: values + width})
    moved = {
        name: ROUNDINGS / 1e-9 * np.abs(beside[name].to_numpy() - got[name].to_numpy())
        for name in ("contact_radius", "stiffness")
    }
    for i, row in enumerate(rows):
        X = row["answers"][control]
        allowed = bounds(case, row, X, sought=True, slack=float(moved["contact_radius"][i]))
        allowed["stiffness"] += float(moved["stiffness"][i])
        compare(case, row, got.isel({quantity: i}), allowed)


@pytest.mark.few(1)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("control", CONTROLS)
def test_pull_off(case: Case, control: Control) -> None:
    off = rm.pull_off(case.shape, **case.law, control=control)
    row, own = case.pull_off[control], CONTROLS[control]
    assert abs(float(off[own]) / case.exact(row, own) - 1) <= 1e-12
    for radius in ("contact_radius", "cohesive_radius"):
        error = abs(float(off[radius]) - case.exact(row, radius))
        assert error <= 1e-7 * case.exact(row, "cohesive_radius"), radius
    (other,) = set(CONTROLS.values()) - {own}
    assert abs(float(off[other]) - case.exact(row, other)) <= 1e-7 * case.scale(other)


@pytest.mark.few(24)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("control", CONTROLS)
def test_pull_off_is_where_the_contact_ends(case: Case, control: Control) -> None:
    own = CONTROLS[control]
    depth = abs(float(case.exact(case.pull_off[control], own)))
    if control == "displacement":
        beyond = rm.indent(case.shape, **case.law, indentation=-depth * (1.0 + 1e-9))
        assert float(beyond.force) == float(beyond.contact_radius) == float(beyond.cohesive_radius) == 0.0
    else:
        with pytest.raises(rm.OutOfRange):
            rm.indent(case.shape, **case.law, force=-depth * (1.0 + 1e-9))
    inside = rm.indent(case.shape, **case.law, **{own: -depth * (1.0 - 1e-9)})
    assert float(inside.cohesive_radius) > 0.0


@large_where_compiled
@pytest.mark.few(1)
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_a_punch_with_a_sharp_edge_pulls_off_as_a_flat_one(unit: float, control: Control) -> None:
    """But for a part that goes with the radius of the edge; so it comes to JKR as steadily as that."""
    b, law = 1e-5 * unit, {"effective_modulus": 1e9, "work": 0.05 * unit}
    flat, edges = rm.FlatPunch(radius=b), np.array([0.1, 0.01, 1e-3])
    jkr = float(rm.pull_off(flat, **law, control=control).force)
    parts = []
    for tabor in (2.0, 4.0, 5.0, 8.0, 30.0):
        strength = tabor / float(rm.tabor(flat, **law, strength=1.0))
        forces = [
            float(rm.pull_off(each, **law, adhesion="dugdale", strength=strength, control=control).force)
            for each in (flat, *(rm.RoundedPunch(flat_radius=b, edge_radius=part * b) for part in edges.tolist()))
        ]
        off = np.abs(np.array(forces[1:]) / forces[0] - 1.0)
        assert off[0] < 1e-3
        assert np.polynomial.polynomial.polyfit(np.log(edges), np.log(off), 1)[1] == pytest.approx(1.0, abs=0.02)
        parts.append(forces[1] / jkr)
    assert (np.diff(parts) > 0.0).all()
    assert 1e-4 < 1.0 - parts[-1] < 1e-3
