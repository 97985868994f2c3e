"""The mean pressure in the contacts, as a summary tells it."""

import re

import pytest
from scenes import scene

import roughmdr as rm

PATH = {"separation": {"start": "2 um", "stop": "0 um", "steps": 5}}


def told(result: object) -> float:
    """The pressure that is told [Pa]."""
    found = re.search(r"^pressure +([\d.]+) (k|M|G)?Pa on average", rm.info(result), flags=re.MULTILINE)
    assert found
    return float(found[1]) * {None: 1.0, "k": 1e3, "M": 1e6, "G": 1e9}[found[2]]


@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("area", ["contact_area", "contact_fraction"])
def test_it_is_the_mean_force_over_the_mean_area(keep: str, area: str) -> None:
    batch, output = {"realizations": 3}, {"variables": ["force", area]}
    result = rm.run(scene(path=PATH, adhesion=None, batch=batch, output=output | {"keep": keep}))
    curves = rm.run(scene(path=PATH, adhesion=None, batch=batch, output={"variables": ["force", "contact_area"]}))
    last = curves.isel(step=-1).mean("realization")
    assert told(result) == pytest.approx(float(last.force / last.contact_area), rel=1e-3)


def test_in_a_unit_that_suits() -> None:
    """A body a thousand times stiffer has a thousand times the pressure."""
    output = {"variables": ["force", "contact_area"]}
    soft, stiff = (
        rm.run(scene(path=PATH, adhesion=None, output=output, material={"effective_modulus": modulus}))
        for modulus in ("1 MPa", "1 GPa")
    )
    assert told(stiff) == pytest.approx(1e3 * told(soft), rel=2e-3)


def test_a_range_over_a_sweep() -> None:
    sweep = {"material.effective_modulus": ["1 MPa", "2 MPa"]}
    result = rm.run(scene(path=PATH, adhesion=None, material={"effective_modulus": 1e6}, sweep=sweep))
    assert re.search(r"^pressure +[\d.]+ to [\d.]+ kPa on average", rm.info(result), flags=re.MULTILINE)


@pytest.mark.parametrize("variables", [["force"], ["contact_area"]])
def test_nothing_is_told_without_both(variables: list[str]) -> None:
    result = rm.run(scene(path=PATH, adhesion=None, output={"variables": variables}))
    assert "\npressure " not in rm.info(result)


def test_nothing_is_told_out_of_contact() -> None:
    result = rm.run(scene(path={"separation": ["9 um", "8 um"]}, adhesion=None))
    assert "\npressure " not in rm.info(result)
