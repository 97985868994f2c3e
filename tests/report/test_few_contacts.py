"""One map or realisation is one sample: how far another differs is told, and how many contacts carry the load."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from batches import write_scene
from command import said
from hypothesis import given, settings, strategies as st
from numpy.typing import ArrayLike
from scenes import scene

import roughmdr as rm
from roughmdr.aggregate.law import effective_number
from roughmdr.report.contacts import describe_sample
from roughmdr.variables import RUN_DIAGNOSTICS, SAMPLE

FORCES = st.lists(st.floats(1e-3, 1.0) | st.floats(-1.0, -1e-3), min_size=1, max_size=20)


def few(**changes: Any) -> dict[str, Any]:
    """Few of many asperities touch."""
    path = {"separation": {"start": "3 sigma", "stop": "2.1 sigma", "steps": 5}}
    return scene(**{"adhesion": None, "path": path, "batch": {"realizations": 300}, **changes})


def told(effective: ArrayLike, errors: ArrayLike, of_area: ArrayLike, scene: str) -> str:
    return describe_sample(dict(zip(SAMPLE, map(np.array, (effective, errors, of_area)), strict=True)), scene)


@settings(deadline=None)
@given(FORCES, st.integers(1, 5), st.sampled_from([1e-300, 1e-9, 1e300]))
def test_the_effective_number_counts_equal_contacts(forces: list[float], copies: int, unit: float) -> None:
    """Copies multiply it, units and signs do not matter, and it is from 1 to the number of contacts."""
    force = np.array(forces)
    number = effective_number(force)
    assert 1.0 - 1e-12 < number < (1.0 + 1e-12) * force.size
    assert effective_number(np.tile(unit * force, copies)) == pytest.approx(copies * number, rel=1e-12)
    assert effective_number(np.append(-force, 0.0)) == pytest.approx(number, rel=1e-12)
    assert effective_number(np.full(force.size, -unit)) == pytest.approx(force.size, rel=1e-12)


def test_without_contact_there_is_no_number() -> None:
    assert math.isnan(effective_number(np.zeros(3)))
    assert math.isnan(effective_number(np.zeros(0)))
    none = np.full(2, math.nan)
    assert not told(none, none, none, "[asperities]")
    words = told([math.nan, 4.0], [math.nan, 0.5], none, "[asperities]")
    assert words.startswith("about 4 contacts")


def test_it_is_the_scatter_of_realisations() -> None:
    """The variance of the force over realisations is the mean of its square over the number, or of the stated one."""
    result = rm.run(few())
    force, number = result.force.values[:, -1], result.effective_contacts.values
    assert np.isfinite(number).all()
    assert np.median(number) < 10.0
    assert np.var(force) == pytest.approx(np.mean(force**2 / number), rel=0.2)
    assert np.var(force) == pytest.approx(np.mean((force * result.sampling_error.values) ** 2), rel=0.2)
    assert "sample" not in rm.info(result)  # their standard error says it
    one = rm.run(few(batch=None))
    assert "one realisation is one sample" in rm.info(one)
    assert one.roughmdr.trust().attrs["trust"].count("\nsample ") == 1
    assert float(one.roughmdr.trust().sampling_error) == one.sampling_error.item()


def test_plan_run_and_info_say_it(tmp_path: Path) -> None:
    table = few(batch=None, seed=2, sweep={"asperities.count": [1000, 100_000]})
    write_scene(tmp_path, table)
    texts = []
    for command in (["plan", "scene.toml"], ["run", "scene.toml", "-o", "few.nc"], ["info", "few.nc"]):
        document = json.loads(said(*command, "--json", cwd=tmp_path))
        whole = document["plan"] or document["result"]
        texts.append(whole["sample"])
        numbers, errors, of_area = ([cell[name] for cell in whole["cells"]] for name in SAMPLE)
        assert numbers[1] > 30.0 * numbers[0]
        assert 0.0 < errors[1] < errors[0] / 5.0
        assert 0.0 < of_area[1] < errors[1]
    assert texts[1] == texts[2]
    assert all("contacts carry the load at closest approach: one realisation" in text for text in texts)


def test_nothing_is_said_of_many_contacts_nor_of_few_that_were_asked_for() -> None:
    toml, unknown = "[asperities]\nsource = 'random'\ncount = {}", [math.nan, math.nan]
    few_contacts = [math.nan, 4.0], [math.nan, 0.5], unknown
    assert not told([2e4], [0.007], [0.001], toml.format(50_000))
    assert not told(*few_contacts, toml.format(4))
    for source, word in (("surface", "map"), ("file", "ensemble"), ("random", "realisation")):
        text = told(*few_contacts, f"[asperities]\nsource = '{source}'")
        assert f"about 4 contacts carry the load at closest approach: one {word} is" in text
        assert text.endswith("differs by about 50 %")


def test_of_statistics_the_least_is_kept() -> None:
    assert RUN_DIAGNOSTICS["effective_contacts"].merge == "fmin"
    table = few(batch={"realizations": 5})
    curves, statistics = rm.run(table), rm.run(table | {"output": {"keep": "statistics"}})
    assert float(statistics.effective_contacts) == float(curves.effective_contacts.min())


def test_of_several_cells_the_range_is_told() -> None:
    numbers, errors = [5.0, math.nan, 40.0, 7.0], [0.45, math.nan, 0.16, 0.6]
    text = told(numbers, errors, [0.1, math.nan, 0.05, math.nan], 'asperities = { source = "surface" }')
    assert text.startswith("about 5 to 40 contacts carry the load at closest approach: one map is one sample")
    assert text.endswith("differs by about 16 to 60 %, at the same force the contact area by 5 to 10 %")
