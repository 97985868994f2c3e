"""Few contacts that carry the load are told: one map or realisation is then one sample."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import scene

import roughmdr as rm
from roughmdr.aggregate.law import effective_number
from roughmdr.cli import main
from roughmdr.report.contacts import describe_sample
from roughmdr.variables import RUN_DIAGNOSTICS

FORCES = st.lists(st.floats(1e-3, 1.0) | st.floats(-1.0, -1e-3), min_size=1, max_size=20)


def few(**changes: Any) -> dict[str, Any]:
    """Few of many asperities touch."""
    path = {"separation": {"start": "3 sigma", "stop": "2.1 sigma", "steps": 5}}
    return scene(**{"adhesion": None, "path": path, "batch": {"realizations": 300}, **changes})


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
    none, some = np.array([0.0, -1.0, np.nan]), np.array([0.0, 4.0, np.nan])
    assert not describe_sample([none], "[asperities]")
    words = describe_sample([none, some], "[asperities]")
    assert words.startswith("about 4 contacts")


def test_it_is_the_scatter_of_realisations() -> None:
    """The variance of the force over realisations is the mean of its square over the number."""
    result = rm.run(few())
    force, number = result.force.values[:, -1], result.effective_contacts.values
    assert np.isfinite(number).all()
    assert np.median(number) < 10.0
    assert np.var(force) == pytest.approx(np.mean(force**2 / number), rel=0.2)
    assert "one realisation is one sample" in rm.info(result)


def test_plan_run_and_info_say_it(tmp_path: Path) -> None:
    import tomli_w

    table = few(batch=None, seed=2, sweep={"asperities.count": [1000, 100_000]})
    file, out = tmp_path / "few.toml", tmp_path / "few.nc"
    file.write_text(tomli_w.dumps(table))
    told = []
    for command in (["plan", str(file)], ["run", str(file), "-o", str(out)], ["info", str(out)]):
        outcome = CliRunner().invoke(main, [*command, "--json"])
        assert outcome.exit_code == 0, outcome.output
        document = json.loads(outcome.stdout)
        whole = document["plan"] or document["result"]
        told.append(whole["sample"])
        numbers = [cell["effective_contacts"] for cell in whole["cells"]]
        assert numbers[1] > 30.0 * numbers[0]
    assert told[1] == told[2]
    assert all("contacts carry the load at closest approach in 1 of 2 cells" in text for text in told)


def test_nothing_is_said_of_many_contacts_nor_of_few_that_were_asked_for() -> None:
    toml = "[asperities]\nsource = 'random'\ncount = {}"
    unknown = np.full(3, math.nan)
    assert not describe_sample([np.array([9.0, 12.0, 30.0]), unknown], toml.format(500))
    assert not describe_sample([np.array([1.0])], toml.format(1))
    for source, word in (("surface", "map"), ("file", "ensemble"), ("random", "realisation")):
        text = describe_sample([np.array([4.0]), unknown], f"[asperities]\nsource = '{source}'")
        assert f"about 4 contacts carry the load at closest approach: one {word} is" in text
        assert text.endswith("differs by about 50 %")


def test_of_statistics_the_least_is_kept() -> None:
    assert RUN_DIAGNOSTICS["effective_contacts"].merge == "fmin"
    table = few(batch={"realizations": 5})
    curves, statistics = rm.run(table), rm.run(table | {"output": {"keep": "statistics"}})
    assert float(statistics.effective_contacts) == float(curves.effective_contacts.min())


def test_of_several_cells_the_median_of_each_counts_and_the_fewest_scatter_most() -> None:
    runs = [np.array([4.0, 5.0, 100.0]), np.array([7.0, np.nan]), np.array([40.0]), np.array([np.nan])]
    told = describe_sample(runs, 'asperities = { source = "surface" }')
    assert told.startswith("about 5 to 7 contacts carry the load at closest approach in 2 of 3 cells: one map is one")
    assert told.endswith("the load of another differs by up to about 45 %")
