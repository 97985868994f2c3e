"""Sweeps: each cell is the single run of its scene, to the last bit, and xarray finds it by its values."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from hypothesis import given, settings, strategies as st
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.scene import read
from roughmdr.scene.keys import set_key

SMALL: dict[str, Any] = {**ASPERITIES, "count": 60}
SHORT = {"separation": {"start": "3 sigma", "stop": "-0.5 sigma", "steps": 12}, "unload": True}
EVERY = ["force", "contact_area", "stiffness", "energy", "dissipated_energy", "pressure"]


def swept(axes: dict[str, Any], mode: str = "product", **changes: Any) -> dict[str, Any]:
    base = {"asperities": SMALL, "path": SHORT, "batch": {"realizations": 3}, "output": {"variables": EVERY}}
    return scene(**{**base, **changes, "sweep": {"mode": mode, **axes}})


def single(table: dict[str, Any], values: dict[str, Any]) -> xr.Dataset:
    """The run of one cell's scene by itself."""
    alone = {key: value for key, value in scene(**table).items() if key != "sweep"}
    for key, value in values.items():
        set_key(alone, key, value)
    return rm.run(alone)


def assert_cell(cell: xr.Dataset, alone: xr.Dataset) -> None:
    for name in (*EVERY, "numerical_error", "separation"):
        np.testing.assert_array_equal(cell[name], alone[name], err_msg=name)
    assert cell.branch.to_numpy().tolist() == alone.branch.to_numpy().tolist()


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("key", "values", "unit"),
    [
        ("material.poisson", [0.2, 0.49], "1"),
        ("adhesion.work", [0, "50 mJ/m^2"], "J m-2"),
        ("asperities.radius", ["50 um", "70 um"], "m"),
        ("asperities.height.distribution", ["normal", "uniform"], None),
        ("path.separation.start", ["2 um", "3 um"], "m"),
        ("path.separation.stop", ["-0.5 sigma", "0 sigma"], "1"),
    ],
)
def test_a_swept_key_is_a_coordinate_in_its_unit(key: str, values: list[Any], unit: str | None) -> None:
    result, name = rm.run(swept({key: values})), key.replace(".", "_")
    assert result.sizes[name] == 2
    assert result[name].attrs.get("units") == unit
    assert "path" in key or result.separation.dims == ("step",)


@pytest.mark.large
def test_zip_is_one_dimension_with_the_swept_keys_beside_it(tmp_path: Path) -> None:
    axes = {"adhesion.work": [0.05, 0.01, 0.05], "asperities.count": [10, 60, 30]}
    table = swept(axes, "zip", asperities={**SMALL, "shape": "sphere"})
    result = rm.run(table, tmp_path / "out.nc")
    assert result.force.dims == ("cell", "realization", "step")
    for name, unit in (("adhesion_work", "J m-2"), ("asperities_count", "1")):
        assert result[name].dims == ("cell",)
        assert result[name].attrs["units"] == unit
    for i in range(3):
        assert_cell(result.isel(cell=i), single(table, {key: values[i] for key, values in axes.items()}))
    with xr.open_dataset(tmp_path / "out.nc") as ds:
        assert ds.asperities_count.to_numpy().tolist() == [10, 60, 30]


def test_an_entry_of_a_list_is_swept_by_its_number() -> None:
    terms = [{"share": 0.5, "time": "10 ms"}, {"share": 0.2, "time": "1 s"}]
    law = {"viscoelastic": {"relaxation": terms, "speed": "1 um/s"}, "path": {"separation": ["1 sigma", "0 sigma"]}}
    law |= {"batch": {"estimator": "expected"}, "output": {"variables": ["force"]}}
    table = scene(adhesion=None, **law)
    key, times = "viscoelastic.relaxation[1].time", ["1 ms", "2 ms"]
    swept = rm.run(table | {"sweep": {key: times}})
    assert swept.viscoelastic_relaxation_1_time.to_numpy().tolist() == [1e-3, 2e-3]
    for number, time in enumerate(times):
        same = rm.run(table, set={key: time})
        assert np.array_equal(same.force, swept.force.isel(viscoelastic_relaxation_1_time=number))
    assert not np.array_equal(*swept.force)
    for key, told in (
        ("viscoelastic.relaxation[2].time", "the scene has no viscoelastic.relaxation[2]"),
        ("viscoelastic.relaxation[0].tim", "viscoelastic.relaxation[0].tim: unknown key; did you mean 'time'?"),
    ):
        with pytest.raises(rm.SceneError, match=re.escape(told)):
            rm.run(table, set={key: "1 ms"})
    with pytest.raises(rm.SceneError, match=re.escape("viscoelastic.relaxation[2].time")):
        rm.run(table | {"sweep": {"viscoelastic.relaxation[2].time": times}})


def test_cells_share_their_draws() -> None:
    """Twice the standard deviation is twice each height: cells differ by the parameter, not by chance."""
    table = swept({"asperities.height.std": ["1 um", "2 um"]}, adhesion=None, output={"variables": ["contact_count"]})
    result = rm.run(table)
    np.testing.assert_array_equal(result.contact_count[0], result.contact_count[1])


def test_a_product_stands_in_order_and_a_falling_one_falls() -> None:
    values = {"adhesion.work": [0.05, 0.01, 0.02], "asperities.patch": ["2 mm", "1 mm"]}
    table = swept({**values, "asperities.height.distribution": ["uniform", "normal"]})
    result = rm.run(table)
    assert result.adhesion_work.to_numpy().tolist() == [0.01, 0.02, 0.05]
    assert result.asperities_patch.to_numpy().tolist() == [2e-3, 1e-3]
    assert result.asperities_height_distribution.to_numpy().tolist() == ["uniform", "normal"]
    asked = {"adhesion.work": 0.02, "asperities.patch": 1e-3, "asperities.height.distribution": "uniform"}
    labels = {key.replace(".", "_"): value for key, value in asked.items()}
    assert result.force.dims == (*result.run_time.dims, "step") == (*labels, "realization", "step")
    assert_cell(result.sel(labels), single(table, asked))


def test_both_spellings_of_a_swept_key_and_a_key_that_the_scene_leaves_out() -> None:
    table = swept({"adhesion": {"work": [0.01, 0.05]}, "counter.modulus": ["1 GPa", "2 GPa"]})
    table["adhesion"] = {"model": "jkr"}
    table["counter"] = {"poisson": 0.3}
    asked = read(table)
    assert list(asked.sweep.sizes) == ["adhesion_work", "counter_modulus"]
    assert [cell.work for cell in asked.cells] == [0.01, 0.01, 0.05, 0.05]
    dotted = swept({"adhesion.work": [0.01, 0.05], "counter.modulus": ["1 GPa", "2 GPa"]})
    assert 'adhesion.work" = [' in read({**dotted, "counter": {"modulus": 1e9, "poisson": 0.3}}).toml


def test_a_change_makes_a_swept_key_single_or_sweeps_another() -> None:
    table = swept({"adhesion.work": [0.01, 0.05], "asperities.count": [5, 6]})
    fixed = read(table, ["adhesion.work=0.02"])
    assert [axis.key for axis in fixed.sweep.axes] == ["asperities.count"]
    assert {cell.work for cell in fixed.cells} == {0.02}
    alone = read(table, ["adhesion.work=0.02", "asperities.count=7"])
    assert alone.sweep.sizes == {}
    assert alone.cells == (alone,)
    more = read(table, ['sweep.asperities.patch=["1 mm","2 mm","3 mm"]', 'sweep."adhesion.work"=[0.03]'])
    assert more.sweep.sizes == {"adhesion_work": 1, "asperities_count": 2, "asperities_patch": 3}
    assert read(more).toml == more.toml


def test_maps_can_be_swept(tmp_path: Path) -> None:
    x = np.linspace(0.0, 1e-5, 40)
    for name, height in (("a", 1.0), ("b", 2.0)):
        waves = height * 1e-7 * np.cos(2e6 * x)[:, None] * np.cos(2e6 * x)[None, :]
        xr.Dataset({"height": (("x", "y"), waves)}, coords={"x": x, "y": x}).to_netcdf(tmp_path / f"{name}.nc")
    asperities = {"source": "surface", "file": "a.nc"}
    table = swept({"asperities.file": ["a.nc", "b.nc"]}, asperities=asperities, batch=None)
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(table))
    result = rm.run(tmp_path / "scene.toml")
    assert result.asperities_file.to_numpy().tolist() == [str(tmp_path / "a.nc"), str(tmp_path / "b.nc")]
    assert result.separation.dims == ("asperities_file", "step")
    assert float(result.force.isel(asperities_file=1).max()) > float(result.force.isel(asperities_file=0).max())


@pytest.mark.large
@settings(deadline=None, max_examples=100)
@given(first=st.floats(1e-9, 1e3), last=st.floats(1e-9, 1e3), num=st.integers(2, 40), kind=st.sampled_from("lin log"))
def test_values_between_two_ends(first: float, last: float, num: int, kind: str) -> None:
    if first == last:
        return
    kind = "linspace" if kind in "lin" else "logspace"
    asked = read(swept({"adhesion.work": {kind: [first, last], "num": num}}))
    values = asked.sweep.axes[0].values
    exact = np.linspace(first, last, num) if kind == "linspace" else np.geomspace(first, last, num)
    assert (values[0], values[-1]) == (first, last)
    np.testing.assert_allclose(values, exact, rtol=1e-14)


def test_values_between_are_the_round_numbers_that_they_look_like() -> None:
    def values(entry: object, key: str = "adhesion.work") -> list[Any]:
        asked = read(swept({key: entry}))
        return list(asked.sweep.axes[0].values)

    assert values({"linspace": [0.1, 0.5], "num": 5}) == [0.1, 0.2, 0.3, 0.4, 0.5]
    assert values({"logspace": ["1 mJ/m^2", "1 J/m^2"], "num": 4}) == [1e-3, 1e-2, 0.1, 1.0]
    assert values({"linspace": [10, 30], "num": 5}, "asperities.count") == [10, 15, 20, 25, 30]
    assert values({"linspace": ["2 sigma", "4 sigma"], "num": 3}, "path.separation.start") == [2.0, 3.0, 4.0]


@pytest.mark.parametrize(
    ("axes", "says"),
    [
        ({}, "sweep: names no key to sweep"),
        ({"mode": "zap", "adhesion.work": [1]}, "sweep.mode = 'zap': not available; it can be product, zip"),
        ({"adhesion.wrok": [1]}, "sweep.adhesion.wrok: is no number .* did you mean 'adhesion.work'"),
        ({"batch.realizations": [1]}, "sweep.batch.realizations: is no number or name of the scene that can be swept"),
        ({"path.separation.steps": [1]}, "sweep.path.separation.steps: is no number"),
        ({"seed": [1]}, "sweep.seed: is no number"),
        ({"adhesion.work": 5}, "sweep.adhesion.work = 5: must be a list, "),
        ({"adhesion.work": []}, r"sweep.adhesion.work = \[\]: must be a list, "),
        ({"adhesion.work": [[1]]}, r"sweep.adhesion.work\[0\] = \[1\]: expected a number or a name"),
        ({"adhesion.work": [1, "5 m"]}, r"sweep.adhesion.work\[1\] = '5 m': 'm' is a unit of m; expected"),
        ({"adhesion.work": [1, -1]}, r"sweep.adhesion.work\[1\] = -1: must be at least 0"),
        ({"adhesion.work": ["10 mJ/m^2", 0.01]}, "holds a value twice"),
        ({"adhesion.work": {"linspace": [0, 1]}}, "sweep.adhesion.work.num: is missing"),
        ({"adhesion.work": {"linspace": [0, 1], "num": 1}}, "sweep.adhesion.work.num = 1: must be from 2"),
        ({"adhesion.work": {"linspace": [0], "num": 3}}, r"sweep.adhesion.work.linspace = \[0\]: must be two numbers"),
        ({"adhesion.work": {"linspace": ["0 m", 1], "num": 3}}, r"sweep.adhesion.work.linspace\[0\] = '0 m': 'm' is"),
        ({"adhesion.work": {"logspace": [0, 1], "num": 3}}, "sweep.adhesion.work.logspace = .*: must be above 0"),
        ({"adhesion.work": {"linspcae": [0, 1], "num": 3}}, "sweep.adhesion.work = .*: must be a list, "),
        ({"adhesion.work": {"linspace": [-1, 1], "num": 3}}, r"sweep.adhesion.work.linspace\[0\] = -1: must be at l"),
        ({"path.separation.stop": {"linspace": [-1e308, 1e308], "num": 3}}, "are too far apart"),
        ({"asperities.count": {"linspace": [10, 11], "num": 3}}, "sweep.asperities.count = .*: must give whole"),
        ({"path.separation.start": ["4 sigma", "4 um"]}, "must be all in metres or all in sigma"),
        ({"asperities.radius": ["1 um", {"distribution": "normal"}]}, r"sweep.asperities.radius\[1\]"),
        ({"asperities.radius": ["1 um"], "asperities.radius.std": ["1 um"]}, "is a part of asperities.radius"),
        ({"asperities.height.std": ["1 um", 0]}, r"sweep.asperities.height.std\[1\] = 0: must be above 0"),
        ({"asperities.radius.std": ["1 um", "1 m"], "asperities.radius.mean": [1e-200]}, "sweep.asperities.radius"),
        ({"asperities.height.distribution": ["normal", "norml"]}, "sweep.asperities.height.dist.*did you mean"),
        ({"asperities.height.distribution": ["normal", "gamma"]}, r"gamma needs a.* \(where asperities.height.distrib"),
        ({"adhesion.model": ["jkr", "jkrr"]}, "sweep.adhesion.model = 'jkrr': not available"),
        ({"asperities.count": {"linspace": [1, 1001], "num": 1001}, "adhesion.work": {"linspace": [1, 2], "num": 100}},
         "sweep: has 100100 cells; at most 100000"),
    ],
)  # fmt: skip
def test_a_wrong_sweep_is_refused(axes: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        read(swept({key: value for key, value in axes.items() if key != "mode"}, axes.get("mode", "product")))


def test_lists_of_a_zip_must_be_equally_long() -> None:
    with pytest.raises(rm.SceneError, match=r"sweep\.asperities\.count: has 1 values, adhesion.work has 2"):
        read(swept({"adhesion.work": [1, 2], "asperities.count": [3]}, "zip"))


def test_faults_stand_on_the_line_of_the_sweep(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text(
        tomli_w.dumps(scene()) + '[sweep]\n"adhesion.work" = ["5 m"]\nasperities.hieght.std = [1]\n'
    )
    lines = (tmp_path / "bad.toml").read_text().splitlines()
    with pytest.raises(rm.SceneError) as caught:
        read(tmp_path / "bad.toml")
    for fault, key in zip(caught.value.faults, ("adhesion.work", "asperities.hieght.std"), strict=True):
        line = int(fault.location.rpartition(":")[2])
        assert key in lines[line - 1]
        assert fault.key.startswith(f"sweep.{key}")


def test_cells_that_go_different_ways_are_refused() -> None:
    with pytest.raises(rm.SceneError, match="the flat loads and unloads at other steps"):
        rm.run(swept({"path.separation.stop": ["-1 sigma", "5 sigma"]}))


def test_what_is_left_out_says_in_how_many_cells() -> None:
    lines = make_plan(read(swept({"adhesion.work": [0.0, 0.01, 0.02]}))).left_out
    assert "adhesion: adhesion.work is 0 (in 1 of 3 cells)" in lines
    assert sum("interaction" in line and "cells" not in line for line in lines) == 1
