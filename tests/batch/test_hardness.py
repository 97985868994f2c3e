"""material.hardness: the diagnostics of a result, what plan, run, info and the report say, and scenes without it."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from batches import write_scene
from command import said
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.errors import SceneError
from roughmdr.result.hardness import hardness_lines
from roughmdr.scene import read
from roughmdr.variables import YIELDING

ALUMINIUM = {"modulus": "70 GPa", "poisson": 0.33}
PATH = {"separation": {"start": "clear", "stop": "1 sigma", "steps": 12}}
RELAXING = {"relaxation": [{"time": "1 s", "share": 0.5}], "speed": "1 um/s"}


def joint(hardness: str | float | None = "5 GPa", **changes: Any) -> dict[str, Any]:
    material = ALUMINIUM if hardness is None else {**ALUMINIUM, "hardness": hardness}
    return scene(**{"material": material, "adhesion": None, "path": PATH, "batch": {"realizations": 3}, **changes})


def words_of(table: dict[str, Any]) -> str:
    """The lines on the hardness of a run, as one text."""
    found = re.search(r"^hardness +(.*?)^\w", rm.info(rm.run(table)), flags=re.MULTILINE | re.DOTALL)
    assert found
    return " ".join(found[1].split())


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"batch": {"estimator": "expected"}},
        {"path": {"pressure": {"start": "0 Pa", "stop": "50 MPa", "steps": 5}}},
        {"adhesion": {"model": "jkr", "work": "1 J/m^2"}},
        large({"adhesion": {"model": "dugdale", "work": "1 J/m^2", "strength": "2 GPa"}}),
        large({"interaction": {"model": "mean_field", "boundary": "free"}}),
        large({"interaction": {"model": "pairwise"}, "path": {"separation": ["3 um", "1 um"]}}),
    ],
)
def test_nothing_else_depends_on_it(changes: dict[str, Any]) -> None:
    without, soft = (rm.run(joint(hardness, **changes)) for hardness in (None, "2 GPa"))
    assert without.data_vars.keys().isdisjoint(YIELDING)
    assert soft.data_vars.keys() - without.data_vars.keys() == set(YIELDING)
    for name in without.data_vars.keys() - {"run_time"}:
        np.testing.assert_array_equal(soft[name], without[name])
    assert (soft.yielded_load_fraction > 0.5).all()
    assert (soft.elastic_separation > soft.separation.min()).all()
    assert "hardness" not in rm.info(without).partition("made by")[0].replace("hardness of the softer", "")


def test_the_limit_is_on_the_law(tmp_path: Path) -> None:
    """A run that ends there has its pressure, and is elastic; one that ends below is not."""
    one = joint(batch=None)
    found = rm.run(one)
    limit = float(found.elastic_separation[0])
    below = limit - 1e-3 * (float(found.separation[0]) - limit)
    variables = {"variables": ["pressure"]}
    again = rm.run({**one, "path": {"separation": [limit, below]}, "output": variables})
    assert float(again.pressure[0, 0]) == pytest.approx(float(found.elastic_pressure[0]), rel=1e-12)
    assert float(again.yielded_load_fraction[0]) > 0.02
    last = rm.run({**one, "path": {"separation": [limit]}})
    assert float(last.yielded_load_fraction[0]) <= 0.02
    assert np.isnan(last.elastic_pressure).all()


def test_the_expected_law_has_the_shares_of_many_draws() -> None:
    mean, drawn = (rm.run(joint(batch=batch)) for batch in ({"estimator": "expected"}, {"realizations": 100}))
    for name in ("yielded_contact_fraction", "yielded_load_fraction"):
        error = float(drawn[name].std()) / np.sqrt(100.0)
        assert float(mean[name][0]) == pytest.approx(float(drawn[name].mean()), abs=4.0 * error)
    assert float(mean.plasticity_index[0]) == pytest.approx(float(drawn.plasticity_index.mean()), rel=1e-2)


def test_a_sweep_and_statistics_over_realisations() -> None:
    """The worst of the realisations are kept: the largest shares, the least pressure, the highest separation."""
    sweep = {"material.hardness": ["2 GPa", "5 GPa", "50 GPa"]}
    curves, kept = (rm.run(joint(None, sweep=sweep, output={"keep": keep})) for keep in ("curves", "statistics"))
    for name in YIELDING:
        worst = curves[name].min("realization") if name == "elastic_pressure" else curves[name].max("realization")
        np.testing.assert_array_equal(kept[name], worst)
    assert (np.diff(curves.yielded_load_fraction, axis=0) < 0.0).all()
    assert np.isnan(curves.elastic_pressure[2]).all()


@pytest.mark.parametrize("key", ["viscoelastic", "nominal"])
def test_bodies_that_are_no_elastic_ones_under_a_flat_are_refused(key: str) -> None:
    section = {"viscoelastic": RELAXING, "nominal": {"radius": "10 mm"}}[key]
    batch = {"estimator": "expected"} if key == "nominal" else None
    with pytest.raises(SceneError, match=r"material\.hardness: tells where elastic contacts under a flat yield"):
        read(joint(**{key: section, "batch": batch, "output": {"variables": ["force"]}}))


@pytest.mark.parametrize("hardness", [0.0, "-1 GPa", "1 m"])
def test_it_is_a_pressure_above_0(hardness: Any) -> None:
    with pytest.raises(SceneError, match=r"material\.hardness"):
        read(joint(hardness))


def test_what_a_run_says() -> None:
    some = words_of(joint())
    assert re.search(r"[\d.]+ to [\d.]+ % of the contacts, with [\d.]+ to [\d.]+ % of the load", some)
    assert re.search(
        r"while they bear at most 2 % of the load: up to [\d.]+ to [\d.]+ MPa, h = [\d.]+ to [\d.]+ um", some
    )
    assert "beyond, contacts flow" in some
    assert "at any load (plasticity index 2.2)" in some
    none = words_of(joint("50 GPa"))
    assert "0 % of the contacts, with 0 % of the load" in none
    assert "the elastic law holds along the whole path" in none
    assert "at extreme loads only (plasticity index 0.22)" in none
    assert "beyond" not in none
    assert "if the load is high (plasticity index 0.8)" in words_of(joint("14 GPa"))


@pytest.mark.parametrize(("pressure", "said"), [(0.0, "they do at no load"), (np.nan, "of the load: down to h = 1 um")])
def test_no_limit_and_no_area_in_words(pressure: float, said: str) -> None:
    numbers = dict(zip(YIELDING, ([1.0], [1.0], [pressure], [1e-6], [np.nan]), strict=True))
    text = "\n".join(words for _, words in hardness_lines(numbers))
    assert said in text
    assert "plasticity index" not in text


def test_plan_run_info_and_trust_say_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    table = joint()
    result = rm.run(table, "out.nc")
    write_scene(tmp_path, table)
    plan = said("plan", "scene.toml")
    for text in (rm.info(result), plan, result.roughmdr.trust().attrs["trust"]):
        assert "the elastic law holds while they bear at most" in " ".join(text.split())
    assert "hardness tells which of them yield" in rm.info(result)
    done = json.loads(said("info", "out.nc", "--json"))["result"]
    cell = done["cells"][0]["yielding"]
    assert cell["yielded_load_fraction"] == float(result.yielded_load_fraction.max())
    assert cell["elastic_pressure"] == float(result.elastic_pressure.min())
    assert "the elastic law holds" in done["trust"]["hardness"]


@pytest.mark.large
def test_the_report_says_it(tmp_path: Path) -> None:
    rm.write_report(rm.run(joint()), tmp_path / "out.html")
    assert "the elastic law holds while they bear at most" in " ".join((tmp_path / "out.html").read_text().split())
