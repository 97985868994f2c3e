"""The forecast of a plan: whether what takes longer is foreseen to, and whether memory comes near that of the run."""

import json
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from scenes import ASPERITIES, scene
from test_cli import roughmdr

from roughmdr.batch.costs import along_seconds, ensemble_bytes, locates_jumps, seconds
from roughmdr.batch.estimate import estimate, suits_processes
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.runner.backend import Backend
from roughmdr.scene import read


def planned(**changes: Any) -> Plan:
    return make_plan(read(scene(**changes)))


def test_a_plan_takes_what_its_runs_take_over_the_workers() -> None:
    plan = planned(batch={"realizations": 300})
    one, two = (estimate(plan, workers) for workers in (1, 2))
    assert one.seconds - one.start_up == pytest.approx(300 * seconds(plan.cells[0], "sampled"), rel=0.1)
    assert two.seconds < one.seconds
    assert one.memory - one.resident > ensemble_bytes(plan) > 0.0


def test_a_map_that_is_drawn_takes_memory_by_its_points() -> None:
    surface = {"source": "spectrum", "patch": "60 um", "hurst": 0.8, "long_wave": "30 um", "rms_slope": 0.05}
    coarse, fine = (
        ensemble_bytes(planned(asperities={**surface, "short_wave": wave}, interaction=None))
        for wave in ("10 um", "1 um")
    )
    assert fine > 30.0 * coarse


@pytest.mark.few(1)
@pytest.mark.parametrize(("adhesion", "times"), [(None, 4.0), ({"model": "jkr", "work": "1 mJ/m^2"}, 3.6)])
def test_separations_that_are_sought_take_longer(adhesion: dict[str, Any] | None, times: float) -> None:
    """Pairs in as many steps to the same pressure."""
    asperities = {**ASPERITIES, "count": 200, "placement": "random"}

    def foreseen(path: dict[str, Any]) -> float:
        made = planned(adhesion=adhesion, asperities=asperities, interaction={"model": "pairwise"}, path=path)
        return seconds(made.cells[0], "sampled")

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


def test_long_runs_in_pairs_suit_processes_and_are_one_thread_s() -> None:
    """They hold Python's lock; one run, one worker, or a short batch is not worth the start of processes."""
    pairs: dict[str, Any] = {"interaction": {"model": "pairwise"}, "path": {"separation": ["3 um", "2 um"]}}
    many = {"batch": {"realizations": 10_000}}
    assert suits_processes(planned(**pairs, **many), 2)
    assert not suits_processes(planned(**pairs, **many), 1)
    assert not suits_processes(planned(**pairs, batch={"realizations": 1}), 2)
    few = {"asperities": {**ASPERITIES, "count": 50}, "batch": {"realizations": 3}}
    assert not suits_processes(planned(**pairs, **few), 2)
    mean_field = {**pairs, "interaction": {"model": "mean_field"}, "adhesion": None}
    for alone in (planned(**(pairs | {"interaction": None}), **many), planned(**mean_field, **many)):
        assert not suits_processes(alone, 2)
        assert Backend(workers=3).for_runs_of(alone).workers == 3
    in_pairs = planned(**pairs, **many)
    assert Backend(workers=3).for_runs_of(in_pairs).workers == 1
    assert Backend("processes", 3).for_runs_of(in_pairs).workers == 3
    on_a_grid = planned(
        **{**pairs, "adhesion": None, "interaction": {"model": "pairwise", "beyond": "boundary_elements"}}
    )
    assert Backend(workers=3).for_runs_of(on_a_grid).workers == 3
