"""Results of contacts that yield tell errors where these are known, and what their models leave out."""

from typing import Any

import pytest
from scenes import scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.report.documents import trust_table
from roughmdr.result.model_errors import largest_of_result
from roughmdr.result.trust import pull_off_error_of, trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.scene import read
from roughmdr.storage.labelled import Labelled

SOFT = {"yield_strength": 1e5}


def left_out(**changes: Any) -> list[str]:
    return [line for line in make_plan(read(scene(**changes))).left_out if "plastic" in line or "yield" in line]


@pytest.mark.parametrize("plasticity", [SOFT, None])
@pytest.mark.parametrize("machine", [True, False])
def test_errors_at_given_pressure_are_told_unless_contacts_yield_and_adhere(machine: bool, plasticity: Any) -> None:
    way = {"force": {"stop": "1 mN", "steps": 5}} if machine else {"separation": {"stop": "1 sigma", "steps": 20}}
    table = scene(path={**way, "unload": not machine}, batch={"realizations": 3}, plasticity=plasticity)
    result = rm.run({key: each for key, each in table.items() if key != "adhesion" or not machine})
    view, elastic = ResultView(Labelled.of(result)), plasticity is None
    lines, read_off = list(trust_of_result(view)), result if machine else result.roughmdr.at_pressure(10.0)
    told = any(name.endswith("_model_error") for name in read_off), bool(largest_of_result(view))
    assert {*told, any("at given pressure" in text for _, text in lines)} == {elastic or machine}
    assert (trust_table(lines)["yielding"] is None) == elastic
    if not machine:
        words = pull_off_error_of(view)
        assert ("", words) in lines
        assert ("% typically" in words, "upper bound" in words) == (elastic, not elastic)
        assert ("force_model_error" in result.roughmdr.pull_off()) == elastic


def test_what_is_left_out() -> None:
    (dry,), sticky = left_out(plasticity=SOFT, adhesion=None), left_out(plasticity=SOFT)
    assert "size effect" in dry
    assert [sticky[0], "dents" in sticky[1]] == [dry, True]
    assert left_out() == ["plastic flow: the scene has no [plasticity]"]
    assert left_out(adhesion=None, interaction={"model": "mean_field"}) == ["plastic flow: contacts are elastic"]


def test_refusals_are_in_words() -> None:
    auxetic = scene(material={"modulus": 1e9, "poisson": -0.2}, adhesion=None)
    for section, words in (
        (SOFT | {"hardness": 1e9}, "plasticity: takes either yield_strength or hardness, not both"),
        (SOFT | {"model": "jackson-green"}, r"material\.poisson: is -0\.2; .* at least 0"),
    ):
        with pytest.raises(rm.SceneError, match=words):
            read(auxetic | {"plasticity": section})
