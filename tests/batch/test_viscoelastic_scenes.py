"""Scenes with [viscoelastic]: results over time, expected laws, sweeps, targets, and what is refused."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import roughmdr, said
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.report.cite import cite

TERMS = [{"time": "10 ms", "share": 0.3}, {"time": "1 s", "share": 0.4}]
BODY: dict[str, Any] = {"relaxation": TERMS, "speed": "1 um/s", "retraction_speed": "4 um/s", "dwell": "0.5 s"}
PATH: dict[str, Any] = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 20}, "hold": 4, "unload": True}
USUAL = ["force", "contact_area", "contact_count"]


def viscoelastic(**changes: Any) -> dict[str, Any]:
    """A small viscoelastic scene with sections replaced; None leaves one out."""
    return scene(**{"adhesion": None, "viscoelastic": BODY, "path": PATH, "batch": {"realizations": 3}, **changes})


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return rm.run(viscoelastic())


def test_the_time_of_each_step(result: xr.Dataset) -> None:
    h, t = result.separation.to_numpy(), result.time.to_numpy()
    assert result.time.attrs == {"units": "s", "long_name": "time since the first step"}
    assert (t[0], result.time.dims) == (0.0, ("step",))
    np.testing.assert_allclose(np.diff(t[:20]), -np.diff(h[:20]) / 1e-6, rtol=1e-12)
    np.testing.assert_allclose(np.diff(t[19:25]), 0.1, rtol=1e-12)  # four steps of hold and the repeated one
    np.testing.assert_allclose(np.diff(t[24:]), np.diff(h[24:]) / 4e-6, rtol=1e-12)


def test_the_variables_of_a_scene_that_names_none(result: xr.Dataset) -> None:
    assert [name for name in result.data_vars if result[name].dims == ("realization", "step")] == USUAL
    left_out = [line.split(": ")[0] for line in result.attrs["left_out"].splitlines()]
    assert "hysteresis" not in left_out
    assert "time" not in left_out
    assert any(line.startswith("time: ") for line in rm.run(scene(adhesion=None, batch=None)).left_out.splitlines())


def test_contacts_are_those_of_loading_and_the_loop_loses_energy(result: xr.Dataset) -> None:
    elastic = rm.run(viscoelastic(viscoelastic=None))
    for name in ("contact_area", "contact_count"):
        np.testing.assert_allclose(result[name][:, :20], elastic[name][:, :20], rtol=1e-12)
    held = result.isel(step=slice(19, 25))
    assert (np.diff(held.force, axis=1) < 0.0).all()
    assert not held.contact_area.diff("step").any()
    assert (result.roughmdr.hysteresis().energy_lost > 0.0).all()
    assert ((result.numerical_error > 0.0) & (result.numerical_error < 2e-9)).all()


def test_pressure_is_force_over_nominal_area() -> None:
    found = rm.run(viscoelastic(output={"variables": ["pressure", "force", "contact_fraction", "model_error_curve"]}))
    np.testing.assert_allclose(found.pressure, found.force / 1e-6, rtol=1e-15)


@pytest.mark.parametrize("speed", [1e-9, 1e-6, 1e-3])
def test_exponential_heights_have_a_closed_form(speed: float) -> None:
    """F_el falls as exp(-h/scale), so that each term keeps 1/(1 + scale/(v tau)) of it."""
    asperities = {**ASPERITIES, "height": {"distribution": "expon", "scale": "1 um"}, "radius": "50 um"}
    path = {"separation": ["6 um", "5 um", "4 um"]}
    body = {"relaxation": TERMS, "speed": speed}
    given = {"asperities": asperities, "path": path, "batch": {"estimator": "expected"}, "viscoelastic": body}
    force = rm.run(viscoelastic(**given)).force[0]
    modulus = rm.effective_modulus(3e6, 0.49)
    scale, terms = 1e-6, [(0.3, 0.01), (0.4, 1.0)]
    left = 0.3 + sum(g / (1.0 + scale / (speed * tau)) for g, tau in terms)
    elastic = (
        1000 * 4.0 / 3.0 * modulus * math.sqrt(50e-6) * scale**1.5 * math.gamma(2.5) * np.exp(-force.separation / scale)
    )
    np.testing.assert_allclose(force, left * elastic, rtol=1e-9)


@pytest.mark.large
def test_the_expected_law_is_the_mean_of_realisations() -> None:
    expected = rm.run(viscoelastic(batch={"estimator": "expected"})).force[0]
    many = rm.run(viscoelastic(batch={"realizations": 200}, output={"keep": "statistics"}))
    often = slice(12, 28)  # steps at which every realisation has contacts
    assert (np.abs(many.force_mean - expected)[often] <= 5.0 * many.force_sem[often]).all()
    assert many.time.dims == ("step",)


@pytest.mark.large
def test_a_sweep_over_speeds_has_a_time_for_each() -> None:
    speeds = ["0.1 um/s", "1 um/s", "10 um/s"]
    swept = rm.run(viscoelastic(sweep={"viscoelastic.speed": speeds, "viscoelastic.dwell": [0.0, "2 s"]}))
    assert swept.time.dims == ("viscoelastic_speed", "viscoelastic_dwell", "step")
    assert (swept.force[..., 19].diff("viscoelastic_speed") > 0.0).all()


@pytest.mark.large
def test_a_target_is_met_by_the_viscoelastic_law() -> None:
    path = {"separation": {"start": "clear", "stop": {"pressure": "1 kPa"}, "steps": 5}}
    given = {"path": path, "batch": {"estimator": "expected"}, "output": {"variables": ["pressure"]}}
    body = {"relaxation": TERMS, "speed": "1 um/s"}
    sweep = {"viscoelastic.speed": ["1 um/s", "100 um/s"]}
    found = rm.run(viscoelastic(**given, viscoelastic=body, sweep=sweep))
    np.testing.assert_allclose(found.pressure[:, 0, -1], 1000.0, rtol=1e-9)
    assert found.separation[0, -1] < found.separation[1, -1]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"adhesion": {"model": "jkr", "work": 0.05}}, "adhesion: does not go with [viscoelastic]"),
        ({"interaction": {"model": "mean_field"}}, "interaction: does not go with [viscoelastic]"),
        ({"reference": {"model": "boundary_elements"}}, "reference: does not go with [viscoelastic]"),
        ({"path": {"force": {"stop": "1 mN", "steps": 5}}}, "path.force: does not go with [viscoelastic]"),
        ({"path": {"preload": "1 mN"}}, "path.preload: does not go with [viscoelastic]"),
        ({"output": {"variables": ["force", "stiffness"]}}, "output.variables: stiffness cannot be computed"),
        ({"output": {"variables": ["energy"]}}, "output.variables: energy cannot"),
        ({"path": {"separation": ["3 um", "1 um", "2 um", "1 um"]}}, "path.separation: must fall to its lowest value"),
        ({"path": {"separation": ["3 um", "3 um", "2 um"], "unload": True}}, "step 1, 3 um, is against that"),
        ({"path": {"separation": ["1 um", "2 um"], "unload": True}}, "path.separation: must fall"),
        ({"path": {"separation": ["3 um", "1 um"]}}, "viscoelastic.dwell = 500 ms: has no step to end at"),
        ({"viscoelastic": {**BODY, "relaxation": []}}, "viscoelastic.relaxation"),
        ({"viscoelastic": {"relaxation": TERMS}}, "viscoelastic.speed: is missing"),
        ({"viscoelastic": {**BODY, "speed": 0}}, "viscoelastic.speed = 0: must be above 0"),
        ({"viscoelastic": {**BODY, "speed": "1 um"}}, "viscoelastic.speed = '1 um'"),
        ({"viscoelastic": {**BODY, "dwell": -1}}, "viscoelastic.dwell = -1: must be at least 0"),
        ({"viscoelastic": {**BODY, "speed": 1e-320}}, "takes longer than a float holds"),
        (
            {"viscoelastic": {**BODY, "relaxation": [{"time": 1, "share": 0.6}, {"time": 2, "share": 0.6}]}},
            "viscoelastic.relaxation: has shares of 1.2 together; they must be at most 1",
        ),
        (
            {"viscoelastic": {**BODY, "relaxation": [{"time": 1, "share": 1.5}]}},
            "viscoelastic.relaxation[0].share = 1.5: must be at most 1",
        ),
        ({"sweep": {"viscoelastic.relaxation.time": [1, 2]}}, "sweep.viscoelastic.relaxation.time: is no number"),
    ],
)
def test_what_does_not_go_together_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError) as error:
        rm.run(viscoelastic(**changes))
    assert says in str(error.value)


def test_no_work_of_adhesion_is_no_adhesion(result: xr.Dataset) -> None:
    found = rm.run(viscoelastic(adhesion={"model": "jkr", "work": 0.0}))
    np.testing.assert_array_equal(found.force, result.force)


def test_an_asperity_on_the_path_only_in_retraction() -> None:
    """A path that begins at its lowest separation comes there from infinity, at its speed."""
    whole, part = (
        rm.run(viscoelastic(path={"separation": list(path)}, viscoelastic={**BODY, "dwell": 0.0}))
        for path in (["4 um", "1 um", "1.2 um", "2 um"], ["1 um", "1.2 um", "2 um"])
    )
    np.testing.assert_allclose(whole.force[:, 1:], part.force, rtol=1e-8)


def test_the_commands(tmp_path: Path) -> None:
    file, out, picture = tmp_path / "scene.toml", tmp_path / "out.nc", tmp_path / "out.png"
    write_scene(tmp_path, viscoelastic(output={"variables": ["force"]}))
    assert "motion       " in said("plan", file)
    assert "motion       " in said("run", file, "-o", out)
    told = said("info", out)
    assert "integration  at most" in told
    assert "[interaction]" not in told.partition("left out")[0]
    for x in ("separation", "time"):
        said("plot", out, "-o", picture, "--x", x)
    plotted = said("plot", out, "-o", picture, "--with-theory")
    assert "for elastic bodies under a flat; the scene is of bodies that relax" in plotted
    refused = roughmdr("plot", out, "-o", picture, "--kind", "asperity")
    assert (refused.returncode, "the result is of bodies that relax" in refused.stderr) == (2, True)
    assert "Ting" in cite(out)
    assert "Radok" in cite(file)
    assert "Ting" not in cite(rm.run(scene(batch=None)))
