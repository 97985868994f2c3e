"""Scenes: read with units and defaults; every fault found at once, by file, line, key, value and what is allowed."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from scenes import SCENE, scene

import roughmdr as rm
from roughmdr.scene import read

SCENES = Path(__file__).parents[2] / "pipelines" / "scenes"


def faults(source: Any, *changes: str) -> list[str]:
    with pytest.raises(rm.SceneError) as caught:
        read(source, changes)
    return str(caught.value).splitlines()


def test_the_scene_of_the_demo() -> None:
    demo = read(SCENES / "rubber_on_glass.toml")
    assert demo.title == "Rubber on rough glass"
    assert demo.seed == 2026
    assert demo.effective_modulus == rm.effective_modulus(3e6, 0.49)
    assert demo.work == 0.05
    assert demo.batch.realizations == 8
    assert demo.interaction is not None
    assert demo.path.starts_clear
    assert demo.path.target is not None
    assert demo.path.target.contact_fraction == 0.03
    np.testing.assert_allclose(demo.path.values(0.0, 7e-6, 1e-6), np.linspace(7e-6, 1e-6, 200), rtol=1e-15)


def test_defaults(tmp_path: Path) -> None:
    table = scene(title=None, seed=None, batch=None, adhesion=None, path={"separation": ["1 sigma", 0, "-1 um"]})
    (tmp_path / "mine.toml").write_text(tomli_w.dumps(table))
    plain = read(tmp_path / "mine.toml")
    assert plain.title == "mine"
    assert (plain.seed, plain.work, plain.batch.realizations, plain.path.unload) == (0, 0.0, 1, False)
    assert plain.output.variables == ["force", "contact_area", "contact_count", "stiffness"]
    np.testing.assert_array_equal(plain.path.values(2e-6), [2e-6, 0.0, -1e-6])


@pytest.mark.parametrize(
    "path",
    [
        {"separation": {"stop": {"pressure": "1 kPa"}, "steps": 9}},
        {"force": {"stop": "1 uN", "steps": 9}},
        {"pressure": {"stop": "1 Pa", "steps": 9}},
        {"remote": {"stop": "1 sigma", "steps": 9}, "machine_stiffness": "1 kN/m"},
    ],
)
def test_a_scene_is_the_same_when_it_was_pickled(path: dict[str, Any]) -> None:
    given = read(scene(path=path, interaction={"model": "pairwise"}))
    again = pickle.loads(pickle.dumps(given))
    assert (again.path, again.interaction) == (given.path, given.interaction)


def test_both_bodies_count() -> None:
    both = read(scene(counter={"modulus": "1 GPa", "poisson": 0.3}))
    assert both.effective_modulus == rm.effective_modulus(3e6, 0.49, 1e9, 0.3)
    assert read(scene(material={"effective_modulus": "4 MPa"})).effective_modulus == 4e6


def test_changes_are_toml_or_strings() -> None:
    asked = read(SCENE, ["adhesion.work=10 mJ/m^2", "asperities.count=5", "title=Mine", 'path.separation=["1 um", 0]'])
    assert (asked.work, asked.asperities.count, asked.title) == (0.01, 5, "Mine")
    assert asked.path.values(1.0).tolist() == [1e-6, 0.0]
    assert "count = 5" in asked.toml
    assert read(asked).toml == asked.toml
    assert SCENE["asperities"]["count"] == 1000


def test_paths_are_relative_to_the_scene_and_in_set_to_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "scenes"
    (folder / "maps").mkdir(parents=True)
    for file in (folder / "maps" / "a.nc", tmp_path / "b.nc"):
        file.touch()
    table = scene(asperities={"source": "surface", "file": "maps/a.nc"}, batch=None)
    (folder / "s.toml").write_text(tomli_w.dumps(table))
    monkeypatch.chdir(tmp_path)
    assert read("scenes/s.toml").asperities.file == str(folder / "maps" / "a.nc")
    assert read("scenes/s.toml", ["asperities.file=b.nc"]).asperities.file == str(tmp_path / "b.nc")


def test_all_faults_are_found_at_once_with_their_lines(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(
        'titel = "x"\n'
        "[material]\n"
        'modulus = "3 mm"\n'
        "poisson = 0.7\n"
        "[asperities]\n"
        'source = "random"\n'
        'shape = "paraboloid"\n'
        "count = 10\n"
        'patch = "1 mm"\n'
        'hieght = { distribution = "normal", std = "1 um" }\n'
        'radius = { distribution = "lognormal", mean = "50 um", std = "5 Pa" }\n'
        "[path]\n"
        'separation = { start = "4 sigma", stp = 0, steps = 1 }\n'
        "[sweep]\n"
    )
    found = faults(path)
    expected = [
        ":1: titel: unknown key; did you mean 'title'?",
        ":3: material.modulus = '3 mm': 'mm' is a unit of m; expected a unit of Pa",
        ":4: material.poisson = 0.7: must be at most 0.5",
        ":5: asperities.height: is missing",
        ":10: asperities.hieght: unknown key; did you mean 'height'?",
        ":11: asperities.radius.std = '5 Pa': 'Pa' is a unit of Pa; expected a unit of m",
        ":13: path.separation.stop: is missing",
        ":13: path.separation.stp: unknown key; did you mean 'stop'?",
        ":13: path.separation.steps = 1: must be from 2",
        ":14: sweep: names no key to sweep",
    ]
    for text in expected:
        assert sum(text in line for line in found) == 1, (text, found)
    assert len(found) == len(expected)
    assert all(line.startswith(str(path)) for line in found)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"material": 3}, "material = 3: must be a table"),
        ({"material": {"modulus": "3 MPa"}}, "needs effective_modulus, or modulus and poisson"),
        ({"material": {"effective_modulus": 1, "poisson": 0.3}}, "takes effective_modulus alone"),
        ({"material": {"effective_modulus": 1}, "counter": {"modulus": 1, "poisson": 0}}, "counter: does not go"),
        ({"adhesion": {"model": "maugis", "work": 1}}, "adhesion.model = 'maugis': not available; it can be jkr, dug"),
        ({"adhesion": {"model": "jkr", "work": -1}}, "adhesion.work = -1: must be at least 0"),
        ({"path": {"separation": 3}}, "path.separation = 3: must be a table with start, stop and steps, or a list"),
        ({"path": {"separation": []}}, "path.separation"),
        ({"path": {"separation": ["1 sgima"]}}, r"path.separation\[0\] = '1 sgima': unknown unit 'sgima'"),
        ({"path": {"separation": [0], "unload": "maybe"}}, "path.unload"),
        ({"output": {"variables": ["forc"]}}, r"output.variables\[0\] = 'forc': no such variable; there are force"),
        ({"output": {"variables": ["separation"]}}, r"output.variables\[0\] = 'separation': not to be asked for"),
        ({"output": {"variables": ["reference_stiffness"]}}, r"\[reference\] adds it to stiffness"),
        ({"output": {"variables": ["pull_off_force"]}}, "not to be asked for: every result that can have it holds it"),
        ({"output": {"variables": ["avalanche_count"]}}, "not to be asked for: every result that can have it holds it"),
        ({"output": {"variables": []}}, "output.variables"),
        ({"output": {"keep": "curve"}}, "output.keep = 'curve': not available; did you mean 'curves'"),
        ({"batch": {"realizations": 0}}, "batch.realizations = 0: must be from 1"),
        ({"batch": {"realizations": True}}, "batch.realizations = True: expected a whole number"),
        ({"seed": -1}, "seed = -1"),
        ({"convection": {"resistivity": 1.0}}, "convection: unknown key"),
        ({"asperities": {"source": "surface", "file": __file__}}, "batch.realizations: must be 1 with source"),
            ({"asperities": {"source": "surface", "file": "a.nc"}}, "asperities.file = '.*a.nc': no such file"),
            ({"path": {"separation": ["1e999 sigma"]}}, "expected a finite number"),
        ({"asperities": {"source": "surface"}, "batch": None}, "asperities.file: is missing"),
        ({"asperities": {}}, "asperities.source: is missing; it can be file, nayak, random, spectrum, surface"),
        ({"asperities": {**SCENE["asperities"], "height": "1 um"}}, "cannot be given in sigma: the heights' .* is 0 m"),
        (
            {"asperities": {**{k: v for k, v in SCENE["asperities"].items() if k != "radius"}, "shape": "power_law",
                            "exponent": 0.5, "coefficient": 1.0}},
            "asperities.exponent: 0.5 is too low; with adhesion it must be above 0.5",
        ),
    ],
)  # fmt: skip
def test_a_fault_names_key_and_remedy(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        read(scene(**changes))


def test_a_file_that_is_none_is_refused(tmp_path: Path) -> None:
    for path, says in ((tmp_path / "none.toml", "no such file"), (tmp_path, "is a folder; expected a file")):
        with pytest.raises(rm.SceneError, match=says):
            read(path)


@pytest.mark.parametrize("change", ["adhesion.work", "=3", "a..b=1", "seed.x=3"])
def test_a_change_that_is_none_is_refused(change: str) -> None:
    assert "--set" in faults(SCENE, change)[0]


def test_a_fault_in_a_change_is_placed_there() -> None:
    assert faults(SCENE, "adhesion.work=5 m")[0].startswith("--set: adhesion.work = '5 m': 'm' is a unit of m")


def test_a_path_beyond_all_floats_is_refused() -> None:
    with pytest.raises(rm.SceneError, match="largest float"):
        rm.run(scene(path={"separation": {"start": "1e308 m", "stop": "-1e308 m", "steps": 3}}))


def test_the_scene_of_a_sweep() -> None:
    asked = read(SCENES / "work_and_roughness.toml")
    assert asked.sweep.sizes == {"adhesion_work": 3, "asperities_height_std": 5}
    assert len(asked.cells) == 15
    assert asked.cells[1].asperities.sigma == pytest.approx(10.0**-6.5)


@pytest.mark.parametrize(
    ("shares", "allowed"), [([0.25, 0.75], True), ([1.0], True), ([0.0], True), ([0.5, 0.6], False)]
)
def test_all_of_the_modulus_may_relax_but_no_more(shares: list[float], allowed: bool) -> None:
    """A liquid in the end, as the shares of 1 together have it."""
    relaxation = [{"time": "1 s", "share": share} for share in shares]
    path = {"separation": {"start": "3 sigma", "stop": "1 sigma", "steps": 4}}
    table = scene(adhesion=None, path=path, viscoelastic={"relaxation": relaxation, "speed": "1 um/s"})
    if allowed:
        assert len(read(table).viscoelastic.relaxation) == len(shares)
    else:
        with pytest.raises(rm.SceneError, match=r"has shares of 1\.1 together; they must be at most 1"):
            read(table)


def test_a_target_is_one_of_contact_fraction_and_pressure() -> None:
    both = {"contact_fraction": 0.01, "pressure": "1 MPa"}
    for stop in ({"contact_fraction": 0.01}, {"pressure": "1 MPa"}):
        assert (
            read(scene(path={"separation": {"start": "clear", "stop": stop, "steps": 5}})).path.control == "separation"
        )
    for stop in ({}, both):
        with pytest.raises(rm.SceneError, match="either contact_fraction or pressure"):
            read(scene(path={"separation": {"start": "clear", "stop": stop, "steps": 5}}))
