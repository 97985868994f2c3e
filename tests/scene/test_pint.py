"""Quantities of pint stand where strings with a unit do, and units of results are read by cf-xarray's registry."""

import math
from pathlib import Path
from typing import Any

import cf_xarray.units
import numpy as np
import pint
import pint_xarray  # noqa: F401 - gives datasets their accessor
import pytest
from scenes import ASPERITIES, scene
from tips import MODULUS, Tip

import roughmdr as rm
from roughmdr.scene import read
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import as_text, quantity
from roughmdr.variables import LAW_VARIABLES

PINT, CF = pint.UnitRegistry(), cf_xarray.units.units


@pytest.mark.parametrize("units", [PINT, CF], ids=["pint", "cf"])
@pytest.mark.parametrize(
    ("number", "unit", "dimension", "expected"),
    [
        (10, "um", "m", 1e-5),
        (2.5, "micron", "m", 2.5e-6),
        (1, "GPa", "Pa", 1e9),
        (1000, "psi", "Pa", 6894757.293168),
        (50, "mJ/m^2", "J/m^2", 0.05),
        (50, "mN/m", "J/m^2", 0.05),
        (2, "lbf/inch", "N/m", 350.25367),
        (1e9, "1/m^2", "m-2", 1e9),
        (3, "W/m/K", "W/m/K", 3.0),
        (20, "nohm*m", "ohm m", 2e-8),
        (3, "percent", "1", 0.03),
        (0.3, "", "1", 0.3),
    ],
)
def test_a_quantity_is_read_as_its_string(
    units: Any, number: float, unit: str, dimension: str, expected: float
) -> None:
    assert quantity(as_text(units.Quantity(number, unit)), dimension) == pytest.approx(expected, rel=1e-7)


def test_scenes_and_functions_take_them() -> None:
    changes = {
        "material": {"effective_modulus": PINT.Quantity(2, "MPa")},
        "adhesion": {"model": "jkr", "work": PINT.Quantity(np.float64(50.0), "mJ/m^2")},
        "path": {"separation": PINT.Quantity(np.array([3.0, 1.0, -0.5]), "um")},
    }
    texts = {
        "material": {"effective_modulus": "2 MPa"},
        "adhesion": {"model": "jkr", "work": "50 mJ/m^2"},
        "path": {"separation": ["3 um", "1 um", "-0.5 um"]},
    }
    found, expected = rm.run(scene(**changes)), rm.run(scene(**texts))
    assert found.force.equals(expected.force)
    assert found.cell_key.equals(expected.cell_key)
    swept = read(scene(), {"material.modulus": PINT.Quantity(3, "GPa")})
    assert parse_toml(swept.toml)["material"]["modulus"] == "3 GPa"
    tip, text = (rm.Paraboloid(radius=radius) for radius in (50 * PINT.um, "50 um"))
    assert rm.pull_off(tip, effective_modulus=2 * PINT.MPa, work=50 * PINT.mJ / PINT.m**2) == rm.pull_off(
        text, effective_modulus="2 MPa", work="50 mJ/m^2"
    )
    depths = [
        rm.indent(text, effective_modulus=2e6, force=force).indentation
        for force in (np.array([1, 2]) * PINT.mN, [1 * PINT.mN, 2 * PINT.mN])
    ]
    np.testing.assert_array_equal(*depths)


@pytest.mark.large
def test_asperities_fits_and_exports_take_them(tmp_path: Path) -> None:
    lengths = ("1 mm", "50 um"), (1 * CF.mm, np.float64(50.0) * PINT.um)
    made = [rm.generate({**ASPERITIES, "patch": patch, "radius": radius}, seed=1) for patch, radius in lengths]
    assert made[0].equals(made[1])
    tip = Tip("hertz", 1e-7, 1e6)
    measured = tip.measure(np.random.default_rng(0), 20, ("constant", 0.01), 0.0)
    pairs = (1 * PINT.MPa, 9000 * PINT.kPa), np.array([1, 9]) * PINT.MPa, ("1 MPa", "9 MPa")
    for known in ("bounds", "priors"):
        fits = [rm.fit(measured, tip.scene(), [MODULUS], **{known: {MODULUS: pair}}) for pair in pairs]
        assert len({(float(fit.material_modulus), float(fit.material_modulus_high)) for fit in fits}) == 1
    law, table = rm.run(scene(batch={"estimator": "expected"})), {"to": "lammps", "quantity": "force", "error": 0.05}
    for name, distance in (("one.table", 1 * CF.mm), ("other.table", "1 mm")):
        rm.export(law, tmp_path / name, distance=distance, **table)
    assert (tmp_path / "one.table").read_text() == (tmp_path / "other.table").read_text()


@pytest.mark.parametrize("wrong", [PINT.Quantity(3, "kg"), PINT.Quantity(3, "um"), PINT.Quantity(math.nan, "Pa")])
def test_a_wrong_one_is_refused(wrong: Any) -> None:
    with pytest.raises(rm.SceneError, match=r"material\.effective_modulus"):
        read(scene(material={"effective_modulus": wrong}))
    with pytest.raises(rm.OutOfRange, match="effective_modulus is"):
        rm.pull_off(rm.Paraboloid(radius=1e-6), effective_modulus=wrong, work=0.05)
    with pytest.raises(rm.OutOfRange, match="force is"):
        rm.indent(rm.Paraboloid(radius=1e-6), effective_modulus=1e6, force=[wrong, wrong])
    with pytest.raises(rm.ShapeError, match="radius is"):
        rm.Paraboloid(radius=PINT.Quantity(1, "kg"))


def test_units_of_results_are_read() -> None:
    for variable in LAW_VARIABLES.values():
        assert CF.Quantity(1.0, variable.units).to_base_units().magnitude == pytest.approx(1.0, rel=1e-15)
    law = rm.run(scene())
    with_units = law.pint.quantify(unit_registry=CF)
    stiffness = with_units.stiffness.pint.to("mN/um").pint.dequantify()
    np.testing.assert_allclose(stiffness, law.stiffness * 1e-3, rtol=1e-14)
