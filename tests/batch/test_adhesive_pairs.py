"""Scenes of asperities that adhere and feel each other: the whole way from the table to the file."""

import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import said
from forms import large
from scenes import scene

import roughmdr as rm

FEW: dict[str, Any] = {
    "source": "random",
    "shape": "paraboloid",
    "count": 30,
    "patch": "280 um",
    "radius": "50 um",
    "placement": "hard_core",
    "min_distance": "20 um",
    "height": {"distribution": "normal", "std": "0.3 um"},
}
PATH: dict[str, Any] = {"separation": {"start": "2.5 um", "stop": "0 um", "steps": 12}, "unload": True}
NAMES = ["force", "contact_count", "energy", "dissipated_energy", "stiffness"]


def sticky(realizations: int = 4, **changes: Any) -> dict[str, Any]:
    table = {"asperities": FEW, "path": PATH, "interaction": {"model": "pairwise"}, "output": {"variables": NAMES}}
    return scene(batch={"realizations": realizations}, **{**table, **changes})


@pytest.mark.large
def test_energy_is_lost_at_jumps_only(tmp_path: Path) -> None:
    """With twice the steps jumps lose as much, to where they are located; the loss never falls."""
    fine = {"separation": {**PATH["separation"], "steps": 23}, "unload": True}
    first, second = (rm.run(sticky(2, path=path), out=tmp_path / "r.nc", resume=False) for path in (PATH, fine))
    lost = second.dissipated_energy
    assert (lost.diff("step") >= 0.0).all()
    np.testing.assert_allclose(first.dissipated_energy[:, -1], lost[:, -1], rtol=1e-9)
    np.testing.assert_allclose(first.pull_off_force, second.pull_off_force, rtol=1e-9)
    np.testing.assert_array_equal(first.avalanche_count, second.avalanche_count)
    assert (first.avalanche_count > 0).all()
    assert (first.avalanche_size_max >= 1).all()
    assert float(first.marked_steps.max()) == 0.0


@pytest.mark.large
def test_the_demo_is_nearly_free_of_the_error_of_its_model() -> None:
    """Independent, its asperities would be off by more than a tenth."""
    demo = tomllib.loads((Path(__file__).parents[2] / "pipelines" / "scenes" / "rubber_on_glass.toml").read_text())
    law = rm.run(demo | {"batch": {**demo["batch"], "realizations": 1}})
    assert float(law.contact_fraction.max()) == pytest.approx(0.03, rel=0.1)
    assert 0.0 < float(law.model_error_curve.max()) < 0.05
    assert float(law.marked_steps.max()) == 0.0
    alone = {key: value for key, value in demo.items() if key != "interaction"}
    assert float(rm.run(alone | {"batch": {"estimator": "expected"}}).model_error_curve.max()) > 0.1


@pytest.mark.large
def test_commands_foresee_and_describe_them(tmp_path: Path) -> None:
    write_scene(tmp_path, sticky())
    plan = said("plan", "scene.toml", cwd=tmp_path)
    assert "asperities are coupled in pairs" in plan
    assert "time" in plan
    assert "avalanches   up to" in said("run", "scene.toml", "-o", "out.nc", "--workers", "2", cwd=tmp_path)
    assert "avalanches   up to" in said("info", "out.nc", cwd=tmp_path)


def test_contacts_that_overlap_as_soon_as_they_are_made_are_told() -> None:
    """The jump-on radius is 5.8 um, and neighbours are 11 um apart."""
    at = {"x": np.array([20e-6, 31e-6, 80e-6]), "y": np.full(3, 50e-6)}
    columns = {"height": np.zeros(3), "radius": np.full(3, 50e-6), **at}
    ensemble = xr.Dataset(
        {name: ("asperity", values) for name, values in columns.items()},
        attrs={"shape": "paraboloid", "patch": 100e-6, "area": 1e-8},
    )
    modulus = 2.0 * np.pi * 0.05 * 50e-6**2 / 5.84e-6**3
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", rm.LimitWarning)
        rm.load_separation(
            ensemble, separation=[1e-6, 0.0], effective_modulus=modulus, work=0.05, interaction="pairwise"
        )
    told = [str(one.message) for one in caught]
    assert any("(pairs: 1): jump-on radius 5.84 um, distance 11 um" in line for line in told), told


def test_warnings_that_differ_in_numbers_are_one_line() -> None:
    near = {**{key: value for key, value in FEW.items() if key != "min_distance"}, "placement": "random"}
    near |= {"patch": "60 um", "count": 10}
    path = {"separation": {"start": "1.5 um", "stop": "0.3 um", "steps": 3}}
    result = rm.run(sticky(3, asperities=near, path=path, output={"variables": ["force"]}))
    told = [line for line in result.attrs["warnings"].splitlines() if "as soon as" in line]
    assert len(told) == 1
    assert told[0].endswith("(2 more with other numbers)")


@pytest.mark.large
@pytest.mark.parametrize(
    "interaction", [large({"model": "pairwise", "order": 1}), {"model": "pairwise", "boundary": "free"}]
)
def test_steps_without_an_equilibrium_have_no_value_and_are_marked(tmp_path: Path, interaction: Any) -> None:
    """Contacts pressed into each other until they cover the patch; the file holds what there is, and can be read."""
    crowded = {**FEW, "patch": "60 um", "placement": "random", "height": {"distribution": "normal", "std": "3 um"}}
    crowded.pop("min_distance")
    path = {"separation": {"start": "9 um", "stop": "-9 um", "steps": 10}, "unload": True}
    result = rm.run(
        sticky(2, asperities=crowded, path=path, interaction=interaction, output={"variables": ["force"]}),
        out=tmp_path / "crowded.nc",
    )
    lost = result.force.isnull().sum("step")
    assert (result.marked_steps >= lost).all()
    assert (result.marked_steps > 0).all()
    with xr.open_dataset(tmp_path / "crowded.nc") as kept:
        np.testing.assert_array_equal(kept.force, result.force)
