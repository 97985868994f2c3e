"""Every shape against tables made from the 3D integrals with 40 digits (``data_gen/references.py``).

The bounds are those of the accuracy that double precision allows, with X the distance to the fold: 1e-12 +
3e-16/sqrt(X), and 1e-12 + 1e-15/X for the stiffness.
"""

import json
import math
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import roughmdr as rm
from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.elementwise import apply
from roughmdr.shapes import SHAPES

mp = mpmath.mp.clone()
mp.dps = 50
DATA = Path(__file__).parent.parent / "data"
ULP = 2.0**-53


def shape_of(name: str, case: dict[str, Any]) -> Any:
    parameters = case["parameters"]
    if name == "power_series":
        parameters = {"terms": {float(n): c for n, c in parameters["terms"].items()}}
    shape = SHAPES[name](**parameters)
    if "slopes" in case:  # the last bit of the spline's slopes depends on who solves for them
        shape.knot_slopes = np.array(case["slopes"])
        for found in ("_pieces", "_params"):
            vars(shape).pop(found, None)
    return shape


def tables() -> list[Any]:
    found = []
    for name in sorted(SHAPES.keys() - {"mdr_table"}):  # known by its g: ``shapes/test_mdr_table.py``
        for number, case in enumerate(json.loads((DATA / f"{name}.json").read_text())["cases"]):
            found.append(pytest.param(name, case, id=f"{name}-{number}"))
    return found


def bounds(case: dict[str, Any], row: dict[str, Any]) -> dict[str, float]:
    """How far each answer may be off."""
    exact = {name: mp.mpf(row[name]) for name in ("contact_radius", "indentation", "force", "stiffness")}
    control, X = row["control"], mp.mpf(1)
    scale = {name: abs(exact[name]) for name in ("indentation", "force")}
    if case["work"] > 0.0:
        off = case["pull_off"]["displacement" if control == "indentation" else "force"]
        X = abs(1 - mp.mpf(row["value"]) / mp.mpf(off[control]))
        scale = {name: max(scale[name], abs(mp.mpf(off[name]))) for name in scale}
    if "slopes" in case:  # a table is right to rounding of its own size
        r, f = case["parameters"]["r"][-1], case["parameters"]["f"][-1]
        floor = {"indentation": 1e-15 * f, "force": 2e-15 * case["modulus"] * r * f}
        scale = {name: max(scale[name], mp.mpf(floor[name] / 1e-12)) for name in scale}
    forward = 1e-12 + 3e-16 / float(mp.sqrt(X)) if X > 0 else 1.0
    k = exact["stiffness"]
    plain = 2 * mp.mpf(case["modulus"]) * exact["contact_radius"]
    return {
        "contact_radius": forward * float(exact["contact_radius"]),
        "indentation": forward * float(scale["indentation"]),
        "force": forward * float(scale["force"]),
        "stiffness": (1e-12 + 1e-15 / float(X) if X > 0 else 1.0) * float(max(abs(k), plain)),
    }


def above_its_rounding(case: dict[str, Any], row: dict[str, Any]) -> bool:
    """Whether a row does not ask a table for a force that is lost in the rounding of the table's own scale."""
    if "slopes" not in case or case["work"] > 0.0:
        return True
    r, f = case["parameters"]["r"][-1], case["parameters"]["f"][-1]
    return float(row["force"]) > 1e-6 * case["modulus"] * r * f


@pytest.mark.few(30)
@pytest.mark.parametrize(("name", "case"), tables())
def test_every_answer_is_as_right_as_floats_allow(name: str, case: dict[str, Any]) -> None:
    shape = shape_of(name, case)
    for control in ("indentation", "force"):
        rows = [row for row in case["rows"] if row["control"] == control and above_its_rounding(case, row)]
        values = [row["value"] for row in rows]
        got = rm.indent(shape, effective_modulus=case["modulus"], work=case["work"], **{control: values})
        for i, row in enumerate(rows):
            for quantity, bound in bounds(case, row).items():
                error = abs(mp.mpf(float(got[quantity][i])) - mp.mpf(row[quantity]))
                assert error <= bound, (control, row["value"], quantity, float(error) / bound, row)


@pytest.mark.few(30)
@pytest.mark.parametrize(("name", "case"), tables())
def test_pull_off(name: str, case: dict[str, Any]) -> None:
    if case["work"] == 0.0:
        return
    shape = shape_of(name, case)
    for control, exact in case["pull_off"].items():
        off = rm.pull_off(shape, effective_modulus=case["modulus"], work=case["work"], control=control)
        own = "indentation" if control == "displacement" else "force"
        assert abs(float(off[own]) / mp.mpf(exact[own]) - 1) <= 3 * ULP
        assert float(off.contact_radius) == pytest.approx(float(mp.mpf(exact["contact_radius"])), rel=1e-7)


@pytest.mark.few(40)
@pytest.mark.parametrize(("name", "case"), tables())
def test_the_energy_of_the_springs(name: str, case: dict[str, Any]) -> None:
    """To 1e-10 of its parts, elastic and surface, of which each is about pi w a^2 or larger."""
    contact = Contact.of(shape_of(name, case), case["modulus"], Adhesion(case["work"]))
    for row in case["rows"]:
        if row["control"] != "indentation" or "energy" not in row:
            continue
        distance = contact.reduced(np.array([row["value"]]), contact.depth)
        state = apply(contact.kernels.state, distance, contact.params)
        energy = contact.force * contact.depth[0] * float(apply(contact.kernels.energy, state, contact.params)[0])
        surface = math.pi * case["work"] * float(row["contact_radius"]) ** 2
        steep = 4.0 * case["parameters"].get("exponent", 1.0) * ULP
        assert abs(energy - float(row["energy"])) <= (1e-12 + steep) * (abs(float(row["energy"])) + 2.0 * surface)


def test_the_tables_hold_the_spline_that_is_used() -> None:
    for case in json.loads((DATA / "tabulated.json").read_text())["cases"]:
        np.testing.assert_allclose(rm.Tabulated(**case["parameters"]).knot_slopes, case["slopes"], rtol=1e-15)
