"""Lateral paths in scenes: what is held, what they are made of, and how batches, files and summaries have them."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import said
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.scene import read
from roughmdr.scene.lateral import LateralRange, displacements

VARIABLES = ["tangential_force", "tangential_stiffness", "friction_energy", "force", "contact_radius_sum"]
STEEL = {"modulus": "210 GPa", "poisson": 0.3}
RATIO = 2.0 * 0.7 / 1.7
CYCLES = {"amplitude": "40 nm", "cycles": 2, "steps": 8}


def lateral(**changes: Any) -> dict[str, Any]:
    """A scene with a lateral path; sections are replaced."""
    path = {"separation": "1 sigma", "lateral": CYCLES}
    asperities = {**ASPERITIES, "count": 200}
    base = {
        "adhesion": None,
        "material": STEEL,
        "tangential": {"friction": 0.3},
        "asperities": asperities,
        "path": path,
    }
    return scene(**{**base, "output": {"variables": VARIABLES}, "batch": {"realizations": 3}, **changes})


def along(path: Any, **changes: Any) -> xr.Dataset:
    return rm.run(lateral(path={"separation": "1 sigma", "lateral": path}, **changes))


def test_cycles_go_to_the_amplitude_and_then_between_both() -> None:
    u = displacements(LateralRange(amplitude=2.0, cycles=2, steps=2))
    assert u.tolist() == [0.0, 1.0, 2.0, *[1.0, 0.0, -1.0, -2.0, -1.0, 0.0, 1.0, 2.0] * 2]
    result = rm.run(lateral())
    assert result.sizes == {"realization": 3, "step": 1 + 9 * 8}
    assert result["lateral"].attrs["units"] == "m"
    assert set(result.branch.values[:9]) == {"loading"}
    assert set(result.branch.values[9:25]) == {"unloading"}
    force = result.tangential_force.values
    np.testing.assert_array_equal(force[:, 9:41], force[:, 41:])  # cycles repeat, bit for bit
    np.testing.assert_array_equal(force[:, 24], -force[:, 8])
    loss = np.diff(result.friction_energy.values[:, [8, 24, 40, 56, 72]], axis=1)
    np.testing.assert_allclose(loss, loss[:, :1] * np.ones(4), rtol=1e-9)


def test_a_separation_is_held() -> None:
    result = along({"stop": "100 nm", "steps": 11}, batch={"realizations": 1})
    one = result.isel(realization=0)
    assert (one.separation == 1e-6).all()
    normal = rm.run(
        lateral(path={"separation": (1e-6 + one["lateral"].values * RATIO / 0.3).tolist()}, batch=None,
                output={"variables": ["force", "contact_radius_sum"]})
    ).isel(realization=0)  # fmt: skip
    np.testing.assert_allclose(one.tangential_force, 0.3 * (one.force - normal.force), rtol=1e-13)
    modulus = rm.effective_modulus(210e9, 0.3)
    np.testing.assert_allclose(one.tangential_stiffness, 2.0 * RATIO * modulus * normal.contact_radius_sum, rtol=1e-13)
    assert (one.contact_radius_sum == normal.contact_radius_sum[0]).all()


@pytest.mark.few(1)
@pytest.mark.parametrize(("key", "value"), [("force", "1 N"), ("pressure", "1 MPa")])
@pytest.mark.parametrize("estimator", ["sampled", "expected"])
def test_a_load_is_held_at_a_separation_of_its_own(key: str, value: str, estimator: str) -> None:
    batch = {"estimator": estimator, **({"realizations": 3} if estimator == "sampled" else {})}
    result = rm.run(lateral(path={key: value, "lateral": CYCLES}, batch=batch))
    np.testing.assert_allclose(result.force, 1.0, rtol=1e-9)
    assert len(np.unique(result.separation)) == result.sizes["realization"]
    path = {"separation": float(result.separation[-1, 0]), "lateral": CYCLES}
    again = rm.run(lateral(path=path, batch=batch))
    for name in ("tangential_force", "friction_energy"):
        np.testing.assert_array_equal(again[name][-1], result[name][-1])


def test_exponential_heights_have_a_law_in_closed_form() -> None:
    """F falls as exp(-h/sigma), and with it U = sigma F, all for h >= 0."""
    height = {"distribution": "exponential", "scale": "1 um"}
    asperities = {**ASPERITIES, "height": height, "radius": "50 um"}
    u = {"stop": "2 um", "steps": 41}
    law = along(u, asperities=asperities, batch={"estimator": "expected"}).isel(realization=0)
    way = law["lateral"] * RATIO / 0.3 / 1e-6
    load = 0.3 * law.force
    tolerance = 1e-11 * float(load[0])
    np.testing.assert_allclose(law.tangential_force, load * -np.expm1(-way), rtol=0.0, atol=tolerance)
    rest = np.exp(-way)
    lost = load * law["lateral"] * (1.0 + rest) - 2.0 * load * 1e-6 * (0.3 / RATIO) * (1.0 - rest)
    np.testing.assert_allclose(law.friction_energy, lost, rtol=0.0, atol=2e-6 * tolerance)
    np.testing.assert_allclose(law.tangential_stiffness, law.tangential_stiffness[0] * rest, rtol=1e-9)


@pytest.mark.large
def test_draws_tend_to_the_expected_law() -> None:
    expected = rm.run(lateral(batch={"estimator": "expected"})).isel(realization=0)
    drawn = rm.run(lateral(batch={"realizations": 400}, output={"variables": VARIABLES, "keep": "statistics"}))
    for name in ("tangential_force", "friction_energy"):
        off = (drawn[f"{name}_mean"] - expected[name]) / drawn[f"{name}_sem"]
        assert float(abs(off[8])) < 4.0


@pytest.mark.parametrize("units", [1e-3, 1e3])
def test_other_units_change_nothing_but_the_unit(units: float) -> None:
    def at(length: float) -> xr.Dataset:
        height = {"distribution": "normal", "std": 1e-6 * length}
        asperities = {**ASPERITIES, "count": 200, "height": height, "radius": 5e-5 * length, "patch": 1e-3 * length}
        path = {"separation": "1 sigma", "lateral": [4e-8 * length, -2e-8 * length, 9e-8 * length]}
        return rm.run(lateral(asperities=asperities, path=path))

    one, other = at(1.0), at(units)
    for name, power in (("tangential_force", 2), ("tangential_stiffness", 1), ("friction_energy", 3)):
        np.testing.assert_allclose(other[name], one[name] * units**power, rtol=1e-8)


def test_a_swept_path_is_one_of_each_cell_and_any_other_is_of_all() -> None:
    swept = rm.run(lateral(sweep={"tangential.friction": [0.1, 0.3], "path.separation": ["0 sigma", "1 sigma"]}))
    assert swept.tangential_force.dims == ("tangential_friction", "path_separation", "realization", "step")
    assert swept["lateral"].dims == ("step",)
    wider = rm.run(lateral(sweep={"path.lateral.amplitude": ["20 nm", "40 nm"]}))
    assert wider["lateral"].dims == ("path_lateral_amplitude", "step")


def test_an_asked_error_is_that_of_the_tangential_force() -> None:
    result = rm.run(
        lateral(accuracy={"relative": 0.05, "method": "sampled"}, batch={}, output={"variables": ["friction_energy"]})
    )
    assert "tangential_force" not in result
    force = rm.run(lateral(batch={"realizations": int(result.realization_count)})).tangential_force
    mean, error = force.mean("realization"), force.std("realization", ddof=1) / math.sqrt(force.sizes["realization"])
    assert 0.8 * float((error / abs(mean).max()).max()) < float(result.accuracy_reached) < 0.05


def test_a_section_that_nothing_uses_changes_no_bit() -> None:
    plain, path = {"variables": ["force", "stiffness", "energy"]}, {"separation": ["2 sigma", "1 sigma"]}
    with_section = rm.run(lateral(path=path, output=plain))
    without = rm.run(lateral(path=path, output=plain, tangential=None))
    for name in plain["variables"]:
        np.testing.assert_array_equal(with_section[name], without[name])


@pytest.mark.parametrize("adhesion", [None, {"model": "jkr", "work": "50 mJ/m^2"}])
def test_a_normal_path_has_the_stiffness_of_contacts_that_stick(adhesion: dict[str, Any] | None) -> None:
    path = {"separation": ["3 sigma", "1 sigma", "2 sigma"]}
    output = {"variables": ["tangential_stiffness", "contact_radius_sum", "stiffness"]}
    result = rm.run(lateral(path=path, output=output, tangential={}, adhesion=adhesion))
    both = 2.0 * RATIO * rm.effective_modulus(210e9, 0.3)
    np.testing.assert_allclose(result.tangential_stiffness, both * result.contact_radius_sum, rtol=1e-14)
    if adhesion is None:
        np.testing.assert_allclose(result.tangential_stiffness, RATIO * result.stiffness, rtol=1e-12)
    asked = {"variables": ["tangential_stiffness"]}
    alone = rm.run(lateral(path=path, output=asked, tangential={"stiffness_ratio": 0.9}, adhesion=adhesion,
                           material={"effective_modulus": "2 GPa"}))  # fmt: skip
    assert [name for name in alone.data_vars if name in VARIABLES] == ["tangential_stiffness"]


def test_the_loop_of_the_accessor_loses_the_friction_energy() -> None:
    fine = rm.run(lateral(path={"separation": "1 sigma", "lateral": {"amplitude": "40 nm", "steps": 200}}))
    loop = fine.isel(step=slice(200, None)).roughmdr.hysteresis()
    lost = fine.friction_energy[:, -1] - fine.friction_energy[:, 200]
    assert (abs(loop.energy_lost - lost) <= loop.energy_lost_interpolation_error).all()
    np.testing.assert_allclose(loop.energy_lost, lost, rtol=1e-3)
    assert "pull-off" not in repr(fine.roughmdr)


def test_variables_unless_they_are_named() -> None:
    assert read(lateral(output=None)).output.variables == ["tangential_force", "tangential_stiffness", "force"]
    kept = read(lateral(output={"keep": "statistics"})).output
    assert (kept.variables, kept.keep) == (["tangential_force", "tangential_stiffness", "force"], "statistics")


_NORMAL = {"separation": ["1 sigma"]}


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"tangential": None}, "tangential.friction: is missing; path.lateral needs it"),
        ({"tangential": {}}, "tangential.friction: is missing"),
        ({"tangential": {"friction": 0.0}}, "tangential.friction = 0.0: must be above 0"),
        ({"tangential": {"friction": 0.3, "stiffness_ratio": 2.0}}, "stiffness_ratio = 2.0: must be at most 1.5"),
        ({"tangential": {"friction": 0.3, "stiffness_ratio": 0.8}}, "stiffness_ratio: follows from the modulus"),
        ({"material": {"effective_modulus": 1e9}}, "tangential.stiffness_ratio: is missing; path.lateral needs G"),
        ({"adhesion": {"model": "jkr", "work": 0.05}}, "path.lateral: does not go with adhesion"),
        (
            {"interaction": {"model": "mean_field"}},
            "interaction: does not go with path.lateral: contacts that feel each other begin to slip",
        ),
        ({"reference": {"model": "boundary_elements"}}, "reference: does not go with path.lateral"),
        ({"path": {"lateral": CYCLES}}, "path.separation: is missing"),
        ({"path": {"separation": ["1 sigma"], "lateral": CYCLES}}, "path.separation: must be a single value"),
        ({"path": {"force": "0 N", "lateral": CYCLES}}, "path.force: must be above 0"),
        ({"path": {"pressure": "-1 Pa", "lateral": CYCLES}}, "path.pressure: must be above 0"),
        ({"path": {"preload": "1 N", "lateral": CYCLES}}, "path.preload: does not go with path.lateral"),
        ({"path": {"separation": "1 um", "machine_stiffness": 1.0, "lateral": CYCLES}}, "path.machine_stiffness: goes"),
        ({"path": {"separation": "1 um", "lateral": []}}, "path.lateral"),
        ({"path": {"separation": "1 um", "lateral": {"steps": 5}}}, "path.lateral: takes either stop or amplitude"),
        (
            {"path": {"separation": "1 um", "lateral": {"stop": 1, "cycles": 2, "steps": 5}}},
            "cycles = 2: goes with amp",
        ),
        ({"path": {"separation": "1 um", "lateral": {**CYCLES, "start": 0}}}, "start = 0.0: goes with stop only"),
        ({"path": {"separation": "1 um", "lateral": {**CYCLES, "steps": 9_000_000}}}, "make 81000001 steps in all"),
        (
            {"path": {"separation": "1 um", "lateral": [1e308, -1e308]}},
            "path.lateral: reaches beyond the largest float",
        ),
        ({"path": {"separation": "1 um"}}, "path.separation = '1 um': must be a table"),
        ({"path": _NORMAL}, "output.variables: tangential_force needs a lateral path"),
        (
            {"path": _NORMAL, "output": {"variables": ["tangential_stiffness"]}, "tangential": None},
            "tangential: is missing; tangential_stiffness among output.variables needs it",
        ),
    ],
    ids=str,
)
def test_what_does_not_go_together_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError) as refused:
        rm.run(lateral(**changes))
    assert says in str(refused.value)


def test_a_load_that_is_out_of_reach_is_refused() -> None:
    with pytest.raises(rm.RoughmdrError):
        rm.run(lateral(path={"force": "1e300 N", "lateral": CYCLES}))
    with pytest.raises(rm.OutOfRange, match="rounding leaves less than six digits"):
        rm.run(lateral(tangential={"friction": 1e13}))


@pytest.mark.large
def test_commands(tmp_path: Path) -> None:
    file, out = tmp_path / "scene.toml", tmp_path / "loop.nc"
    write_scene(tmp_path, lateral())
    plan = said("plan", file)
    assert "displacement from -40 to 40 nm" in plan
    assert "Dundurs' beta is 0.29" in plan
    assert json.loads(said("plan", file, "--json"))["plan"]["control"] == "lateral"
    said("run", file, "-o", out, "--quiet")
    info = said("info", out)
    assert "Dundurs' beta is 0.29" in info
    assert "pull-off" not in info
    assert "[interaction] model" not in info
    assert "tangential_force" in json.loads(said("info", out, "--json"))["result"]["variables"]
    with xr.open_dataset(out) as stored:
        np.testing.assert_array_equal(stored.tangential_force, rm.run(lateral()).tangential_force)
        assert stored["lateral"].dims == ("step",)
        axes = rm.plot(stored).axes
        assert [each.get_ylabel().partition(" [")[0] for each in axes if each.get_visible()] == [
            "tangential force", "tangential stiffness", "friction energy"
        ]  # fmt: skip
        assert axes[0].get_xlabel() == "lateral displacement [nm]"


def test_papers_of_slip_are_cited() -> None:
    told = rm.cite(read(lateral()))
    for name in ("Cattaneo", "Mindlin", "Jäger", "Masing"):
        assert name in told
    assert "Cattaneo" not in rm.cite(read(lateral(path=_NORMAL, output={"variables": ["tangential_stiffness"]})))
