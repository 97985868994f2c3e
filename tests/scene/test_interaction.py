"""[interaction]: what it may ask for, what it goes with, and what follows for positions, plans and keys."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.costs import seconds
from roughmdr.batch.plan import make_plan
from roughmdr.interaction import Interaction
from roughmdr.scene import read
from roughmdr.variables import RUN_DIAGNOSTICS

PAIRWISE, MEAN_FIELD = {"model": "pairwise"}, {"model": "mean_field"}


def coupled(interaction: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    return scene(**{"adhesion": None, "interaction": PAIRWISE if interaction is None else interaction, **changes})


def test_defaults_and_choices() -> None:
    assert read(scene()).interaction is None
    assert read(coupled()).interaction == Interaction(model="pairwise") == Interaction.from_argument("pairwise")
    asked = {"model": "pairwise", "boundary": "free", "order": 1, "error": 1e-4}
    assert read(coupled(asked)).interaction == Interaction.from_argument(asked)
    grid = {"model": "pairwise", "beyond": "boundary_elements"}
    assert read(coupled(grid)).interaction == Interaction.from_argument(grid)
    assert read(coupled({"model": "mean_field", "boundary": "free"})).interaction == Interaction(
        model="mean_field", boundary="free"
    )
    without = coupled(adhesion={"model": "jkr", "work": 0.0})
    assert read(without).needs_positions


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"interaction": {}}, "interaction.model: is missing; for example: model = \"pairwise\""),
        ({"interaction": {"boundary": "free"}}, "interaction.model: is missing"),
        ({"interaction": {"model": "pairs"}}, "interaction.model = 'pairs'"),
        ({"interaction": {**PAIRWISE, "order": 3}}, "interaction.order = 3: must be from 1 to 2"),
        ({"interaction": {**PAIRWISE, "order": True}}, "interaction.order = True: expected a whole number"),
        ({"interaction": {**PAIRWISE, "error": 1e-10}}, "interaction.error = 1e-10"),
        ({"interaction": {**PAIRWISE, "error": "1 um"}}, "interaction.error = '1 um'"),
        ({"interaction": {**PAIRWISE, "boundary": "rigid"}}, "interaction.boundary = 'rigid'"),
        ({"interaction": {**PAIRWISE, "overlap": "merge"}}, "interaction.overlap"),
        ({"interaction": {**MEAN_FIELD, "order": 2}}, "interaction.order = 2: goes with model = \"pairwise\" only"),
        ({"interaction": {**MEAN_FIELD, "error": 1e-6}}, "interaction.error = 1e-06: goes with"),
        ({"interaction": {**MEAN_FIELD, "beyond": "flag"}}, "interaction.beyond = 'flag': goes with"),
        (
            {"interaction": {**PAIRWISE, "boundary": "free", "beyond": "boundary_elements"}},
            "interaction.beyond = 'boundary_elements': does not go with",
        ),
        (
            {"adhesion": {"model": "dugdale", "work": 0.05, "strength": 1e6}},
            "model 'pairwise' goes with adhesion 'jkr' only, not 'dugdale'",
        ),
        (
            {"adhesion": {"model": "jkr", "work": 0.05}, "interaction": MEAN_FIELD},
            "model 'mean_field' does not go with adhesion (work > 0); 'pairwise' does",
        ),
        (
            {"adhesion": {"model": "jkr", "work": 0.05}, "interaction": {**PAIRWISE, "beyond": "boundary_elements"}},
            "beyond 'boundary_elements' does not go with adhesion (work > 0); 'flag' does",
        ),
        ({"batch": {"estimator": "expected"}}, "cannot be 'expected': asperities that feel"),
        ({"batch": None, "accuracy": {"relative": 0.01, "method": "expected"}}, "cannot be 'expected': asp"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError) as caught:
        read(coupled(**changes))
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("interaction", "says"),
    [
        (3, "interaction is 3; it must be a model, or a table of model, boundary, order, error, beyond"),
        ("pairs", "interaction.model = 'pairs': not available; did you mean 'pairwise'?"),
        ({"oder": 1, "error": 1}, "interaction.oder: unknown key; did you mean 'order'?"),
        ({"oder": 1, "error": 1}, "interaction.error = 1: must be at most 0.01"),
        ({**MEAN_FIELD, "order": 1}, 'interaction.order = 1: goes with model = "pairwise" only'),
    ],
)
def test_an_argument_is_read_as_the_section(interaction: Any, says: str) -> None:
    with pytest.raises(rm.RoughmdrError) as caught:
        Interaction.from_argument(interaction)
    assert says in str(caught.value)
    asked = Interaction.from_argument({"order": np.int64(1), "error": np.float32(1e-4)})
    assert asked is not None
    assert (asked.model, asked.order) == ("pairwise", 1)


def test_a_mean_field_goes_with_the_expected_law_and_pairs_with_stratified_draws() -> None:
    assert read(coupled(MEAN_FIELD, batch={"estimator": "expected"})).reason_against("expected") == ""
    accuracy = {"accuracy": {"relative": 0.01}, "batch": None}
    assert read(coupled(MEAN_FIELD, **accuracy)).estimators == ("stratified", "expected")
    assert read(coupled(**accuracy)).estimators == ("stratified",)
    assert read(coupled(batch={"estimator": "stratified"})).needs_positions


def test_the_plan_says_what_is_left_out_and_what_a_realisation_costs() -> None:
    lines = {name: "\n".join(make_plan(read(table)).left_out) for name, table in {
        "none": scene(adhesion=None), "pairwise": coupled(), "mean_field": coupled(MEAN_FIELD)
    }.items()}  # fmt: skip
    assert "interaction: asperities are independent; the scene has no [interaction]" in lines["none"]
    assert "positions: asperities are independent; nothing depends" in lines["none"]
    assert "positions: interaction.model is 'mean_field'; nothing depends" in lines["mean_field"]
    assert "interaction: " not in lines["pairwise"] + lines["mean_field"]
    assert "positions: " not in lines["pairwise"]
    costs = [seconds(make_plan(read(table)).cells[0], "sampled") for table in (scene(adhesion=None), coupled())]
    assert costs[1] > 100.0 * costs[0]


def test_what_only_pairs_have_is_in_results_of_pairs_alone() -> None:
    for name in ("overlap_count", "marked_steps", "grid_points"):
        declared = RUN_DIAGNOSTICS[name]
        assert declared.in_result(read(coupled()))
        assert not declared.in_result(read(coupled(MEAN_FIELD)))
        assert not declared.in_result(read(scene()))
        assert name not in rm.run(scene(batch=None, path={"separation": ["1 um"]}))


def saved(path: Path, drop: tuple[str, ...]) -> Path:
    ensemble = rm.generate({**ASPERITIES, "count": 20, "placement": "random"}, seed=1)
    ensemble.attrs = {name: value for name, value in ensemble.attrs.items() if name not in drop}
    ensemble.drop_vars([name for name in drop if name in ensemble]).to_netcdf(path)
    return path


@pytest.mark.parametrize(
    ("interaction", "drop", "says"),
    [
        (PAIRWISE, ("x", "y"), "x and y [m] are missing"),
        (PAIRWISE, ("y",), "ensemble: y [m] are missing"),
        (PAIRWISE, ("patch", "nominal_area"), "patch_x and patch_y, and nominal_area are missing"),
        (MEAN_FIELD, ("patch", "nominal_area"), "patch_x and patch_y, and nominal_area are missing"),
    ],
)
def test_asperities_without_what_it_needs_are_refused(
    tmp_path: Path, interaction: dict[str, Any], drop: tuple[str, ...], says: str
) -> None:
    import xarray as xr

    file = saved(tmp_path / "ensemble.nc", drop)
    path = {"separation": ["1 um", 0.0]}
    table = coupled(interaction, asperities={"source": "file", "file": str(file)}, path=path, batch=None)
    with pytest.raises(rm.SceneError, match="missing") as of_run:
        rm.run(table)
    with xr.open_dataset(file) as ensemble, pytest.raises(rm.SceneError, match="missing") as of_call:
        rm.load_separation(ensemble, separation=[1e-6, 0.0], effective_modulus=1e9, interaction=interaction)
    assert says in str(of_run.value)
    assert says in str(of_call.value)


@pytest.mark.parametrize(
    "interaction",
    ["pairs", {"model": "pairwise", "order": 3}, {"models": "pairwise"}, 3]
    + [{"error": value} for value in (None, [1e-6], 1e-3 + 0j, np.array([1e-6, 1e-5]), math.nan, True)]
    + [{"order": np.array([1, 2])}, {"order": True}, {"beyond": np.array(["flag", "x"])}, {"model": None}],
)
def test_a_caller_is_told_what_there_is(interaction: Any) -> None:
    ensemble = rm.generate({**ASPERITIES, "count": 20, "placement": "random"}, seed=1)
    with pytest.raises(rm.SceneError, match="interaction"):
        rm.load_separation(ensemble, separation=0.0, effective_modulus=1e9, interaction=interaction)
    with pytest.raises(rm.SceneError, match="does not go with adhesion"):
        rm.load_separation(ensemble, separation=0.0, effective_modulus=1e9, work=0.05, interaction="mean_field")


def test_positions_are_drawn_for_pairs_and_change_nothing_else() -> None:
    section = read(coupled()).asperities
    plain, placed = (section.ensemble(3, 1, with_positions=with_positions) for with_positions in (False, True))
    np.testing.assert_array_equal(plain.height, placed.height)
    assert set(placed.positions) == {"x", "y"}
