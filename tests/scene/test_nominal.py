"""[nominal]: its shapes, what it does not go with, and a run, a sweep and a plan of it."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.costs import touching
from roughmdr.batch.foresee import foresee_cells
from roughmdr.batch.plan import make_plan
from roughmdr.scene import read
from roughmdr.shapes import Cone, Paraboloid, PowerLaw

EXPECTED = {"estimator": "expected"}
PATH = {"separation": {"start": "3 sigma", "stop": "0 sigma", "steps": 5}, "unload": True}
PAIRS = {"model": "pairwise", "boundary": "free"}
DRAWN: dict[str, Any] = {"interaction": PAIRS, "batch": {"realizations": 2}}
LAYER = {**ASPERITIES, "radius": "50 um"}


def curved(**changes: Any) -> dict[str, Any]:
    return scene(
        **{"nominal": {"radius": "10 mm"}, "batch": EXPECTED, "path": PATH, "adhesion": None, "asperities": LAYER}
        | changes
    )


@pytest.mark.parametrize(
    ("section", "body"),
    [
        ({"radius": "10 mm"}, Paraboloid(radius=0.01)),
        ({"shape": "cone", "slope": 0.1}, Cone(slope=0.1)),
        (
            {"shape": "power_law", "exponent": 4, "width": "1 mm", "rise": "1 um"},
            PowerLaw(exponent=4.0, width=1e-3, rise=1e-6),
        ),
    ],
)
def test_a_body_is_a_shape_with_its_parameters(section: dict[str, Any], body: object) -> None:
    nominal = read(curved(nominal=section)).nominal
    assert nominal is not None
    assert nominal.body == body


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"nominal": {}}, "nominal.shape.*it takes radius"),
        ({"nominal": {"radius": "-1 mm"}}, "nominal.radius.*above 0"),
        ({"nominal": {"radius": "1 mm", "slope": 0.1}}, "nominal.slope.*no parameter of the paraboloid"),
        ({"nominal": {"radius": "1 mm", "error": 0.5}}, "nominal.error.*at most 0.01"),
        ({"nominal": {"shape": "tabulated"}}, "nominal.shape"),
        ({"batch": {"realizations": 4}}, 'batch.estimator: must be "expected"'),
        ({"batch": None, "accuracy": {"relative": 0.01, "method": "sampled"}}, 'accuracy.method: must be "expected"'),
        (
            {"interaction": {"model": "mean_field"}},
            "interaction.model: is 'mean_field'; with .nominal. it must be",
        ),
        ({"interaction": {"model": "pairwise"}}, "interaction.boundary: is 'periodic'; .* must be 'free'"),
        ({**DRAWN, "nominal": {"radius": "1 mm", "error": 1e-3}}, "nominal.error: is that of the expected law"),
        ({"interaction": PAIRS}, "batch.estimator: cannot be 'expected'"),
        ({**DRAWN, "path": {"force": {"stop": "1 mN", "steps": 5}}}, "goes with path.separation, not with path.force"),
        (
            {**DRAWN, "path": {"separation": {"start": "clear", "stop": {"pressure": "1 kPa"}, "steps": 5}}},
            "path.separation.stop.pressure: does not go",
        ),
        ({**DRAWN, "output": {"variables": ["energy"]}}, "'energy' is not available with .nominal.; there are force"),
        ({**DRAWN, "output": {"variables": ["contact_fraction"]}}, "'contact_fraction' is not available"),
        ({**DRAWN, "reference": {"model": "boundary_elements"}}, "does not go with .reference."),
        ({**DRAWN, "adhesion": {"model": "auto", "work": 0.05, "strength": "1 MPa"}}, "goes with adhesion 'jkr' only"),
        ({"path": {"force": {"stop": "1 mN", "steps": 5}}}, "goes with path.separation, not with path.force"),
        (
            {"path": {"separation": {"start": "clear", "stop": {"contact_fraction": 0.01}, "steps": 5}}},
            "path.separation.stop.contact_fraction: does not go",
        ),
        ({"output": {"variables": ["force", "pressure"]}}, "'pressure' is not available with .nominal."),
        ({"adhesion": {"model": "dugdale", "work": 0.05, "strength": "1 MPa"}}, "rings remember contacts of model"),
        (
            {
                "adhesion": {"model": "jkr", "work": 0.05},
                "asperities": {**LAYER, "shape": "truncated_paraboloid", "flat_radius": "1 um"},
            },
            "several stable branches",
        ),
        ({"asperities": {**LAYER, "height": "1 um"}}, "all heights are the same"),
    ],
)
def test_what_does_not_go_with_it_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(rm.SceneError, match=message):
        read(curved(**changes))


def test_a_run_holds_the_law_of_the_body(tmp_path: Path) -> None:
    variables = ["force", "stiffness", "contact_area", "contact_count", "contact_radius_sum", "model_error_curve"]
    table = curved(output={"variables": variables})
    result = rm.run(table, tmp_path / "out.nc", workers=1)
    assert result.status.item() == 0
    assert 0.0 < result.numerical_error.item() < 1e-4
    for name in (*variables, "nominal_contact_radius"):
        assert np.isfinite(result[name]).all(), name
    assert (np.diff(result.force[0, :5]) > 0.0).all()
    np.testing.assert_array_equal(result.force[0, 5:], result.force[0, 4::-1])  # no memory
    assert "nominal_area" not in result
    assert result.attrs["nominal"] == "paraboloid"
    assert result.pull_off_force.item() == 0.0 or np.isnan(result.pull_off_force.item())
    again = xr.open_dataset(tmp_path / "out.nc")
    np.testing.assert_array_equal(again.force, result.force)


def test_accuracy_takes_the_expected_law() -> None:
    result = rm.run(curved(batch=None, accuracy={"relative": 1e-3}))
    assert result.accuracy_method.item() == 2


def test_a_clear_start_is_clear_of_the_half_space_too() -> None:
    body = {"shape": "paraboloid", "radius": "10 mm"}
    path = {"separation": {"start": "clear", "stop": "0 sigma", "steps": 5}}
    adhesion = {"model": "jkr", "work": "50 mJ/m^2"}
    here, flat = (
        make_plan(read(curved(nominal=nominal, path=path, adhesion=adhesion))).cells[0].path.separation[0]
        for nominal in (body, None)
    )
    drawn_up = rm.pull_off(
        Paraboloid(radius=0.01), effective_modulus=3e6 / (1 - 0.49**2), work=0.05, control="displacement"
    )
    assert here - flat == pytest.approx(-drawn_up.indentation.item(), rel=1e-6)


def test_a_scene_without_it_says_so() -> None:
    assert "curvature of the bodies: the scene has no [nominal]" in make_plan(read(scene())).left_out
    assert not any("curvature" in line for line in make_plan(read(curved())).left_out)


def test_its_paper_is_cited() -> None:
    assert "rough spheres" in rm.cite(read(curved()))
    assert "rough spheres" not in rm.cite(read(scene()))


@pytest.mark.large
def test_laws_of_a_flat_are_not_taken_for_that_of_a_body(tmp_path: Path) -> None:
    result = rm.run(curved())
    with pytest.raises(rm.StoreError, match=r"this scene has .nominal."):
        result.roughmdr.normalise("gw")
    with pytest.warns(UserWarning, match="for elastic bodies under a flat; the scene is of a curved body"):
        rm.plot(result, tmp_path / "law.png", with_theory=True, variables="force")


def test_a_steep_body_and_one_on_few_asperities_are_warned_of() -> None:
    with pytest.warns(rm.LimitWarning) as warned:
        rm.run(curved(nominal={"radius": "0.1 mm"}))
    texts = " ".join(str(each.message) for each in warned)
    assert "asperities in contact on average" in texts
    steep = rm.run(curved(nominal={"shape": "cone", "slope": 0.5, "error": 1e-2}))
    gentle = rm.run(curved(nominal={"shape": "cone", "slope": 1e-3, "error": 1e-2}))
    assert float(steep.edge_slope.max()) >= 0.5 > float(gentle.edge_slope.max())


@pytest.mark.large
def test_a_fit_finds_the_radius_of_the_asperities() -> None:
    made = rm.run(curved(nominal={"radius": "10 mm", "error": 1e-3}))
    loading = made.isel(realization=0).where(made.branch == "loading", drop=True)
    measured = pd.DataFrame({"separation": loading.separation.to_numpy(), "force": loading.force.to_numpy()})
    start = curved(nominal={"radius": "10 mm", "error": 1e-3}, asperities={**LAYER, "radius": "40 um"})
    fit = rm.fit(measured, start, "asperities.radius")
    assert float(fit.asperities_radius) == pytest.approx(50e-6, rel=1e-3)


def test_a_result_without_an_area_is_no_table(tmp_path: Path) -> None:
    with pytest.raises(rm.StoreError, match=r"per nominal area, and the result has none under"):
        rm.export(rm.run(curved()), tmp_path / "layer.csv", to="csv")


def test_asperities_that_feel_each_other_are_drawn(tmp_path: Path) -> None:
    rough = {**LAYER, "height": {"distribution": "normal", "std": "3 um"}}
    variables = ["force", "contact_area", "model_error_curve"]
    table = curved(**DRAWN, asperities=rough, output={"variables": variables}, title="Drawn under a ball")
    plan = make_plan(read(table))
    assert plan.variables == [*variables, "nominal_contact_radius"]
    assert not any(line.startswith(("curvature", "interaction", "positions", "random draws")) for line in plan.left_out)
    result = rm.run(table, tmp_path / "drawn.nc", workers=1)
    assert (result.status == 0).all()
    assert (np.diff(result.force[:, :5]) >= 0.0).all()
    assert (result.nominal_contact_radius[:, 4] > 0.0).all()
    assert "nominal_area" not in result
    assert (result.largest_contact_fraction > 2.0 * result.contact_area.max("step") / 1e-6).all()
    told = rm.info(tmp_path / "drawn.nc")
    assert "of the area that contacts crowd on" in told
    assert "coupled in pairs: force at closest approach within" in told
    assert "independent" not in told.split("left out")[0]
    assert "rubber with model randomly rough surfaces" in rm.cite(result)
    assert "rough spheres" not in rm.cite(result)
    rm.plot(result, tmp_path / "map.png", kind="map")
    with pytest.raises(rm.StoreError, match="per nominal area, and the result has none under"):
        rm.export(result, tmp_path / "drawn.csv", to="csv")
    measured = pd.DataFrame({"separation": [3e-6, 2e-6, 1e-6, 0.0], "force": [0.0, 1e-4, 2e-4, 4e-4]})
    with pytest.raises(rm.SceneError, match="cannot be fitted, for it has no expected law"):
        rm.fit(measured, table, "nominal.radius")


def test_contacts_at_the_border_of_the_patch_are_warned_of() -> None:
    path = {"separation": [0.0, "-2 um"]}
    with pytest.warns(rm.LimitWarning, match="contacts reach the border of the patch under the curved body"):
        rm.run(curved(**DRAWN, nominal={"radius": "1 m"}, path=path))
    remarks = rm.run(curved(**DRAWN, nominal={"radius": "5 mm"}, path=path)).attrs.get("warnings", "")
    assert "border" not in remarks


def test_the_plan_foresees_those_that_the_body_touches_first() -> None:
    scene = read(curved(**DRAWN, nominal={"radius": "5 mm"}))
    (foreseen,) = foresee_cells(make_plan(scene)).foreseen
    (made,) = rm.run(curved(interaction=PAIRS, batch={"estimator": "stratified"}, nominal={"radius": "5 mm"})).force
    assert foreseen.law.variables["force"].max() == pytest.approx(float(made.max()), rel=0.05)
    assert touching(make_plan(scene).cells[0]) < 0.2 * 1000
    assert np.isnan(foreseen.fraction_at_pull_off)
