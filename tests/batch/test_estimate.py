"""The forecast of a plan: the work that it takes, counted, and whether it comes near the run."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from scenes import ASPERITIES, scene
from test_cli import roughmdr

from roughmdr.batch.calibrate import measure
from roughmdr.batch.costs import along_seconds, locates_jumps, seconds
from roughmdr.batch.estimate import estimate
from roughmdr.batch.plan import make_plan
from roughmdr.scene import read

LARGE = {**ASPERITIES, "count": 3_000_000, "patch": "60 mm"}
LONG = {"separation": {"start": "3 sigma", "stop": "-1 sigma", "steps": 20_000}, "unload": True}
FINITE_RANGE = {"model": "dugdale", "work": "50 mJ/m^2", "strength": "5 MPa"}
FIRST_PART, LARGEST_PART = 20 * 8, 10_000 * 500


def work(budget: float, **changes: Any) -> int:
    """Asperities times steps of the parts that are run to foresee a scene."""
    return estimate(make_plan(read(scene(**changes))), 2, budget).asperity_steps


@pytest.mark.parametrize("adhesion", [None, FINITE_RANGE])
def test_without_time_one_small_part_of_one_cell_is_run(adhesion: dict[str, Any] | None) -> None:
    sweep = {"asperities.patch": ["1 mm", "2 mm", "3 mm"]}
    assert work(0.0, asperities=LARGE, path=LONG, adhesion=adhesion, sweep=sweep) == FIRST_PART


def test_a_scene_is_never_run_beyond_its_own_size() -> None:
    small = {**ASPERITIES, "count": 30}
    assert work(1.0, asperities=small, path={"separation": ["2 um", "1 um", "0 um"]}) == 90


@pytest.mark.large
def test_of_asperities_with_a_table_each_some_are_run(tmp_path: Path) -> None:
    """They are a part of the whole, tables and all: a plan is not refused where a run is not."""
    radius = np.linspace(1e-7, 2e-5, 20)
    height = 1e-6 * np.random.default_rng(1).normal(size=400)
    ensemble = {
        "height": ("asperity", height, {"units": "m"}),
        "a": (("asperity", "point"), np.tile(radius, (400, 1)), {"units": "m"}),
        "g": (("asperity", "point"), np.linspace(1.0, 2.0, 400)[:, None] * radius**2 / 5e-5, {"units": "m"}),
    }
    attrs = {"shape": "mdr_table", "patch": 1e-3}
    xr.Dataset(ensemble, attrs=attrs).to_netcdf(tmp_path / "hills.nc")
    saved = {"source": "file", "file": str(tmp_path / "hills.nc")}
    path = {"separation": {"start": "3 um", "stop": "0 um", "steps": 60}}
    assert work(0.0, asperities=saved, path=path, batch=None) == FIRST_PART


def test_with_time_the_parts_are_bounded_whatever_the_scene(tmp_path: Any) -> None:
    work(0.0, asperities=LARGE, path=LONG)  # compiled
    assert work(60.0, asperities=LARGE, path=LONG) == LARGEST_PART
    sweep = {"asperities.patch": {"linspace": ["1 mm", "2 mm"], "num": 30}}
    assert work(60.0, path={"separation": ["2 um", "0 um"]}, sweep=sweep) == 12 * 1000 * 2


def test_what_a_state_costs_bounds_the_number_of_states() -> None:
    """At 8e-8 s a state, as ``costs`` has it, a run of the largest part takes 0.4 s."""
    cell = make_plan(read(scene(asperities=LARGE, path=LONG, adhesion=FINITE_RANGE))).cells[0]
    estimate(make_plan(read(scene(adhesion=FINITE_RANGE))), 1, 0.0)  # compiled
    cost = measure(cell, "sampled", ["force"], 0.2)
    assert cost.asperities * cost.steps < LARGEST_PART
    assert 0.1 < cost.seconds / seconds(cell, "sampled") < 10.0


@pytest.mark.few(1)
@pytest.mark.parametrize(("adhesion", "times"), [(None, 17.0), ({"model": "jkr", "work": "1 mJ/m^2"}, 3.6)])
def test_separations_that_are_sought_take_longer(adhesion: dict[str, Any] | None, times: float) -> None:
    """Pairs that no time is left to run, so that constants tell: in as many steps to the same pressure."""
    asperities = {**ASPERITIES, "count": 200, "placement": "random"}

    def foreseen(path: dict[str, Any]) -> float:
        made = read(scene(adhesion=adhesion, asperities=asperities, interaction={"model": "pairwise"}, path=path))
        return measure(make_plan(made).cells[0], "sampled", ["force"], 0.0).seconds

    given = foreseen({"separation": {"stop": {"pressure": "10 Pa"}, "steps": 30}})
    assert foreseen({"pressure": {"stop": "10 Pa", "steps": 30}}) == pytest.approx(times * given, rel=1e-9)


def test_jumps_that_are_located_take_longer() -> None:
    """The more contacts there are, where a spring and not the flat itself lets them jump, on each way."""
    jkr, lost = {"model": "jkr", "work": "50 mJ/m^2"}, ["force", "dissipated_energy"]

    def foreseen(stop: str, *, unload: bool = True, variables: list[str] = lost, **spring: str) -> float:
        path = {"remote" if spring else "separation": {"start": "clear", "stop": stop, "steps": 9}, "unload": unload}
        made = read(scene(adhesion=jkr, path={**path, **spring}, output={"variables": variables}))
        (cell,) = make_plan(made).cells
        located = locates_jumps(cell, "sampled")
        assert (seconds(cell, "sampled") > 3.0 * along_seconds(cell, "sampled")) == located
        return seconds(cell, "sampled") if located else 0.0

    spring = {"machine_stiffness": "1 kN/m"}
    few, many = foreseen("1 um", **spring), foreseen("-5 um", **spring)
    assert 0.0 < few < 0.3 * many  # 160 and 1000 contacts: each is summed over while the others are lost
    assert 0.4 * many < foreseen("-5 um", unload=False, **spring) < 0.6 * many
    assert foreseen("-5 um") == 0.0
    assert foreseen("-5 um", variables=["force"], **spring) == 0.0


def test_what_is_loaded_at_its_first_use_is_not_taken_for_the_cost(tmp_path: Path) -> None:
    """In a process of its own: stratified summits of a Gaussian surface, in pairs."""
    asperities = {"source": "nayak", "patch": "1 mm", "m0": "4.5 um^2", "m2": 0.0144, "m4": 3.93e9}
    path = {"separation": {"start": "10 um", "stop": "5 um", "steps": 140}}
    changes = {"batch": None, "accuracy": {"relative": 1e-2}, "interaction": {"model": "pairwise"}}
    (tmp_path / "scene.toml").write_text(
        tomli_w.dumps(scene(adhesion=None, asperities=asperities, path=path, **changes))
    )
    done = roughmdr("plan", "scene.toml", "--workers", 2, "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    memory = json.loads(done.stdout)["plan"]["memory"]
    assert memory["total"] - memory["resident"] < 1e9  # 0.13 GB in two workers


def test_an_expected_law_that_takes_too_long_is_not_run() -> None:
    asperities = {**ASPERITIES, "shape": "rounded_cone", "slope": ASPERITIES["radius"] | {"mean": 0.1, "std": 0.01}}
    asperities["blend_radius"] = asperities.pop("radius")
    batch = {"estimator": "expected", "realizations": 1}
    cell = make_plan(read(scene(asperities=asperities, batch=batch, path=LONG))).cells[0]
    cost = measure(cell, "expected", ["force"], 1.0)
    assert (cost.steps, cost.seconds) == (0, seconds(cell, "expected"))


def test_steps_that_were_not_run_are_foreseen_from_those_that_were() -> None:
    batch = {"estimator": "expected", "realizations": 1}
    asperities = {**ASPERITIES, "radius": "50 um"}
    plan = make_plan(read(scene(asperities=asperities, batch=batch, path=LONG)))
    estimate(plan, 1, 0.0)  # compiled
    cell = plan.cells[0]
    few, many = (measure(cell, "expected", ["force"], budget) for budget in (0.0, 30.0))
    assert (few.steps, many.steps) == (0, 500)
    assert 0.1 < few.seconds / many.seconds < 10.0
