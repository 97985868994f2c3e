"""Contact areas above the patch are refused before the run, with the likely cause."""

import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
import tomli_w
from scenes import SCENE, ensemble, scene

import roughmdr as rm
from roughmdr.batch import foresee

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
    command = [sys.executable, "-m", "roughmdr", "run", str(file), "-o", str(tmp_path / "out.nc")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert cause in done.stderr
    assert "runs" not in done.stderr  # no progress: nothing was run
    assert list(tmp_path.iterdir()) == [file]


def test_a_sweep_tells_which_cells_are_refused() -> None:
    table = scene(sweep={"material.modulus": [3e6, 3.0, 30.0]})
    with pytest.raises(rm.OutOfRange, match=r"material.modulus = 3.*2 of 3 cells"):
        rm.run(table)


def test_of_a_large_sweep_some_cells_are_checked_and_the_others_fail_with_the_reason() -> None:
    """So that the check does not take longer than small runs themselves."""
    modulus = np.geomspace(3e6, 9e6, 250).tolist()
    sweep = {"mode": "zip", "material.modulus": modulus}
    asperities = {**SCENE["asperities"], "count": 20}
    with patch.object(foresee, "_reason", wraps=foresee._reason) as checked:
        rm.run(scene(sweep=sweep, asperities=asperities))
    assert checked.call_count == 100
    modulus[1] = 3.0
    with pytest.warns(UserWarning, match="failed"):
        made = rm.run(scene(sweep=sweep, asperities=asperities))
    failed = (made.status == 1).any("realization")
    assert np.flatnonzero(failed).tolist() == [1]
    assert "summed contact area" in str(made.remark.values[1][0])
    modulus[-1] = 3.0
    with pytest.raises(rm.OutOfRange, match=r"modulus = 3.*1 of 100 cells"):
        rm.run(scene(sweep=sweep, asperities=asperities))


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
