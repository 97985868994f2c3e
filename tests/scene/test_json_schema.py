"""The JSON Schema of scenes: it allows what ``read`` allows, refuses what is misspelt, and says what each key is."""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import chdir
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import tomli_w
from command import roughmdr, said
from hypothesis import HealthCheck, given, settings, strategies as st
from scenes import ASPERITIES, scene
from studies.random_scenes.scenes import scenes, write_inputs
from test_mutations import BASES, FEW_AND_ALL, Mutation, mutations

import roughmdr as rm
from roughmdr.errors import RoughmdrError
from roughmdr.scene import read
from roughmdr.scene.json_schema import scene_schema
from roughmdr.scene.schema_file import FILE_NAME, schema_text
from roughmdr.schema.units import _BASES, DIMENSIONLESS, _table, quantity, quantity_pattern

ROOT = Path(__file__).parents[2]
SCENES = [*sorted((ROOT / "pipelines" / "scenes").glob("*.toml")), Path(rm.__file__).parent / "starter.toml"]
TAPLO = Path(sys.executable).with_name("taplo")


@cache
def schema() -> dict[str, Any]:
    return scene_schema()


@cache
def validator() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(schema())


def faults(table: dict[str, Any]) -> list[str]:
    return [error.message for error in validator().iter_errors(table)]


@pytest.mark.large
def test_it_is_a_schema_of_its_draft() -> None:
    assert schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    jsonschema.Draft202012Validator.check_schema(schema())


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_scenes_that_come_with_it_are_valid(path: Path) -> None:
    assert faults(tomllib.loads(path.read_text())) == []


@pytest.mark.parametrize("base", BASES)
def test_every_kind_of_scene_is_valid(base: str) -> None:
    assert faults(BASES[base]) == []


_NOT_TOLD = {"nan", "inf", "-inf"}
"""No schema can tell them from numbers; TOML alone has them."""


def told(mutation: Mutation) -> bool:
    anything = mutation.key.endswith((".file", ".unit")) and mutation.what == "unknown name"
    left_out = mutation.what == "table" and "sweep" in mutation.table  # a distribution without name: it may be swept
    return mutation.what not in (*_NOT_TOLD, "negative") and not anything and not left_out


@pytest.mark.few(1)
@pytest.mark.parametrize("base", FEW_AND_ALL)
def test_one_thing_wrong_is_refused(base: str) -> None:
    for mutation in [each for each in mutations() if each.base == base and told(each)]:
        assert faults(mutation.table), str(mutation)


@pytest.mark.parametrize("base", FEW_AND_ALL)
def test_a_number_out_of_its_bounds_is_refused(base: str) -> None:
    for mutation in [each for each in mutations() if each.base == base and each.what == "negative"]:
        if mutation.key != "asperities.radius.mean":  # only a lognormal mean must be above 0
            assert faults(mutation.table), str(mutation)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    write_inputs(folder)
    return folder


@pytest.mark.large
@settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(data=st.data())
def test_what_can_be_read_is_valid(inputs: Path, data: st.DataObject) -> None:
    table = data.draw(scenes(inputs, ("paraboloid", "sphere", "flat_punch")))
    try:
        read(table)
    except RoughmdrError:
        return
    assert faults(table) == []


SWEEPS: list[dict[str, Any]] = [
    {"adhesion.work": ["10 mJ/m^2", 0.05]},
    {"mode": "zip", "adhesion.model": ["jkr", "dugdale"], "adhesion.strength": [1e6, "2 MPa"]},
    {"adhesion": {"work": {"logspace": ["1 mJ/m^2", "1 J/m^2"], "num": 3}}},
    {"asperities": {"height.std": {"linspace": ["1 um", "2 um"], "num": 2}, "radius": {"mean": ["50 um"]}}},
    {"asperities.height.distribution": ["normal", "gamma"], "asperities.height.a": [2.0, 3.0], "mode": "zip"},
    {"asperities": {"height": {"a": [2.0]}}},
    {"path.separation.start": ["3 sigma", "4 sigma"], "path.separation.stop": ["1 um"]},
    {"path": {"separation": {"stop": {"contact_fraction": [0.01, 0.02]}}}},
    {"path.machine_stiffness": ["1 kN/m"]},
    {"tangential.friction": [0.1, 0.3], "path.separation": ["1 sigma", "2 sigma"], "path.lateral.amplitude": ["1 nm"]},
    {"viscoelastic.relaxation[0].time": ["1 ms", 2.0], "viscoelastic": {"relaxation[12].share": [0.1]}},
]
WRONG_SWEEPS: list[dict[str, Any]] = [
    {"adhesion.wrok": [0.05]},
    {"adhesion.work": ["5 m"]},
    {"adhesion.work": 0.05},
    {"adhesion.work": {"logspace": [1, 2], "nmu": 3}},
    {"adhesion.model": ["jrk"]},
    {"asperities.height.distribution": ["nromal"]},
    {"asperities.slope.q": [1.0], "mode": "both"},
    {"batch.realizations": [1, 2]},
    {"adhesion": {"wrok": [0.05]}},
    {"viscoelastic.relaxation[0].tim": ["1 ms"]},
    {"viscoelastic": {"relaxation[].share": [0.1]}},
]


@pytest.mark.parametrize("sweep", SWEEPS, ids=str)
def test_sweeps(sweep: dict[str, Any]) -> None:
    assert faults(scene(sweep=sweep)) == []


@pytest.mark.parametrize("sweep", WRONG_SWEEPS, ids=str)
def test_wrong_sweeps(sweep: dict[str, Any]) -> None:
    assert faults(scene(sweep=sweep))


def test_a_swept_key_may_be_left_out_and_others_may_not() -> None:
    without = {key: value for key, value in ASPERITIES.items() if key != "radius"}
    swept = scene(asperities=without, sweep={"asperities.radius": ["10 um", "20 um"]})
    assert read(swept).cells
    assert faults(swept) == []
    assert faults(scene(asperities=without)) == ["'radius' is a required property"]
    assert faults(scene(path=None)) == ["'path' is a required property"]


@pytest.mark.parametrize(
    ("height", "message"),
    [
        ({"distribution": "nromal", "std": "1 um"}, "'nromal' is not one of"),
        ({"distribution": "normal", "a": 2.0, "std": "1 um"}, "'a' is not one of"),
        ({"distribution": "gamma", "a": 2.0, "std": "-1 m/s"}, "'-1 m/s' does not match"),
        ({"distribution": "gamma", "a": 2.0, "std": -1.0}, "-1.0 is less than or equal to the minimum of 0.0"),
        ("3 parsec", "'3 parsec' does not match"),
        (True, "True is not of type 'number', 'string', 'object'"),
    ],
)
def test_messages_name_what_is_wrong(height: Any, message: str) -> None:
    found = faults(scene(asperities={**ASPERITIES, "height": height}))
    assert [message in fault for fault in found] == [True]


def keys(schema: dict[str, Any], at: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    for name, value in schema.get("properties", {}).items():
        yield f"{at}{name}", value
        if f"{at}{name}" != "sweep":
            yield from keys(value, f"{at}{name}.")


def test_every_key_is_described_with_its_unit_and_default() -> None:
    told = dict(keys(schema()))
    assert len(told) > 90
    for key, value in told.items():
        assert len(value["description"]) > 5, key
        if "default" in value and key not in ("path.separation.start", "path.remote.start"):
            assert f"Default: {json.dumps(value['default'])}." in value["description"], key
    assert "in Pa" in told["material.modulus"]["description"]
    assert "above -1 and at most 0.5" in told["material.poisson"]["description"]
    for key in ("adhesion.model", "asperities.source", "asperities.shape", "output.keep", "interaction.boundary"):
        assert len(told[key]["enum"]) > 1
    for name in ("distribution", "distribution_of_m"):
        assert {"normal", "lognormal", "weibull_min"} <= set(
            schema()["$defs"][name]["properties"]["distribution"]["enum"]
        )


def test_no_table_of_it_takes_any_key() -> None:
    def check(schema: Any) -> None:
        if isinstance(schema, dict):
            if schema.get("type") == "object" and "then" not in schema and "terms" not in schema:
                assert "additionalProperties" in schema or "allOf" in schema, schema
            for value in schema.values():
                check(value)

    check({name: value for name, value in schema().items() if name != "then"})


@pytest.mark.large
@given(data=st.data())
def test_the_pattern_of_a_quantity_is_what_is_read(data: st.DataObject) -> None:
    dimension = data.draw(st.sampled_from([*_BASES, DIMENSIONLESS]))
    units = sorted({unit for other in _BASES for unit in _table(other)} | {"", "parsec", "sigma", "1"})
    spelt = data.draw(st.sampled_from(units))
    for old, new in (("^", "**"), ("^2", "²"), ("/m^2", " m-2"), ("/m^2", " m^-2"), ("/", "1/")):
        spelt = spelt.replace(old, new) if data.draw(st.integers(0, 5)) == 0 else spelt
    number = data.draw(st.sampled_from(["1", "-2.5", ".5", "1e-3", "+3.E+2", "1,5", "x", ""]))
    text = f"{number}{data.draw(st.sampled_from(['', ' ', '  ']))}{spelt}"
    try:
        quantity(text, dimension)
    except RoughmdrError:
        assert not re.search(quantity_pattern(dimension), text)
    else:
        assert re.search(quantity_pattern(dimension), text)


# The commands, and taplo


def linted(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [TAPLO, "lint", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_the_command_prints_and_writes_it(tmp_path: Path) -> None:
    with chdir(tmp_path):
        assert json.loads(said("schema")) == json.loads(schema_text())
        for _ in range(2):  # a schema gives way to one
            assert said("schema", "-o", "a.json").split() == ["schema", "a.json"]
        assert Path("a.json").read_text().strip() == schema_text()
        for name, says in (("other.json", "is no schema of scenes"), ("a.toml", "must end in .json")):
            Path(name).write_text("{}")
            done = roughmdr("schema", "-o", name)
            assert (done.returncode, says in done.stderr) == (2, True)
            assert Path(name).read_text() == "{}"
        said("schema", "-o", "other.json", "--fresh")
        assert "properties" in json.loads(Path("other.json").read_text())


def test_a_new_scene_names_its_schema_to_editors(tmp_path: Path) -> None:
    with chdir(tmp_path):
        output = said("new", "a.toml")
        assert f"{FILE_NAME}, by which editors complete and check scenes" in output
        assert Path("a.toml").read_text().startswith("#:schema roughmdr.schema.json\n# A scene")
        assert linted("a.toml").returncode == 0
        Path("b.toml").write_text(Path("a.toml").read_text().replace('"jkr"', '"jrk"', 1))
        done = linted("b.toml")
        assert done.returncode != 0
        assert '"jrk" is not one of ["jkr","dugdale","auto"]' in done.stderr
        assert read("a.toml").title == "A rough surface"
        assert "is there already, and is kept\n" in said("new", "c.toml")


@pytest.mark.parametrize("content", ["{}", "no JSON", "[" * 100_000, None, "link"])
def test_another_file_in_its_place_is_kept(tmp_path: Path, content: str | None) -> None:
    with chdir(tmp_path):
        there = Path(FILE_NAME)
        if content is None:
            there.mkdir()
        elif content == "link":
            there.symlink_to("nowhere")
        else:
            there.write_text(content)
        output = said("new", "a.toml")
        assert "is kept; it is not that of this version" in output
        assert "roughmdr schema -o" in output
        assert Path("a.toml").exists()
        assert content in (None, "link") or there.read_text() == content
        assert content != "link" or there.is_symlink()


def test_taplo_finds_all_scenes_valid_and_wrong_ones_not(tmp_path: Path) -> None:
    schema = tmp_path / "schema.json"
    schema.write_text(schema_text())
    right = [Path(shutil.copy(path, tmp_path)) for path in SCENES]
    for number, base in enumerate(BASES):
        right.append(tmp_path / f"{number}.toml")
        right[-1].write_text(tomli_w.dumps(BASES[base]))
    done = linted("--schema", schema.as_uri(), *right)
    assert done.returncode == 0, done.stderr[:3000]
    some = [each for each in mutations() if each.what in ("misspelt", "unknown name", "unit", "truth") and told(each)][
        ::40
    ]
    wrong = [tmp_path / f"wrong_{number}.toml" for number in range(len(some))]
    for path, mutation in zip(wrong, some, strict=True):
        path.write_text(tomli_w.dumps(mutation.table))
    told_of = linted("--schema", schema.as_uri(), *wrong).stderr
    for path, mutation in zip(wrong, some, strict=True):
        assert f"{path.name}:" in told_of, str(mutation)
