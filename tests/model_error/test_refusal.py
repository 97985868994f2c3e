"""Contact areas above the patch are refused before the run, with the likely cause."""

from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
import tomli_w
from command import roughmdr
from scenes import SCENE, ensemble, scene

import roughmdr as rm
from roughmdr.batch import foresee
from roughmdr.model_error.refusal import Givens, check_contact_fraction, fraction_warnings, likely_cause

TRAPS: list[tuple[dict[str, Any], str]] = [
    ({"material": {"modulus": 3, "poisson": 0.49}}, "effective modulus is 3.948 Pa: is kPa, MPa or GPa meant"),
    ({"adhesion": {"model": "jkr", "work": 50}}, "work of adhesion is 50 J/m^2: is mJ/m^2 meant"),
    ({"asperities": {**SCENE["asperities"], "radius": "50 mm"}}, "units of the lengths"),
    ({"path": {"separation": ["1 um", "-40 um"]}}, "the flat goes down to -40 sigma"),
]


@pytest.mark.parametrize(("changes", "cause"), TRAPS)
def test_a_run_with_more_contact_than_patch_is_refused_before_anything_is_written(
    tmp_path: Path, changes: dict[str, Any], cause: str
) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(tomli_w.dumps(scene(**changes)))
    done = roughmdr("run", file, "-o", tmp_path / "out.nc", cwd=tmp_path)
    assert done.returncode == 2
    assert cause in done.stderr
    assert "runs" not in done.stderr  # no progress: nothing was run
    assert list(tmp_path.iterdir()) == [file]


def test_a_sweep_tells_which_cells_are_refused() -> None:
    table = scene(sweep={"material.modulus": [3e6, 3.0, 30.0]})
    with pytest.raises(rm.OutOfRange, match=r"material.modulus = 3.*2 of 3 cells"):
        rm.run(table)


@pytest.mark.large
def test_of_a_large_sweep_some_cells_are_checked_and_the_others_fail_with_the_reason() -> None:
    """So that the check does not take longer than small runs themselves."""
    modulus = np.geomspace(3e6, 9e6, 250).tolist()
    sweep = {"mode": "zip", "material.modulus": modulus}
    few = {"asperities": {**SCENE["asperities"], "count": 20}, "path": {"separation": ["2 um", "0 um"]}, "batch": {}}
    with patch.object(foresee, "_foreseen", wraps=foresee._foreseen) as checked:
        rm.run(scene(sweep=sweep, **few))
    assert checked.call_count == 100
    modulus[1] = 3.0
    with pytest.warns(UserWarning, match="failed"):
        made = rm.run(scene(sweep=sweep, **few))
    failed = (made.status == 1).any("realization")
    assert np.flatnonzero(failed).tolist() == [1]
    assert "summed contact area" in str(made.remark.values[1][0])
    modulus[-1] = 3.0
    with pytest.raises(rm.OutOfRange, match=r"modulus = 3.*1 of 100 cells"):
        rm.run(scene(sweep=sweep, **few))


def givens(**changes: float) -> Givens:
    usual = {"effective_modulus": 1e9, "work": 0.05, "height_std": 1e-6, "nominal_area": 1e-6, "contact_radius": 1e-5}
    return Givens(**(usual | changes))


def test_all_of_the_patch_may_be_in_contact_but_no_more() -> None:
    """Steps without a value are passed over, and the fullest step is told with its separation."""
    separation = np.array([3e-6, 2e-6, -1e-6, 1e-6])
    check_contact_fraction(np.array([0.2, np.nan, 1.0, 0.5]), separation, givens())
    check_contact_fraction(np.full(4, np.nan), separation, givens())
    with pytest.raises(rm.OutOfRange, match=r"is 1\.2 times the nominal area at a separation of -1 um"):
        check_contact_fraction(np.array([0.2, np.nan, 1.2, 1.001]), separation, givens())
    with pytest.raises(rm.OutOfRange, match=r"is 1 times the nominal area at a separation of 3 um"):
        check_contact_fraction(np.array([np.nextafter(1.0, 2.0), 0.9, 0.9, np.nan]), separation, givens())


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e3])
def test_the_cause_is_the_same_in_other_units_of_length(unit: float) -> None:
    """A contact half as wide as the patch is told, one of a fiftieth is not: there is no other cause then."""

    def cause(radius: float, separation: float = 0.0, **changes: float) -> str:
        lengths = {"height_std": 1e-3 * unit, "nominal_area": unit * unit, "contact_radius": radius * unit}
        return likely_cause(separation * unit, givens(**(lengths | changes)))

    assert "which is much for the patch" in cause(0.5)
    assert cause(0.02).startswith("there are too many asperities on the patch")
    assert cause(0.5, work=50.0) == "the work of adhesion is 50 J/m^2: is mJ/m^2 meant?"
    assert "is kPa, MPa or GPa meant" in cause(0.02, effective_modulus=3.0)
    assert "meant" not in cause(0.02, effective_modulus=3.0, work=0.0)
    assert cause(0.02, separation=-0.04) == "the flat goes down to -40 sigma: end the path higher"
    assert "sigma" not in cause(0.02, separation=-0.0005)
    assert "sigma" not in cause(0.02, separation=-0.04, height_std=0.0)
    assert "sigma" not in cause(0.02, separation=0.04)


@pytest.mark.parametrize("estimator", ["expected", "sampled"])
def test_the_expected_law_and_one_realisation_are_refused_alike(estimator: str) -> None:
    table = scene(
        adhesion=None, path={"separation": ["1 um", "-8 um"]}, batch={"estimator": estimator, "realizations": 1}
    )
    with pytest.raises(rm.OutOfRange, match=r"summed contact area is 1\.[0-9]+ times"):
        rm.run(table)


def test_a_run_that_was_not_foreseen_fails_with_the_reason() -> None:
    """Few asperities: the expected contact fraction is below 1, that of some realisations above."""
    asperities = {**SCENE["asperities"], "count": 3, "patch": "20 um"}
    table = scene(adhesion=None, asperities=asperities, path={"separation": ["1 um", "-0.6 um"]})
    with pytest.warns(UserWarning, match="failed"):
        made = rm.run(table)
    failed = made.status == 1
    assert 0 < int(failed.sum()) < made.sizes["realization"]
    assert "summed contact area" in str(made.remark.values[failed][0])
    assert (made.largest_contact_fraction.values[~failed.values] <= 1.0).all()


def test_an_ensemble_is_refused_alike_and_without_a_nominal_area_it_is_not() -> None:
    height = np.zeros(10)
    full = ensemble(height, area=1e-9, radius=50e-6)
    with pytest.raises(rm.OutOfRange, match=r"summed contact area is 1\.57 times"):
        rm.load_separation(full, separation=[-1e-6], effective_modulus=1e9)
    free = ensemble(height, area=None, radius=50e-6)
    assert float(rm.load_separation(free, separation=[-1e-6], effective_modulus=1e9).contact_count[0]) == 10


@pytest.mark.parametrize(("stop", "text"), [("0 sigma", "independent"), ("-0.5 sigma", "no contact area any more")])
def test_large_contact_fractions_are_warned_of(stop: str, text: str) -> None:
    table = scene(adhesion=None, path={"separation": {"start": "4 sigma", "stop": stop, "steps": 10}})
    if stop == "-0.5 sigma":
        table["asperities"]["count"] = 4000
    with pytest.warns(rm.LimitWarning, match=text):
        rm.run(table)


def test_a_warning_begins_where_independence_is_off_by_a_fifth() -> None:
    """Beyond 5 % contact; from 30 % on contacts overlap. Nothing is said where the fraction is not known."""
    for fraction in (0.0, 0.01, 0.05, float("nan")):
        assert fraction_warnings(fraction) == []
    for fraction in (0.051, 0.2, 0.3):
        assert "taken to be independent" in fraction_warnings(fraction)[0]
    for fraction in (0.31, 0.9, float("inf")):
        assert "contacts overlap" in fraction_warnings(fraction)[0]
