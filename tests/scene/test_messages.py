"""Messages about what is missing show an example, and those about a constant speak of no distribution."""

import copy
import re
import tomllib
from typing import Any

import pytest
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.errors import Fault
from roughmdr.scene import read
from roughmdr.shapes import SCENE_SHAPES

COMPLETE = scene(
    counter={"modulus": "70 GPa", "poisson": 0.2},
    accuracy={"relative": 0.1},
    asperities={**ASPERITIES, "second": {"share": 0.3, "radius": "9 um"}},
)
EXAMPLE = re.compile(r"is missing; for example: (?:\[(?P<section>\w+)\] )?(?P<keys>.*)")
REQUIRED = [
    "material", "path", "asperities", "asperities.patch", "asperities.height", "asperities.radius",
    "asperities.second.share", "path.separation", "path.separation.stop",
    "path.separation.steps", "adhesion.model", "adhesion.work", "counter.modulus", "counter.poisson",
    "accuracy.relative",
]  # fmt: skip


def faults_of(table: dict[str, Any]) -> tuple[Fault, ...]:
    with pytest.raises(rm.SceneError) as refused:
        read(table)
    return refused.value.faults


def table_at(table: dict[str, Any], keys: list[str]) -> dict[str, Any]:
    for key in keys:
        table = table[key]
    return table


@pytest.mark.parametrize("key", REQUIRED)
def test_the_example_for_what_is_missing_makes_the_scene_complete(key: str) -> None:
    table = copy.deepcopy(COMPLETE)
    *outer, last = key.split(".")
    del table_at(table, outer)[last]
    (fault,) = faults_of(table)
    assert fault.key == key
    found = EXAMPLE.match(fault.message)
    assert found, fault.message
    example = tomllib.loads(re.sub(r", (?=\w+ = [^}]*(\{|$))", "\n", found["keys"]))
    table_at(table, outer).update({found["section"]: example} if found["section"] else example)
    assert read(table).toml


@pytest.mark.parametrize("shape", SCENE_SHAPES)
def test_the_examples_of_the_parameters_of_every_shape_go_together(shape: str) -> None:
    section = {**ASPERITIES, "shape": shape}
    del section["radius"]
    table = scene(asperities=section, adhesion=None)
    for fault in faults_of(table):
        found = EXAMPLE.match(fault.message)
        if found:
            table["asperities"] |= tomllib.loads(found["keys"])
    if shape == "power_law":  # it has two sets of parameters, and names both
        assert "takes exponent and coefficient" in faults_of(table)[0].message
    else:
        read(table)


CAPPED = {"shape": "capped_paraboloid", "radius": "10 um", "cap_radius": "20 um", "blend_radius": "1 um"}
NORMAL = {"distribution": "normal", "mean": "10 um", "std": "1 um"}


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"radius": "0 um"}, "asperities.radius = '0 um': must be above 0"),
        ({"radius": -1}, "asperities.radius = -1: must be above 0"),
        ({"second": {"share": 0.2, "radius": 0}}, "asperities.second.radius = 0: must be above 0"),
        ({**CAPPED, "cap_radius": "5 um"}, "asperities.cap_radius = '5 um': must not be below radius, 10 um: with"),
        (
            {**CAPPED, "second": {"share": 0.2, "cap_radius": "5 um"}},
            "asperities.second.cap_radius = '5 um': must not be below radius, 10 um: with",
        ),
        ({"shape": "power_law", "radius": None, "exponent": 0.4, "coefficient": 1.0}, "exponent: 0.4 is too low;"),
    ],
)
def test_a_constant_is_refused_as_a_constant(changes: dict[str, Any], says: str) -> None:
    section = {key: value for key, value in {**ASPERITIES, **changes}.items() if value is not None}
    (fault,) = faults_of(scene(asperities=section))
    assert says in str(fault)
    for word in ("as low as", "as high as", "lognormal", "from "):
        assert word not in str(fault)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"radius": {**NORMAL, "std": "5 um"}}, "can be as low as -.* um; it must be above 0"),
        ({**CAPPED, "radius": NORMAL}, "cap_radius = '.* um': must not be below radius, which can be as high as 18"),
        ({**CAPPED, "cap_radius": NORMAL}, "cap_radius = 'from 1.* um': must not be below radius, 10 um"),
    ],
)
def test_a_distribution_is_refused_by_its_ends(changes: dict[str, Any], says: str) -> None:
    limited = {**changes, **({"cap_radius": "12 um"} if changes.get("radius") == NORMAL else {})}
    (fault,) = faults_of(scene(asperities={**ASPERITIES, **limited}))
    assert re.search(says, str(fault))
