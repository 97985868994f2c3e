"""Exported tables in CalculiX: one stiff element on a fixed one, pressed to given overclosures."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from exports import of_abaqus
from numpy.typing import NDArray
from scenes import scene

import roughmdr as rm
from roughmdr.storage.labelled import Labelled

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="there is no CalculiX to read the tables with")

AREA = 1e-6  # area of the patch [m2]
_DECK = """*NODE, NSET=LOW
1, -1., -1., 0.
2, 2., -1., 0.
3, 2., 2., 0.
4, -1., 2., 0.
5, -1., -1., 1.
6, 2., -1., 1.
7, 2., 2., 1.
8, -1., 2., 1.
*NODE, NSET=UP
11, 0., 0., 1.
12, 1., 0., 1.
13, 1., 1., 1.
14, 0., 1., 1.
15, 0., 0., 2.
16, 1., 0., 2.
17, 1., 1., 2.
18, 0., 1., 2.
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=FOOT
11, 12, 13, 14
*NSET, NSET=TOP
15, 16, 17, 18
*SURFACE, NAME=MASTER
1, S2
*SURFACE, NAME=SLAVE
2, S1
*MATERIAL, NAME=STIFF
*ELASTIC
{modulus}, 0.
*CONDUCTIVITY
{conductivity}
*EXPANSION
0.
*SOLID SECTION, ELSET=ALL, MATERIAL=STIFF
*SURFACE INTERACTION, NAME=LAYER
{interaction}
*CONTACT PAIR, INTERACTION=LAYER, TYPE={contact}
SLAVE, MASTER
*INITIAL CONDITIONS, TYPE=TEMPERATURE
LOW, 0.
UP, 0.
*BOUNDARY
LOW, 1, 3
FOOT, 1, 2
LOW, 11, 11, 0.
"""
_STEP = """*STEP, NLGEOM
{analysis}
1., 1.
*BOUNDARY
TOP, 1, 2, 0.
TOP, 3, 3, {moved:.12e}
{temperature}
*NODE PRINT, NSET=TOP, TOTALS=ONLY
{printed}
*END STEP
"""


def solved(folder: Path, deck: str) -> str:
    (folder / "model.inp").write_text(deck)
    subprocess.run(["ccx", "model"], cwd=folder, capture_output=True, check=True, timeout=120)
    return (folder / "model.dat").read_text()


def force(printed: str) -> NDArray[np.float64]:
    """The force down on the top at the end of each step."""
    return -np.array([float(found) for found in re.findall(r"total force.*\s+\S+\s+\S+\s+(\S+)", printed)])


@pytest.fixture(scope="module")
def law(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("calculix") / "law.nc"
    path = {"separation": {"start": "clear", "stop": "0 sigma", "steps": 200}}
    rm.run(scene(adhesion=None, path=path, batch={"estimator": "expected"}), file)
    return file


@pytest.mark.parametrize("units", ["mm,N,MPa", "um,uN,MPa"])
def test_the_element_is_pressed_back_as_the_law_says(law: Path, units: str, tmp_path: Path) -> None:
    """Over a face of unit area, within the error of the table and the strain of the element."""
    error = 2e-3
    rm.export(law, tmp_path / "layer.inp", to="calculix", units=units, error=error)
    _, overclosure, pressure = of_abaqus(tmp_path / "layer.inp")
    modulus = 1e7 * pressure[-1] / overclosure[-1]  # the strain changes the overclosure by 1e-7 of the largest
    moved = overclosure[-1] * np.array([0.55, 0.75, 0.9, 0.999])
    steps = (_STEP.format(analysis="*STATIC", moved=-each, temperature="**", printed="RF") for each in moved.tolist())
    deck = _DECK.format(
        modulus=f"{modulus:.6e}", conductivity=1.0, interaction="*INCLUDE, INPUT=layer.inp", contact="NODE TO SURFACE"
    )
    found = force(solved(tmp_path, deck + "".join(steps)))
    with xr.open_dataset(law) as data:
        size = {"mm": 1e-3, "um": 1e-6}[units[:2]]
        datum = float(re.search(r"overclosure is (\S+) ", (tmp_path / "layer.inp").read_text())[1]) * size
        mean = data.force.isel(realization=0).to_numpy() / AREA / 1e6
        exact = np.interp(moved * size, datum - data.separation.to_numpy(), mean)
    allowed = error * np.maximum(exact, 0.1 * mean.max())
    assert (np.abs(found - exact) <= allowed + 2e-6 * mean.max()).all()
    assert (found > 0.0).all()


def test_heat_flows_as_the_conductance_over_the_pressure_says(law: Path, tmp_path: Path) -> None:
    with xr.open_dataset(law) as data:
        made = data.load()
    made["thermal_conductance"] = (0.02 * made.force**0.95).assign_attrs(units="W K-1", long_name="conductance")
    made.attrs["checksum"] = Labelled.of(made).checksum()
    error = 1e-2
    rm.export(made, tmp_path / "gap.inp", to="calculix", quantity="conductance", units="mm,N,MPa", error=error)
    _, pressure, conductance = of_abaqus(tmp_path / "gap.inp")
    assert pressure.size <= 20
    stiffness = pressure[-1]  # so that overclosures up to 1e-3 make pressures up to 1e-3 of it
    linear = f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{1e3 * stiffness:.6e}, {1e-3 * stiffness:.6e}\n"
    asked = np.array([0.2, 0.5, 0.9]) * pressure[-1]
    steps = (
        _STEP.format(
            analysis="*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE",
            moved=-each / (1e3 * stiffness),
            temperature="TOP, 11, 11, 1.",
            printed="RF, RFL",
        )
        for each in asked.tolist()
    )
    deck = _DECK.format(
        modulus=f"{1e9 * stiffness:.6e}",
        conductivity=f"{1e6 * conductance[-1]:.6e}",
        interaction=f"{linear}*INCLUDE, INPUT=gap.inp",
        contact="SURFACE TO SURFACE",
    )
    printed = solved(tmp_path, deck + "".join(steps))
    flux = np.array([float(found) for found in re.findall(r"total heat generation.*\s+(\S+)", printed)])
    exact = 0.02 * (asked * 1e6 * AREA) ** 0.95 / AREA * 1e-6 * 1e3  # mW/mm^2 over one kelvin
    np.testing.assert_allclose(force(printed), asked, rtol=1e-4)
    np.testing.assert_allclose(flux, exact, rtol=error)
