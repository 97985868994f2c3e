"""Stages: what each declares is there, and what goes with none is refused at once."""

from typing import Any

import pytest
from scenes import scene

import roughmdr as rm
from roughmdr.report.result_document import result_table
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene, read
from roughmdr.schema.section import meanings
from roughmdr.stages import STAGES, stages_in
from roughmdr.stages.conduction import Conduction
from roughmdr.stages.stage import Stage
from roughmdr.variables import OUTPUT_VARIABLES, RESULT_ATTRIBUTES

RELAXING = {"relaxation": [{"time": "1 s", "share": 0.5}], "speed": "1 um/s"}
LATERAL = {"separation": "1 sigma", "lateral": {"amplitude": "1 um", "steps": 4}}


@pytest.mark.parametrize("stage", STAGES, ids=lambda stage: stage.key)
def test_what_a_stage_declares_is_there(stage: type[Stage]) -> None:
    assert stage.key in Scene.model_fields
    assert all(field.description or meanings(stage)[name] for name, field in stage.model_fields.items())
    assert set(stage.own_variables) <= set(OUTPUT_VARIABLES)
    assert not stage.noted or stage.noted in RESULT_ATTRIBUTES
    table = {**scene(adhesion=None, batch=None), **stage.small_scene}
    section = read(table).stage(stage)
    assert section is not None
    assert section.attributes().keys() <= RESULT_ATTRIBUTES.keys()
    cited = stage.cites(table, list(OUTPUT_VARIABLES))
    assert cited.items() <= stage.papers.items()
    assert bool(cited) == bool(stage.papers)
    assert stages_in(table) == [stage]
    assert section.coarse().model_fields_set >= section.model_fields_set - {"error"}


def test_a_section_that_is_swept_alone_is_in_the_scene() -> None:
    table = {"sweep": {"nominal.radius": ["1 mm", "2 mm"]}}
    assert [stage.key for stage in stages_in(table)] == ["nominal"]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"viscoelastic": RELAXING, "path": LATERAL}, "path.lateral: does not go with viscoelastic"),
        ({"nominal": {"radius": "1 mm"}, "path": LATERAL}, "path.lateral: does not go with nominal"),
        ({"nominal": {"radius": "1 mm"}, "viscoelastic": RELAXING}, "viscoelastic: does not go with nominal"),
        (
            {"viscoelastic": RELAXING, "tangential": {}, "output": {"variables": ["force", "tangential_stiffness"]}},
            "tangential_stiffness cannot be computed with [viscoelastic]",
        ),
    ],
)
def test_two_that_make_another_law_are_refused(changes: dict[str, Any], says: str) -> None:
    path = {"separation": {"start": "2 sigma", "stop": "1 sigma", "steps": 4}}
    with pytest.raises(rm.SceneError) as refused:
        read(scene(adhesion=None, **{"path": path, **changes}))
    assert says in str(refused.value)


def test_what_a_section_tells_of_a_result_is_in_its_summary_and_its_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Conduction, "result_lines", lambda result: iter([(Conduction.key, "told of the contacts")]))
    result = rm.run(scene(batch={"realizations": 1}, path={"separation": ["1 um", "0 um"]}))
    assert "told of the contacts" in rm.info(result)
    table = result_table(ResultView(result), None)
    assert table["conduction"] == "told of the contacts"
    assert table["reference"] is None


def test_the_spelling_of_a_scene_decides_no_key() -> None:
    """Not its order, its units, its title, nor defaults that are written out."""
    from roughmdr.scene.identity import Digests

    one = scene(viscoelastic=RELAXING, adhesion=None, path={"separation": ["3 um", "1 um"]}, batch=None)
    other = {
        **{name: one[name] for name in reversed(one)},
        "title": "Another",
        "seed": one.get("seed", 0),
        "viscoelastic": {"speed": "1e-3 mm/s", "dwell": 0, "relaxation": [{"share": 0.5, "time": "1000 ms"}]},
        "path": {"unload": False, "separation": [3e-6, "1000 nm"]},
    }
    assert Digests().of(read(one)) == Digests().of(read(other))
    changed = {**other, "viscoelastic": {**RELAXING, "speed": "2 um/s"}}
    assert Digests().of(read(one)) != Digests().of(read(changed))
