"""Scenes with one thing wrong, made by walking the schema: each is refused at its key and line and writes nothing."""

import contextlib
import copy
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, get_origin

import numpy as np
import pytest
import tomli_w
import xarray as xr
from click.testing import CliRunner
from forms import large
from hypothesis import given, settings, strategies as st
from kinds import KINDS
from pydantic import BaseModel
from scenes import ASPERITIES, CONDUCTION, SCENE

from roughmdr.batch.plan import make_plan
from roughmdr.cli import main
from roughmdr.errors import SceneError
from roughmdr.scene import read
from roughmdr.scene.asked import Asked
from roughmdr.scene.keys import key_readers, set_key
from roughmdr.scene.scene import Scene
from roughmdr.schema.faults import sections_of

_DRAWN = {key: value for key, value in ASPERITIES.items() if key != "radius"}
_PLACES = {"at_pressure": "10 kPa", "at_force": "1 mN", "at_separation": "1 sigma"}
ASKED = {
    name: list(_PLACES.items())[(2 if name in ("force", "pressure") else number % 2)]
    for number, name in enumerate(name for name in Asked.model_fields if name not in _PLACES)
}
BASES: dict[str, dict[str, Any]] = KINDS | {
    "every section": {
        **SCENE,
        "counter": {"modulus": "70 GPa", "poisson": 0.2},
        "conduction": {**CONDUCTION, "counter_conductivity": 50.0},
        "asperities": {**ASPERITIES, "placement": "hard_core", "min_distance": "1 um"},
        "output": {"variables": ["force", "energy"], "keep": "statistics"},
        "sweep": {"mode": "zip", "adhesion.work": ["1 mJ/m^2", "2 mJ/m^2"]},
    },
    "cones": {
        **SCENE,
        "material": {"effective_modulus": "4 MPa", "hardness": "1 MPa"},
        "asperities": {**_DRAWN, "shape": "cone", "slope": 0.1},
        "accuracy": {"relative": 0.1, "max_realizations": 20, "method": "sampled"},
    },
    **{
        f"a {name} asked for": {
            **{key: value for key, value in SCENE.items() if key != "path"},
            "accuracy": {"max_realizations": 20, "of": {name: "5 nm" if name == "separation" else "2 %", place: given}},
            "conduction": CONDUCTION,
            "batch": {},
        }
        for name, (place, given) in ASKED.items()
    },
    "vacancies": {**SCENE, "asperities": {**ASPERITIES, "placement": "hexagonal", "vacancies": True}},
    **{
        f"{shape}: {', '.join(parameters)}": {
            **SCENE, "asperities": {**_DRAWN, "count": 20, "shape": shape, **parameters}, "batch": {}
        }
        for shape, parameters in (
            ("power_law", {"exponent": 2.5, "width": "10 um", "rise": "1 um"}),
            ("power_law", {"exponent": 2.5, "coefficient": 1e7}),
            ("flat_punch", {"radius": "2 um"}),
            ("sphere", {"radius": "50 um"}),
            ("truncated_cone", {"slope": 0.1, "flat_radius": "2 um"}),
            ("truncated_paraboloid", {"radius": "50 um", "flat_radius": "2 um"}),
            ("rounded_cone", {"slope": 0.1, "blend_radius": "2 um"}),
            ("capped_paraboloid", {"radius": "50 um", "cap_radius": "80 um", "blend_radius": "2 um"}),
            ("rounded_punch", {"flat_radius": "2 um", "edge_radius": "50 um"}),
            ("power_series", {"terms": {"2": 1e4, "4": 1e14}}),
            ("tabulated", {"r": [0, "1 um", "3 um"], "f": [0, "10 nm", "100 nm"]}),
        )
    },
    "yielding punches": {
        **SCENE,
        "asperities": {**_DRAWN, "count": 20, "shape": "flat_punch", "radius": "2 um"},
        "plasticity": {"hardness": "1 MPa"},
    },
    "a surface": {
        **SCENE,
        "asperities": {"source": "surface", "file": "map.nc", "shape": "paraboloid", "model": "summits"},
        "batch": {},
    },
    "a surface of plain numbers": {
        **SCENE,
        "asperities": {
            "source": "surface", "file": "map.npz", "size": ["10 um", "10 um"], "unit": "nm", "channel": "height",
            "outliers": "undefined", "detrend": "plane", "periodic": False, "cutoff": "1 um",
        },
        "batch": {},
    },
    "a load held": {
        **SCENE,
        "path": {"force": {"start": "0 N", "stop": "1 uN", "steps": 9}, "unload": True, "hold": 2},
    },
    **{
        f"a body: {', '.join(body)}": {
            **{key: value for key, value in SCENE.items() if key != "adhesion"},
            "asperities": {**ASPERITIES, "radius": "50 um"},  # one radius: its integrals take a hundredth of the time
            "nominal": {**body, "error": 1e-2},
            "path": {"separation": ["1 sigma", "0.5 sigma"]},
            "batch": {"estimator": "expected"},
            "output": {"derivatives": ["material.modulus"]},
        }
        for body in (
            {"radius": "10 mm"},
            {"shape": "capped_paraboloid", "radius": "5 mm", "cap_radius": "10 mm", "blend_radius": "0.1 mm"},
            {"shape": "rounded_punch", "flat_radius": "0.2 mm", "edge_radius": "10 mm"},
            {"shape": "power_law", "exponent": 3.0, "width": "1 mm", "rise": "50 um"},
            {"shape": "power_law", "exponent": 3.0, "coefficient": 5e4},
        )
    },
    "lateral cycles": {
        **{key: value for key, value in SCENE.items() if key != "adhesion"},
        "material": {"effective_modulus": "4 MPa"},
        "tangential": {"friction": 0.3, "stiffness_ratio": 0.8},
        "path": {"separation": "1 sigma", "lateral": {"amplitude": "5 nm", "cycles": 2, "steps": 9}},
    },
}  # fmt: skip
HELD = ("separation", "force", "pressure")  # whose single values need path.lateral, which no schema tells
MAY_BE_NEGATIVE = ("poisson", "start", "stop", "mean", "min", "max", "loc", "height", "at_separation", *HELD)
NONSENSE: dict[str, object] = {
    "unit": "3 parsec",
    "no number": "three",
    "list": [],
    "table": {"a": 1},
    "truth": True,
    "nan": float("nan"),
    "inf": float("inf"),
    "-inf": float("-inf"),
}


class Mutation(NamedTuple):
    """A scene with one thing wrong."""

    base: str
    key: str
    """That is at fault."""
    what: str
    table: dict[str, Any]

    def __str__(self) -> str:
        return f"{self.base}-{self.key}-{self.what}"


def value_of(table: dict[str, Any], key: str) -> Any:
    for part in key.split("."):
        table = table.get(part, {}) if isinstance(table, dict) else {}
    return table


def paths(table: dict[str, Any], at: str = "") -> Iterator[str]:
    """Every key and table of a scene."""
    for key, value in table.items():
        if key != "sweep":
            yield f"{at}{key}"
            if isinstance(value, dict):
                yield from paths(value, f"{at}{key}.")


def mutated(base: str, key: str, what: str, value: object) -> Mutation:
    table = copy.deepcopy(BASES[base])
    set_key(table, key, value)
    return Mutation(base, key, what, table)


def misspelt(base: str, key: str) -> Mutation:
    table = copy.deepcopy(BASES[base])
    *outer, last = key.split(".")
    inner = table
    for part in outer:
        inner = inner[part]
    wrong = last[:-2] + last[:-3:-1] + "x"
    inner[wrong] = inner.pop(last)
    return Mutation(base, ".".join([*outer, wrong]), "misspelt", table)


def _mutations() -> Iterator[Mutation]:
    for base, table in BASES.items():
        for key in paths(table):
            value = value_of(table, key)
            has_line = not isinstance(value, dict) or any(not isinstance(each, dict) for each in value.values())
            if has_line and not key.startswith("asperities.terms."):
                yield misspelt(base, key)
        for key, reader in key_readers([Scene], table):
            if value_of(table, key) == {}:
                continue
            if not reader.dimension:
                yield mutated(base, key, "no name", 5)
                if key not in ("title", "asperities.channel"):  # any title will do; channels are the file's to name
                    yield mutated(base, key, "unknown name", "nonsens")
                continue
            for what, wrong in NONSENSE.items():
                if (key, what) != ("path.separation.stop", "table"):  # which may be one
                    yield mutated(base, key, what, wrong)
            yield mutated(base, key, "wrong dimension", "3 MPa" if reader.dimension != "Pa" else "3 um")
            negative = key.rpartition(".")[2] in MAY_BE_NEGATIVE or key.startswith("asperities.correlation.")
            if not negative or key == "asperities.radius.mean":
                yield mutated(base, key, "negative", -1)
        yield mutated(base, "path.unload", "no truth", "yes")
    base = "every section"
    yield mutated(base, "output.variables", "no list", "force")
    for key, value in (("mode", "zap"), ("adhesion.wrok", [1]), ("adhesion.work", ["5 m"]), ("asperities.count", [0])):
        table = copy.deepcopy(BASES[base])
        table["sweep"] = {**table["sweep"], key: value}
        yield Mutation(base, f"sweep.{key}", "sweep", table)


@cache
def mutations() -> list[Mutation]:
    """All scenes with one thing wrong; made when they are needed, since every process of the tests reads this file."""
    return list(_mutations())


FEW = ("every section", "pairwise", "cones", "independent", "a surface", "a load held", "preload", "viscoelastic")
FEW_AND_ALL = [base if base in FEW else large(base) for base in BASES]
"""Kinds of scenes, of which the first few have nearly every key."""


def declared(section: type[BaseModel], at: str = "") -> Iterator[str]:
    """Every key that the sections declare, but those of the entries of a list."""
    for name, field in section.model_fields.items():
        yield f"{at}{name}"
        for inner in sections_of(field.annotation) if get_origin(field.annotation) is not list else ():
            yield from declared(inner, f"{at}{name}.")


def line_of(text: str, key: str) -> int:
    """The line of a key in what tomli_w writes: a table has a header, anything else a line in its table."""
    here = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("["):
            here = line.strip("[]").replace('"', "")
        name = line.partition(" = ")[0].replace('"', "")
        if key in (here, f"{here}.{name}" if here else name):
            return number
    raise AssertionError(f"{key} is not in the text")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("mutations")
    x = np.linspace(0.0, 1e-5, 40)
    waves = 1e-7 * np.outer((1.0 + 1e5 * x) * np.cos(2e6 * x), np.cos(2e6 * x))
    xr.Dataset({"height": (("x", "y"), waves)}, coords={"x": x, "y": x}).to_netcdf(made / "map.nc")
    np.savez(made / "map.npz", height=1e9 * waves)
    return made


def refused(folder: Path, text: str | bytes) -> str:
    """The message of a run that must be refused."""
    scene = folder / "scene.toml"
    scene.write_bytes(text if isinstance(text, bytes) else text.encode())
    before = sorted(path.name for path in folder.iterdir())
    done = CliRunner().invoke(main, ["run", str(scene), "-o", str(folder / "out.nc")])
    assert done.exit_code == 2, (done.output, done.exception)
    assert "Traceback" not in done.output
    assert isinstance(done.exception, SystemExit)
    assert sorted(path.name for path in folder.iterdir()) == before
    return done.output


def test_the_bases_are_right_and_have_every_key_of_the_schema(folder: Path) -> None:
    known = {key for table in BASES.values() for key in paths(table)} | {"sweep"}
    assert {first(key) for key in declared(Scene)} == {first(key) for key in known if value_is_declared(key)}
    assert len(mutations()) > 400
    for table in BASES.values():
        with contextlib.chdir(folder):
            read(table)


@pytest.mark.large
def test_the_bases_can_be_run(folder: Path) -> None:
    for table in BASES.values():
        with contextlib.chdir(folder):
            assert make_plan(read(table)).cells


def first(key: str) -> str:
    """A key of the second population, or of the correlation, as that of the first population that it repeats."""
    return key.replace("asperities.second.", "asperities.").replace("asperities.correlation.", "asperities.")


def value_is_declared(key: str) -> bool:
    """Whether a key stands in the schema itself, and not in the table of a distribution."""
    return not any(first(key).startswith(f"asperities.{name}.") for name in ("height", "radius", "terms"))


@pytest.mark.large
@pytest.mark.parametrize("base", FEW_AND_ALL)
def test_one_thing_wrong_is_refused_at_its_line(folder: Path, base: str) -> None:
    for mutation in [each for each in mutations() if each.base == base]:
        text = tomli_w.dumps(mutation.table)
        output = refused(folder, text)
        lines = [line for line in output.splitlines() if f"scene.toml:{line_of(text, mutation.key)}: " in line]
        assert any(mutation.key in line for line in lines), (str(mutation), output)


def test_one_thing_wrong_is_refused_at_its_key(folder: Path) -> None:
    for mutation in [each for each in mutations() if each.base == "every section"]:
        with contextlib.chdir(folder), pytest.raises(SceneError) as refused:
            read(mutation.table)
        assert any(mutation.key in str(fault) for fault in refused.value.faults), str(mutation)


SPELLINGS: dict[str, Callable[[str], str]] = {
    "in capitals": str.upper,
    "with a capital": str.capitalize,
    "with a blank": " {}".format,
    "with a blank behind": "{} ".format,
    "with a hyphen": lambda key: key.replace("_", "-"),
}
KEYS = sorted(
    {part for key in declared(Scene) for part in key.split(".")}
    | {"distribution", "mean", "std", "loc", "scale", "min", "max", "mode", "linspace", "logspace", "num", "s", "c"}
)


def tables(base: str) -> list[str]:
    """The tables of a scene, the whole among them."""
    return ["", *(key for key in paths(BASES[base]) if isinstance(value_of(BASES[base], key), dict))]


def with_key(base: str, at: str, key: str) -> dict[str, Any]:
    table = copy.deepcopy(BASES[base])
    (value_of(table, at) if at else table).setdefault(key, "1 um")
    return table


def assert_no_hint_suggests_what_was_given(folder: Path, table: dict[str, Any]) -> None:
    with contextlib.chdir(folder):
        try:
            read(table)
        except SceneError as error:
            for fault in error.faults:
                meant = re.findall("'([^']*)'", fault.message.partition("did you mean")[2])
                assert not {fault.key, fault.key.rpartition(".")[2], fault.value.strip("'")} & set(meant), fault


@pytest.mark.few(1)
@pytest.mark.parametrize(("base", "at"), [(base, at) for base in ("every section", "moments") for at in tables(base)])
def test_no_hint_suggests_a_key_that_stands_elsewhere(folder: Path, base: str, at: str) -> None:
    for key in KEYS:
        assert_no_hint_suggests_what_was_given(folder, with_key(base, at, key))


@settings(deadline=None, max_examples=150)
@given(base=st.sampled_from(sorted(BASES)), spelt=st.sampled_from(sorted(SPELLINGS)), data=st.data())
def test_no_hint_suggests_what_is_spelt_otherwise(folder: Path, base: str, spelt: str, data: st.DataObject) -> None:
    names = [key for key in paths(BASES[base]) if isinstance(value_of(BASES[base], key), str)]
    if data.draw(st.booleans()):
        at, key = data.draw(st.sampled_from(tables(base))), data.draw(st.sampled_from(KEYS))
        table = with_key(base, at, SPELLINGS[spelt](key))
    else:
        table, key = copy.deepcopy(BASES[base]), data.draw(st.sampled_from(names))
        set_key(table, key, SPELLINGS[spelt](value_of(table, key)))
    assert_no_hint_suggests_what_was_given(folder, table)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "material: is missing"),
        (b"[material\n", "not valid TOML: .*line 1"),
        (b"seed = 1\nseed = 2\n", "not valid TOML: .*line 2"),
        (b"a = '''", "not valid TOML"),
        (bytes(range(256)), "not a text file"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100), "a netCDF file, but no result of roughmdr"),
        (b"CDF\x01" + bytes(100), "a netCDF file, but no result of roughmdr"),
        (b"x" * 100_000, "not valid TOML"),
        (b"a = " + b"[" * 5000, "not valid TOML"),
    ],
)
def test_what_is_no_scene_is_refused(folder: Path, content: bytes, says: str) -> None:
    assert re.search(says, refused(folder, content))
