"""Any scene is refused in words, or right as far as physics tells; and whoever judges that sees what is wrong."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scenes import ASPERITIES, CONDUCTION, scene
from studies.random_scenes.judge import COMPUTED, Defect, check, returns

import roughmdr as rm
from roughmdr.scene import read
from roughmdr.variables import CURVE_VARIABLES


def wound(**changes: Any) -> dict[str, Any]:
    """A scene in and out and in again, with all variables."""
    return scene(
        **{
            "asperities": {**ASPERITIES, "count": 100},
            "path": {"separation": ["2 sigma", 0.0, "1 sigma", 0.0, "2 sigma"], "unload": True},
            "output": {"variables": list(CURVE_VARIABLES)},
            "conduction": CONDUCTION,
            "batch": {"realizations": 2},
            **changes,
        }
    )


SCENES = {
    "without adhesion": wound(adhesion=None),
    "JKR": wound(),
    "statistics": wound(output={"variables": list(CURVE_VARIABLES), "keep": "statistics"}),
    "work": wound(sweep={"adhesion.work": [0.05, 0.0, 0.1]}),
    "expected": wound(batch={"estimator": "expected"}),
    "relaxation": wound(
        adhesion=None,
        viscoelastic={"relaxation": [{"time": 1.0, "share": 0.6}], "speed": 1e-6},
        path={"separation": {"start": "2 sigma", "stop": "-0.5 sigma", "steps": 10}, "unload": True},
        output={"variables": ["force", "contact_area", "contact_count"]},
    ),
}


def at(value: float, *names: str) -> Callable[[xr.Dataset], xr.Dataset]:
    """Puts a factor to the third step of the first realisation of variables."""

    def planted(result: xr.Dataset) -> xr.Dataset:
        changed = result.copy(deep=True)
        for name in names:
            place = (*(0,) * (changed[name].ndim - 1), 2)
            changed[name].values[place] *= value
        return changed

    return planted


def swapped(name: str, change: Callable[[xr.Dataset], xr.DataArray]) -> Callable[[xr.Dataset], xr.Dataset]:
    """Puts something else under a name."""
    return lambda result: result.assign({name: change(result)})


def failing(result: xr.Dataset) -> xr.Dataset:
    """All runs failed, for a reason that is none."""
    return result.assign(status=result.status + 1).assign_coords(remark=("realization", ["ZeroDivisionError: x"] * 2))


def pushing(result: xr.Dataset) -> xr.Dataset:
    """No tension anywhere."""
    return result.assign(force=np.abs(result.force), pressure=np.abs(result.pressure))


PLANTED: dict[str, tuple[str, Callable[[xr.Dataset], xr.Dataset], str]] = {
    "a NaN": ("JKR", at(np.nan, "force"), "force is a number"),
    "an infinite energy": ("JKR", at(np.inf, "energy"), "energy is not infinite"),
    "a NaN among statistics": ("statistics", at(np.nan, "stiffness_min"), "stiffness_min is a number"),
    "an unknown error": ("JKR", swapped("numerical_error", lambda r: r.numerical_error * np.nan), "an error is"),
    "half a contact": ("JKR", at(1.01, "contact_count"), "contact_count is whole"),
    "a force that remembers": ("without adhesion", at(1.0 + 1e-9, "force", "pressure"), "force .*"),
    "an area that falls": ("without adhesion", at(0.5, "contact_area", "contact_fraction"), ".*area.*"),
    "too large a stiffness": ("without adhesion", at(1.5, "stiffness"), "stiffness .*"),
    "a loss without adhesion": (
        "without adhesion",
        swapped("dissipated_energy", lambda r: r.energy),
        "nothing is lost",
    ),
    "an area that grows on the way out": ("JKR", at(100.0, "contact_area", "contact_fraction"), ".*area.*"),
    "a pressure of another force": ("JKR", at(1.001, "pressure"), "pressure is force over the nominal area"),
    "a force that is not lower after": ("JKR", pushing, "force after the flat was lower"),
    "a loss undone": ("JKR", swapped("dissipated_energy", lambda r: -r.dissipated_energy), "what is lost"),
    "a mean that is too large": ("statistics", at(3.0, "contact_area_mean"), ".*contact_area.*"),
    "more force with more work": ("work", swapped("force", lambda r: r.force * r.adhesion_work), ".*force.*"),
    "a force that pulls": ("relaxation", at(-1.0, "force"), "force is not negative"),
    "a force that unloading raises": (
        "relaxation",
        swapped("force", lambda r: r.force * xr.where(r.branch == "unloading", 5.0, 1.0)),
        "force does not rise",
    ),
    "an area of the expected law": ("expected", at(100.0, "contact_area", "contact_fraction"), "contact_area .*"),
    "a reason that is none": ("JKR", failing, "a run fails for a reason"),
}


@pytest.fixture(scope="module")
def results() -> dict[str, xr.Dataset]:
    return {name: rm.run(table) for name, table in SCENES.items()}


@pytest.mark.few(2)
@pytest.mark.parametrize("name", SCENES)
def test_the_judge_lets_pass_what_is_right(results: dict[str, xr.Dataset], name: str) -> None:
    assert check(results[name], read(SCENES[name])) > 300


@pytest.mark.parametrize("name", PLANTED)
def test_the_judge_sees_what_is_wrong(results: dict[str, xr.Dataset], name: str) -> None:
    which, planted, says = PLANTED[name]
    with pytest.raises(Defect, match=says):
        check(planted(results[which]), read(SCENES[which]))


def test_returns_are_pairs_of_steps_at_the_same_separation() -> None:
    path = np.array([2.0, 1.0, 2.0, 4.0, 2.0, 3.0, 1.0])
    # Before and after the flat was lower only; after and before it was higher only; none where it was both.
    assert returns(path) == [(0, 2), (4, 2), (6, 1)]
    assert returns(np.array([2.0, 1.0, 3.0, 2.0])) == []


@pytest.mark.large
def test_any_scene_is_refused_or_right(tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "pipelines" / "study.py"
    done = subprocess.run(
        [sys.executable, script, "random_scenes", "-o", tmp_path, "--quick"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "random_scenes.nc") as result:
        count = result.sizes["scene"]
        assert f"{count} scenes drawn" in done.stdout
        assert (result.outcome == COMPUTED).sum() > 0.6 * count
