"""[reference]: boundary elements beside the law of a scene, in results, statistics, lines and pictures."""

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from batches import write_scene
from command import said
from forms import large
from oracles.boundary_elements import HeightMap
from scenes import scene

import roughmdr as rm
from roughmdr.ensemble.spectral.section import SpectrumAsperities

SURFACE = {
    "source": "spectrum",
    "patch": "100 um",
    "hurst": 0.8,
    "long_wave": "50 um",
    "short_wave": "10 um",
    "rms_slope": 0.05,
}
CROWD = {
    "source": "random",
    "shape": "paraboloid",
    "count": 40,
    "patch": "200 um",
    "radius": "50 um",
    "height": {"distribution": "normal", "std": "0.3 um"},
}
ELEMENTS = {"model": "boundary_elements"}


def of_spectrum(**changes: Any) -> dict[str, Any]:
    table = {
        "adhesion": None,
        "asperities": SURFACE,
        "interaction": {"model": "pairwise"},
        "reference": ELEMENTS,
        "path": {"separation": ["3 sigma", "2 sigma", "1.2 sigma"]},
        "batch": {"realizations": 2},
    }
    return scene(**(table | changes))


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return rm.run(of_spectrum())


@pytest.mark.large
def test_it_is_the_force_of_another_program_on_the_same_map(result: xr.Dataset) -> None:
    section = SpectrumAsperities.model_validate({**SURFACE, "points": 16.0})
    modulus = rm.effective_modulus("3 MPa", 0.49)
    for realization in (0, 1):
        height_map = section.height_map(7, realization)
        solver = HeightMap(height_map.height, section.patch, modulus)
        for step, h in enumerate(result["separation"].to_numpy()):
            force, stated = (float(result[name][realization, step]) for name in ("reference_force", "reference_error"))
            largest = float(result["reference_force"][realization].max())
            assert abs(solver.press(h).force - force) <= stated * max(force, 0.01 * largest) + 1e-3 * force


def test_hills_are_near_it(result: xr.Dataset) -> None:
    loaded = result["reference_force"] > 0.02 * result["reference_force"].max()
    off = (result["force"] / result["reference_force"] - 1.0).where(loaded)
    assert float(abs(off).max()) < 0.1
    assert (result["reference_points"] >= 16**2).all()
    assert float(result["reference_error"].where(loaded).max()) <= 0.02


@pytest.mark.large
def test_variables_beside_those_that_are_asked_for() -> None:
    asked = ["contact_fraction", "pressure"]
    found = rm.run(of_spectrum(output={"variables": asked, "keep": "statistics"}, reference={**ELEMENTS, "error": 0.1}))
    curves = rm.run(of_spectrum(output={"variables": [*asked, "force"]}, reference={**ELEMENTS, "error": 0.1}))
    for name in ("reference_force", "reference_pressure", "reference_contact_fraction", "reference_error"):
        np.testing.assert_allclose(found[f"{name}_mean"], curves[name].mean("realization"), rtol=1e-12)
    assert "reference_stiffness" not in curves
    there = found.roughmdr.at_pressure("2 kPa", reference=True)
    stated = there.reference_area_error_mean * there.reference_contact_fraction_mean
    np.testing.assert_allclose(there.reference_contact_fraction_mean_error, stated, rtol=1e-12)
    assert 0.0 < float(there.reference_separation_error) < 1e-8
    np.testing.assert_allclose(curves["reference_pressure"], curves["reference_force"] / 1e-8, rtol=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_asperities_on_a_plane_are_pressed_as_the_surface_that_they_make(boundary: str) -> None:
    interaction = {"model": "pairwise", "boundary": boundary}
    path = {"separation": ["0.6 um", "0.3 um"]}
    table = {"interaction": interaction, "reference": {**ELEMENTS, "error": 0.05}, "path": path}
    found = rm.run(scene(adhesion=None, asperities=CROWD, batch={"realizations": 2}, **table))
    loaded = found["reference_force"] > 0.05 * found["reference_force"].max()
    off = (found["force"] / found["reference_force"] - 1.0).where(loaded)
    assert (abs(off) <= found["reference_error"] + 0.02).where(loaded, other=True).all()


def test_where_the_reference_reaches_a_pressure(result: xr.Dataset) -> None:
    steps = np.array([0.3, 0.8]) * float(result["reference_force"].max("step").min())
    there = result.roughmdr.at_pressure(steps / 1e-8, reference=True)
    assert there.sizes == {"realization": 2, "reference_pressure": 2}
    for realization in (0, 1):
        one, found = result.isel(realization=realization), there.isel(realization=realization)
        for name in ("separation", "force", "reference_contact_area"):
            values = np.broadcast_to(one[name].values, one.reference_force.shape)
            np.testing.assert_allclose(found[name], np.interp(steps, one.reference_force, values), rtol=1e-9)
    np.testing.assert_allclose(result.roughmdr.at_force(steps, reference=True).separation, there.separation, rtol=1e-9)
    with pytest.raises(rm.OutOfRange, match="reference_contact_fraction is 2; it must be at most 1"):
        result.roughmdr.at_contact_fraction(2.0, reference=True)
    with pytest.raises(rm.StoreError, match="at_force with reference=True needs 'reference_force', which"):
        result.drop_vars("reference_force").roughmdr.at_force(1e-6, reference=True)


@pytest.mark.large
@pytest.mark.parametrize(
    ("periodic", "interaction", "line"),
    [
        (False, {"model": "pairwise"}, "a patch that repeats, opposite edges joined, though the map is not periodic"),
        (False, {"model": "pairwise", "boundary": "free"}, "pressed alone on a half-space"),
        (False, None, "pressed alone on a half-space"),
        (True, None, "pressed as a patch that repeats"),
    ],
)
def test_what_is_pressed_beyond_the_border_of_a_map_is_said(
    tmp_path: Path, periodic: bool, interaction: dict[str, str] | None, line: str
) -> None:
    x = np.arange(0.0, 40e-6, 1e-6)
    waves = 1e-7 * np.cos(2 * np.pi * x / 2e-5)[:, None] * np.cos(2 * np.pi * x / 2e-5)
    xr.Dataset({"height": (("x", "y"), waves, {"units": "m"})}, {"x": x, "y": x}).to_netcdf(tmp_path / "map.nc")
    asperities = {"source": "surface", "file": str(tmp_path / "map.nc"), "model": "hills", "periodic": periodic}
    table = of_spectrum(asperities=asperities, interaction=interaction, batch=None)
    light = {"separation": ["95 nm"]}
    mean_field = {**table, "interaction": {"model": "mean_field"}, "reference": None, "path": light}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        assert rm.run(table).attrs["map"].endswith(line)
        assert "pressed" not in rm.run(mean_field).attrs["map"]


def test_errors_by_the_grid_are_those_at_what_is_given(result: xr.Dataset) -> None:
    """At given separation all share the error of the force; at given force the area has its own, the stiffness half."""
    last = result.isel(step=[-1])
    of_force = last.reference_error * last.reference_force
    there = result.roughmdr.at_separation(last.separation.values)
    names = ("reference_force", "reference_contact_area", "reference_stiffness")
    for name in names:
        assert there[f"{name}_error"].attrs["units"] == result[name].attrs["units"]
        np.testing.assert_allclose(there[name].values, last[name].values, rtol=1e-12)
    np.testing.assert_allclose(there.reference_force_error.values, of_force.values, rtol=1e-12)
    assert "reference_separation_error" not in there

    own = (last.reference_area_error * last.reference_contact_area).values
    before = result.isel(step=[-2])
    per_force = (last.reference_contact_area - before.reference_contact_area.values) / (
        last.reference_force - before.reference_force.values
    )
    expected = np.hypot(own, per_force * of_force)
    np.testing.assert_allclose(there.reference_contact_area_error.values, expected.values, rtol=1e-9)

    at = result.roughmdr.at_force(last.reference_force.values[:, 0], reference=True)
    for run in (0, 1):
        one = at.isel(realization=run, reference_force=run)
        assert float(one.reference_contact_area_error) == pytest.approx(own[run, 0], rel=1e-9)
        half = 0.5 * float(last.reference_area_error[run, 0] * last.reference_stiffness[run, 0])
        assert float(one.reference_stiffness_error) == pytest.approx(half, rel=1e-9)
        assert one.reference_separation_error.attrs["units"] == "m"
        shift = float(of_force[run, 0] / last.reference_stiffness[run, 0])
        assert shift < float(one.reference_separation_error) < 2.5 * shift  # the chord is less steep than the law
    by_asperities = result.roughmdr.at_force(last.force.values[0])
    np.testing.assert_allclose(
        by_asperities.reference_contact_area_error.values[0], there.reference_contact_area_error.values[0], rtol=1e-9
    )
    fraction = result.roughmdr.at_contact_fraction(0.02, reference=True)
    assert (fraction.reference_contact_area_error == 0.0).all()
    assert (fraction.reference_force_error > 0.0).all()


@pytest.mark.large
def test_a_coarse_area_and_stiffness_are_within_their_errors_of_a_fine_one() -> None:
    coarse, fine = (
        rm.run(
            of_spectrum(reference={**ELEMENTS, "error": each}, path={"separation": {"stop": "1.2 sigma", "steps": 9}})
        )
        for each in (0.2, 0.002)
    )
    force = np.array([0.2, 0.5, 0.9]) * float(fine.reference_force.max("step").min())
    for one, other in (
        [each.roughmdr.at_force(force, reference=True) for each in (coarse, fine)],
        [each.roughmdr.at_separation(fine.separation.values[5:]) for each in (coarse, fine)],
    ):
        for name in ("reference_contact_area", "reference_stiffness"):
            stated = one[f"{name}_error"] + other[f"{name}_error"]
            slack = one[f"{name}_interpolation_error"] + other[f"{name}_interpolation_error"]
            assert (abs(one[name] - other[name]) <= stated + slack).all()


def test_the_reference_does_not_change_the_law(result: xr.Dataset) -> None:
    without = rm.run(of_spectrum(reference=None))
    np.testing.assert_array_equal(result["force"], without["force"])
    assert "reference_force" not in without
    assert "boundary elements: the scene has no [reference]" in without.attrs["left_out"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"adhesion": {"model": "jkr", "work": 1e-3}}, "reference: does not go with adhesion"),
        (
            {"path": {"preload": "1 uN", "steps": 3}},
            "goes with path.separation, path.force, path.pressure, not with path.preload",
        ),
        ({"reference": {"model": "boundary_elements", "error": 0.0}}, "at least 0.001"),
        ({"reference": {}}, "reference.model"),
        (
            {"asperities": CROWD, "interaction": None, "batch": {"estimator": "expected"}},
            "the reference presses single surfaces",
        ),
    ],
)
def test_what_has_no_reference_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(rm.SceneError) as refused:
        rm.run(of_spectrum(**changes))
    assert message in str(refused.value)


def test_a_file_without_positions_or_with_hills_has_no_reference(tmp_path: Path) -> None:
    hills = rm.generate(SURFACE, seed=1)
    for changed, message in ((hills, "how their map looks"), (hills.drop_vars(["x", "y"]), "need x and y")):
        changed.to_netcdf(tmp_path / "asperities.nc")
        asperities = {"source": "file", "file": str(tmp_path / "asperities.nc")}
        table = of_spectrum(asperities=asperities, interaction=None, batch=None)
        with pytest.raises(rm.SceneError, match=message):
            rm.run(table)


@pytest.mark.large
def test_below_the_mean_height_there_is_no_reference_and_it_is_said() -> None:
    table = of_spectrum(path={"separation": ["2 sigma", "-0.5 sigma"]}, interaction=None, batch=None)
    with pytest.warns(rm.LimitWarning, match="no equilibrium at 1 steps"):
        found = rm.run(table)
    assert np.isnan(found["reference_force"][0, 1])
    assert np.isfinite(found["reference_force"][0, 0])


@pytest.mark.large
def test_commands_tell_and_draw_it(tmp_path: Path) -> None:
    file, out, picture = tmp_path / "scene.toml", tmp_path / "out.nc", tmp_path / "out.png"
    file.write_text(tomli_w.dumps(of_spectrum()))

    planned = said("plan", file)
    assert "boundary elements beside each realisation, their grid right to 0.02;" in planned
    assert "few and small contacts need finer grids: in all up to about" in planned
    ran = said("run", file, "-o", out, "--quiet") + said("info", out)
    assert "reference    boundary elements on up to" in ran
    assert re.search(r"right to about \S+ % \(area at given force: \S+ to \S+ %\): the mean force of the law", ran)
    assert "advice       believe boundary elements, which press the map itself; the asperities are right" in ran
    assert re.search(r"pressure     \S+ kPa, \S+ kPa by boundary elements, on average in the contacts", ran)
    assert "reference    drawn" in said("plot", out, "-o", picture, "--with-reference")
    assert picture.stat().st_size > 10_000
    plain = tmp_path / "plain.nc"
    file.write_text(tomli_w.dumps(of_spectrum(reference=None)))
    assert "--set reference.model=boundary_elements" in said("run", file, "-o", plain)
    assert "reference    not drawn" in said("plot", plain, "-o", picture, "--with-reference")


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("changes", "advised"),
    [
        ({"reference": None}, "believe boundary elements most"),
        ({"reference": None, "interaction": None}, 'or take asperities.model = "hills" with [interaction]'),
        large(
            {"reference": None, "adhesion": {"model": "jkr", "work": 1e-6}},
            "believe hills in pairs as far as they have values",
        ),
        ({"reference": None, "adhesion": {"model": "jkr", "work": "0 mJ/m^2"}}, "believe boundary elements most"),
        ({"asperities": {**SURFACE, "hurst": 0.3, "points": 2.5}}, "the map is too coarse for hills and boundary"),
        (
            {"asperities": {**SURFACE, "hurst": 0.3, "points": 2.5, "model": "summits"}},
            "the map is too coarse or noisy for its summits",
        ),
    ],
)
def test_advice_says_which_model_to_believe(changes: dict[str, Any], advised: str, tmp_path: Path) -> None:
    write_scene(tmp_path, of_spectrum(**changes))
    assert advised in said("plan", "scene.toml", cwd=tmp_path)


@pytest.mark.large
def test_the_error_is_relative_to_the_force_that_is_asked_for() -> None:
    coarse, fine = (rm.run(of_spectrum(reference={**ELEMENTS, "error": each})) for each in (0.2, 0.005))
    assert float(coarse["reference_points"].max()) < float(fine["reference_points"].max())
    off = np.abs(coarse["reference_force"] / fine["reference_force"] - 1.0).fillna(0.0)  # out of contact
    assert (off <= coarse["reference_error"] + fine["reference_error"]).all()
    np.testing.assert_array_equal(fine["force"], coarse["force"])


@pytest.mark.large
def test_under_a_load_it_stands_where_it_bears_that_load(result: xr.Dataset) -> None:
    """The way back: the separations that loads lead to bear these loads, with the same other numbers."""
    loads = result["reference_force"][0].to_numpy()
    path = {"force": [0.0, *(float(load) for load in loads)]}
    found = rm.run(of_spectrum(path=path, batch={"realizations": 1})).isel(realization=0)
    np.testing.assert_allclose(found["reference_force"][1:], loads, rtol=1e-3)
    assert found["reference_force"][0] == 0.0
    separation = found["reference_separation"].to_numpy()
    back = rm.run(of_spectrum(path={"separation": [float(h) for h in separation]}, batch={"realizations": 1}))
    for name in ("force", "contact_area", "stiffness"):
        np.testing.assert_allclose(back[f"reference_{name}"][0], found[f"reference_{name}"], rtol=0.02)
    off = np.abs(separation[1:] - result["separation"].to_numpy())
    assert (off <= 0.02 * loads / found["reference_stiffness"][1:].to_numpy()).all()


@pytest.mark.parametrize(("length", "modulus"), [(1.0, 1.0), (1e-9, 1e9), (1e3, 1e-3)])
def test_a_lone_sphere_under_a_load_is_that_of_Hertz(length: float, modulus: float, tmp_path: Path) -> None:
    alone = xr.Dataset(
        {name: ("asperity", [value]) for name, value in {"height": 0.0, "radius": length, "x": 0.0, "y": 0.0}.items()},
        attrs={"shape": "paraboloid"},
    )
    alone.to_netcdf(tmp_path / "one.nc")
    loads = modulus * length**2 * np.array([5e-4, 1e-3])
    found = rm.run({
        "title": "One", "material": {"effective_modulus": modulus},
        "asperities": {"source": "file", "file": str(tmp_path / "one.nc")},
        "interaction": {"model": "pairwise", "boundary": "free"}, "reference": {**ELEMENTS, "error": 0.005},
        "path": {"force": [float(load) for load in loads]},
    }).isel(realization=0)  # fmt: skip
    depth = (9.0 * loads**2 / (16.0 * length * modulus**2)) ** (1.0 / 3.0)
    np.testing.assert_allclose(-found["reference_separation"], depth, rtol=0.005)
    off = np.abs(found["reference_contact_area"] / (np.pi * length * depth) - 1.0)
    # A lone disc in the middle of a grid has edges that are off all alike: more than the mean of many is.
    assert (off <= 1.5 * found["reference_area_error"]).all()


@pytest.mark.large
def test_loads_that_pull_the_flat_off_have_no_reference() -> None:
    found = rm.run(of_spectrum(path={"pressure": ["10 kPa", "0 Pa", "-1 kPa"]}, batch={"realizations": 1}))
    force = found["reference_force"][0].to_numpy()
    assert force[0] > 0.0
    assert force[1] == 0.0
    assert np.isnan(force[2])
    np.testing.assert_allclose(force[0], 1e4 * float(found["nominal_area"]), rtol=5e-3)
