"""A few asperities with weights in place of the expected law: each summed by rm.indent, along the path."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exports import header_of, of_csv, of_json
from forms import large
from numpy.typing import NDArray
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.aggregate import LoadingPath
from roughmdr.expected.few_asperities import FewAsperities, few_asperities
from roughmdr.expected.height_rules import RULES, points_of, rule_of
from roughmdr.expected.heights import HeightTable
from roughmdr.scene import read

Floats = NDArray[np.float64]
AREA = 1e-6  # area of the patch [m2]
DOWN = np.linspace(4e-6, -0.5e-6, 30)
THERE_AND_BACK = np.concatenate([DOWN, DOWN[::-1]])
DUGDALE = {"model": "dugdale", "work": "50 mJ/m^2", "strength": "0.3 MPa"}
UNIFORM = {**ASPERITIES, "height": {"distribution": "uniform", "loc": 0.0, "scale": "3 um"}, "radius": "40 um"}
CONES = {**{key: value for key, value in ASPERITIES.items() if key != "radius"}, "shape": "cone", "slope": 0.2}


def found_of(error: float, separation: Floats = DOWN, **changes: Any) -> FewAsperities:
    made = read(scene(**changes))
    path = LoadingPath.along(separation, unload=False, adhesive=made.work > 0.0)
    return few_asperities(
        made.asperities,
        path,
        effective_modulus=made.effective_modulus,
        adhesion=made.adhesion_model,
        error=error,
    )


def summed(table: Any, shape: str, separation: Floats, **material: Any) -> tuple[Floats, Floats]:
    """Force and area per nominal area along a path, a node at a time: on as the flat comes, off past its detachment."""
    shapes = {"paraboloid": rm.Paraboloid, "cone": rm.Cone}
    force, area = np.zeros(separation.size), np.zeros(separation.size)
    for row in table.to_dict("records"):
        height, weight, *parameters = row.values()
        one = shapes[shape](*parameters)
        delta = height - separation
        back = rm.indent(one, indentation=delta, **material)
        if material.get("work", 0.0) == 0.0:
            force, area = force + weight * back.force.to_numpy(), area + weight * back.contact_area.to_numpy()
            continue
        onset = -material["work"] / material["strength"] if "strength" in material else 0.0
        detachment = float(rm.pull_off(one, control="displacement", **material).indentation)
        on, held = np.zeros(separation.size, dtype=bool), False
        for step, at in enumerate(delta):
            held = at >= onset or (held and at > detachment)
            on[step] = held
        force = force + np.where(on, weight * back.force.to_numpy(), 0.0)
        area = area + np.where(on, weight * back.contact_area.to_numpy(), 0.0)
    return force, area


@pytest.mark.large
@pytest.mark.parametrize(
    ("changes", "material", "error"),
    [
        ({"adhesion": None}, {}, 1e-2),
        ({"adhesion": None}, {}, 1e-3),
        ({"adhesion": None, "asperities": UNIFORM}, {}, 1e-3),
        ({"adhesion": None, "asperities": CONES}, {}, 1e-3),
        ({}, {"work": 0.05}, 1e-2),
        large({"adhesion": DUGDALE}, {"work": 0.05, "strength": 3e5, "adhesion": "dugdale"}, 2e-2),
    ],
    ids=["hertz", "hertz finer", "uniform", "cones", "jkr", "dugdale"],
)
def test_the_sum_over_the_nodes_is_the_expected_law(
    changes: dict[str, Any], material: dict[str, Any], error: float, tmp_path: Path
) -> None:
    """The result is read from its file, at the steps of its path and between them, loading and unloading."""
    separation = THERE_AND_BACK
    path = {"separation": separation.tolist()}
    made = scene(**{"path": path, "batch": {"estimator": "expected"}} | changes)
    rm.run(made, tmp_path / "law.nc")
    rm.export(tmp_path / "law.nc", tmp_path / "nodes.csv", to="csv", quantity="nodes", error=error)
    table = of_csv(tmp_path / "nodes.csv")
    between = np.sort(np.concatenate([DOWN, 0.5 * (DOWN[1:] + DOWN[:-1]), 0.3 * DOWN[1:] + 0.7 * DOWN[:-1]]))[::-1]
    finer = np.concatenate([between, between[::-1]])
    law = rm.run({**made, "path": {"separation": finer.tolist()}}).isel(realization=0)
    modulus = rm.effective_modulus(3e6, 0.49)
    shape = made["asperities"]["shape"]
    force, area = summed(table, shape, finer, effective_modulus=modulus, **material)
    off = [
        np.abs(found - exact / AREA).max() / (exact.max() / AREA)
        for found, exact in ((force, law.force.to_numpy()), (area, law.contact_area.to_numpy()))
    ]
    assert off[0] <= 1.05 * error
    assert off[1] <= 1.05 * error
    for part in ("force within", f"shape: {shape}", "effective modulus: ", "sum of weight P"):
        assert part in header_of(tmp_path / "nodes.csv")


@pytest.mark.large
@pytest.mark.parametrize(
    ("changes", "order"), [({"adhesion": None}, 1.5), ({}, 0.8)], ids=["begins without a jump", "jumps"]
)
def test_the_error_falls_as_the_nodes_grow(changes: dict[str, Any], order: float) -> None:
    found = [found_of(error, THERE_AND_BACK, **changes) for error in (4e-2, 1e-2, 2.5e-3)]
    sizes = np.array([each.height.size for each in found])
    errors = np.array([max(each.errors[:2]) for each in found])
    assert (errors <= [4e-2, 1e-2, 2.5e-3]).all()
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope <= -order, (sizes, errors)
    assert sizes[-1] < 60 * (1 if order > 1.0 else 5)


def test_the_weights_are_of_all_asperities_that_the_flat_reaches() -> None:
    found = found_of(1e-3, np.linspace(5e-6, -4.9e-6, 40), adhesion=None, asperities=UNIFORM)
    assert found.weight.sum() == pytest.approx(1000.0, rel=1e-9)
    assert (found.weight > 0.0).all()
    assert found.height.min() > 0.0
    assert found.height.max() < 3e-6


@pytest.mark.parametrize("name", RULES)
@pytest.mark.parametrize("count", [1, 4, 25])
def test_a_rule_keeps_the_number_and_the_mean_height(name: str, count: int) -> None:
    from roughmdr.ensemble.nodes import Rule

    heights = HeightTable.of(read(scene()).asperities.nodes(Rule.smooth(1)).heights[0])
    points = points_of(heights, -10e-6, count, name)
    y, weights = rule_of(points, count, name, 0.0)
    assert y.size == count
    assert (np.diff(y) > 0.0).all()
    assert weights.sum() == pytest.approx(1.0, rel=1e-10)
    assert abs((weights * y).sum()) < 1e-15
    if name == "equal_fractions":
        np.testing.assert_allclose(weights, 1.0 / count, rtol=0.05)


@pytest.mark.parametrize("name", RULES)
def test_the_highest_summits_are_kept_however_few(name: str) -> None:
    """Above 8 sigma there are 6e-16 of all normal heights."""
    from scipy.stats import norm

    from roughmdr.ensemble.nodes import Rule

    heights = HeightTable.of(read(scene()).asperities.nodes(Rule.smooth(1)).heights[0])
    y, fractions = points_of(heights, 8e-6 - heights.origin, 4, name)
    mean = norm.pdf(8.0) / norm.sf(8.0)
    assert fractions.sum() == pytest.approx(norm.sf(8.0), rel=1e-3)
    assert float((fractions * (y + heights.origin)).sum() / fractions.sum()) == pytest.approx(1e-6 * mean, rel=1e-5)


@pytest.mark.parametrize("size", [1e-9, 1.0])
def test_in_other_units_they_are_the_same_nodes(size: float) -> None:
    asperities = {
        **ASPERITIES,
        "patch": 1000.0 * size,
        "height": {"distribution": "normal", "std": size},
        "radius": 50.0 * size,
    }
    micro = {**ASPERITIES, "radius": "50 um"}
    scaled = found_of(1e-2, DOWN / 1e-6 * size, adhesion=None, asperities=asperities)
    found = found_of(1e-2, DOWN, adhesion=None, asperities=micro)
    np.testing.assert_allclose(scaled.height / size, found.height / 1e-6, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(scaled.weight, found.weight, rtol=1e-9)


def test_json_holds_the_same_nodes_and_units_convert(tmp_path: Path) -> None:
    rm.run(scene(adhesion=None, path={"separation": DOWN.tolist()}, batch={"realizations": 2}), tmp_path / "law.nc")
    asked = {"quantity": "nodes", "error": 1e-2}
    rm.export(tmp_path / "law.nc", tmp_path / "n.csv", to="csv", **asked)
    rm.export(tmp_path / "law.nc", tmp_path / "n.json", to="json", units="um,uN,MPa", **asked)
    table, document = of_csv(tmp_path / "n.csv"), of_json(tmp_path / "n.json")
    assert document["units"] == {"height": "um", "weight": "1/um^2", "radius": "um"}
    for name, factor in (("height [m]", 1e6), ("weight [1/m^2]", 1e-12), ("radius [m]", 1e6)):
        np.testing.assert_allclose(document["columns"][name.split()[0]], table[name] * factor, rtol=1e-12)


@pytest.mark.parametrize(
    ("section", "says"),
    [
        ('[interaction]\nmodel = "pairwise"', "positions, which the expected law does not know"),
        ('[interaction]\nmodel = "mean_field"', r"scene has \[interaction\]"),
    ],
)
def test_asperities_that_feel_each_other_have_no_nodes(section: str, says: str, tmp_path: Path) -> None:
    made = rm.run(scene(adhesion=None, path={"separation": ["1 um", "0 um"]}, batch={"estimator": "expected"}))
    scene_without_batch = made.attrs["scene"].replace('[batch]\nestimator = "expected"\n', "")
    made.attrs["scene"] = f"{scene_without_batch}\n{section}\n"
    with pytest.raises(rm.StoreError, match=says):
        rm.export(made, tmp_path / "n.csv", to="csv", quantity="nodes")


def test_what_has_no_nodes_is_refused(tmp_path: Path) -> None:
    few, path = {**ASPERITIES, "count": 20}, {"separation": ["1 um", "0 um"]}
    made = rm.run(scene(asperities=few, path=path, adhesion=None, batch=None))
    with pytest.raises(rm.StoreError, match="abaqus has no table of quantity 'nodes'; csv, json have"):
        rm.export(made, tmp_path / "n.inp", to="abaqus", quantity="nodes")
    rm.generate(few, seed=1).to_netcdf(tmp_path / "e.nc")
    read_in = {"source": "file", "file": str(tmp_path / "e.nc")}
    made = rm.run(scene(asperities=read_in, path=path, adhesion=None, batch=None))
    with pytest.raises(rm.StoreError, match="nothing of source 'file' is drawn"):
        rm.export(made, tmp_path / "n.csv", to="csv", quantity="nodes")
