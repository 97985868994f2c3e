"""Each cell of a sweep is the run of its own scene, bit for bit, whichever key of whichever kind of scene is swept."""

import copy
from typing import Any

import numpy as np
import pytest
from forms import large
from pydantic import create_model
from scenes import ASPERITIES, CONDUCTION, scene

from roughmdr.batch.plan import make_plan
from roughmdr.errors import SceneError
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from roughmdr.scene.identity import LAYOUT, Digests
from roughmdr.scene.json_schema import scene_schema
from roughmdr.scene.keys import key_readers, set_key
from roughmdr.scene.separation import Separation
from roughmdr.scene.sweep import may_be_swept
from roughmdr.schema.section import Section
from roughmdr.shapes import SHAPES
from roughmdr.storage.labelled import Array, Labelled

VARIED: dict[str, Any] = {**ASPERITIES, "count": 12, "patch": "0.2 mm"}
FEW = {**VARIED, "radius": "50 um"}
SPREAD = {"distribution": "normal", "mean": 1e-7, "std": 1e-6, "min": -3e-6, "max": 3e-6}
EVERY_KEY = {
    **VARIED,
    "placement": "hard_core",
    "min_distance": 1e-6,
    "height": SPREAD,
    "second": {"share": 0.3, "height": {"distribution": "uniform", "loc": -1e-6, "scale": 3e-6}},
    "correlation": {"radius": 0.4},
}
WAVES = {"hurst": 0.8, "long_wave": 5e-5, "short_wave": 2e-5, "rms_height": 1e-6}
CLEAR, TO_PRESSURE, TO_FRACTION = (
    {"separation": {"start": "clear", "stop": stop, "steps": 6}}
    for stop in ("0.5 sigma", {"pressure": 2e3}, {"contact_fraction": 5e-3})
)
RANGE = {"separation": {"start": 3e-6, "stop": 5e-7, "steps": 6}, "unload": True}
LATERAL = {"amplitude": 2e-8, "steps": 6}
DUGDALE = {"model": "dugdale", "work": 0.02}
EXPECTED = {"estimator": "expected"}
FRICTION = {"friction": 0.4}
HARD = {"modulus": "3 MPa", "poisson": 0.49, "hardness": 2e5}


def elastic(**changes: Any) -> dict[str, Any]:
    """A scene of a few asperities and steps, without adhesion unless that is given."""
    return scene(**{"adhesion": None, "asperities": FEW, "path": RANGE, "batch": {"realizations": 2}, **changes})


def curved(**body: Any) -> dict[str, Any]:
    """A curved body that begins clear of adhesive asperities."""
    adhesive = {"adhesion": {"model": "jkr", "work": 0.05}, "output": {"variables": ["force"]}, "batch": EXPECTED}
    path = {"separation": {"stop": 1e-6, "steps": 3}}
    return elastic(**adhesive, path=path, nominal={**body, "error": 1e-2})


LONG = ("pairwise", "effective", "viscoelastic", "mean field")
KINDS: dict[str, dict[str, Any]] = {
    "independent": elastic(asperities=EVERY_KEY, counter={"modulus": 1e7, "poisson": 0.3}),
    "density": elastic(asperities={**{k: v for k, v in FEW.items() if k != "count"}, "density": 3e8}, path=CLEAR),
    "effective": elastic(material={"effective_modulus": 3e6}, path=TO_PRESSURE, accuracy={"relative": 0.5}, batch=None),
    "jkr": elastic(adhesion={"model": "jkr", "work": 0.02}, path=CLEAR, asperities=VARIED, material=HARD),
    "dugdale": elastic(adhesion={**DUGDALE, "strength": 1e6}, path=CLEAR),
    "range": elastic(adhesion={"model": "auto", "work": 0.02, "range": 2e-8, "error": 0.01}, path=CLEAR),
    "pairwise": elastic(
        asperities={**FEW, "placement": "random"},
        interaction={"model": "pairwise", "boundary": "periodic", "order": 1, "error": 1e-5, "beyond": "flag"},
        path=TO_FRACTION,
    ),
    "lattice": elastic(
        asperities={**{k: v for k, v in FEW.items() if k != "count"}, "placement": "square", "pitch": 1.9e-5},
        interaction={"model": "mean_field"},
        path=CLEAR,
    ),
    "mean field": elastic(interaction={"model": "mean_field"}, path=TO_PRESSURE, batch=EXPECTED),
    "conduction": elastic(
        conduction={**CONDUCTION, "counter_conductivity": 20.0},
        output={"variables": ["thermal_conductance", "electrical_conductance"]},
        path=RANGE,
    ),
    "yielding": elastic(
        material={"modulus": "3 MPa", "poisson": 0.4},
        plasticity={"yield_strength": 2e4, "model": "mdr"},
    ),
    "yielding spheres": elastic(
        material={"modulus": "3 MPa", "poisson": 0.4}, plasticity={"hardness": 6e4, "body": "sphere"}
    ),
    "yielding cones": elastic(
        asperities={**{k: v for k, v in FEW.items() if k != "radius"}, "shape": "cone", "slope": 0.1},
        material={"modulus": "3 MPa", "poisson": 0.4},
        plasticity={"yield_strength": 2e4},
    ),
    "viscoelastic": elastic(
        viscoelastic={
            "relaxation": [{"time": 1.0, "share": 0.5}], "speed": 1e-6, "retraction_speed": 2e-6, "dwell": 1.0,
        },
        path=RANGE,
    ),
    "sticking": elastic(
        material={"effective_modulus": 3e6},
        tangential={"stiffness_ratio": 0.8},
        output={"variables": ["tangential_stiffness"]},
        path=RANGE,
    ),
    "slip at a separation": elastic(tangential=FRICTION, path={"separation": "0.5 um", "lateral": LATERAL}),
    "slip at a force": elastic(tangential=FRICTION, path={"force": 1e-4, "lateral": LATERAL}),
    "slip at a pressure": elastic(
        tangential=FRICTION, path={"pressure": 2e3, "lateral": {"start": 1e-9, "stop": 2e-8, "steps": 6}}
    ),
    "force": elastic(path={"force": {"start": 1e-6, "stop": 1e-4, "steps": 6}}),
    "pressure": elastic(
        path={"pressure": {"start": 1.0, "stop": 2e3, "steps": 6}}, interaction={"model": "mean_field"}
    ),
    "remote": elastic(
        path={"remote": {"start": 3e-6, "stop": 1e-7, "steps": 6}, "machine_stiffness": 100.0, "unload": True},
        adhesion={"model": "jkr", "work": 0.02},
    ),
    "preload": elastic(path={"preload": 1e-4, "machine_stiffness": 100.0, "steps": 6, "unload": True}),
    "preload pressure": elastic(path={"preload_pressure": 2e3, "steps": 6}),
    "preload fraction": elastic(path={"preload_contact_fraction": 5e-3, "steps": 6}),
    "curved paraboloid": curved(radius=1e-3),
    "curved cone": curved(shape="rounded_cone", slope=0.01, blend_radius=1e-5),
    "nayak": elastic(asperities={"source": "nayak", "patch": 2e-4, **WAVES}, path=CLEAR),
    "moments": elastic(
        asperities={"source": "nayak", "patch": 1e-4, "m0": 1e-12, "m2": 1e-2, "m4": 4e8}, path=RANGE
    ),
    "spectrum": elastic(
        asperities={
            **{**WAVES, "rms_height": None, "rms_slope": 0.1},
            **{"source": "spectrum", "model": "summits", "patch": 1e-4, "points": 6.0, "anisotropy": 1.1},
        },
        path=RANGE,
    ),
    "reference": elastic(
        asperities={"source": "spectrum", "model": "summits", "patch": 1e-4, **WAVES},
        reference={"model": "boundary_elements", "error": 0.3},
        path={"separation": [2e-6, 1.5e-6]},
        batch=None,
    ),
}  # fmt: skip
NAMES = {
    "plasticity.model": "jackson-green",
    "plasticity.body": "half-space",
    "asperities.placement": "hexagonal",
    "asperities.model": "hills",
    "interaction.boundary": "free",
    "interaction.beyond": "boundary_elements",
    "adhesion.model": "auto",
    "asperities.height.distribution": "uniform",
    "interaction.model": "pairwise",
}
"""Another name for keys that take one."""


def entry_of(table: Any, key: str) -> Any:
    """Return the entry at a dotted key; None where there is none."""
    for part in key.split("."):
        table = table.get(part) if isinstance(table, dict) else None
    return table


def with_entry(table: dict[str, Any], key: str, entry: Any) -> dict[str, Any]:
    changed = copy.deepcopy(table)
    set_key(changed, key, entry)
    return changed


def other_entries(key: str, entry: Any, reader: Any) -> list[Any]:
    """Return entries that differ from one, the next preferred to those after it."""
    if not reader.dimension:
        return [name for name in (NAMES.get(key),) if name not in (entry, None)]
    read_entry = getattr(reader(entry), "constant", reader(entry))
    if read_entry is None:  # "clear"
        return []
    if isinstance(read_entry, Separation):
        return [f"{read_entry.value * 0.9} sigma"] if read_entry.in_sigma else [read_entry.value * 0.9]
    if isinstance(read_entry, int):
        return [read_entry + 1, read_entry - 1]
    return [read_entry * 1.1, read_entry * 0.9]


def swept_keys(table: dict[str, Any]) -> dict[str, list[Any]]:
    """Return the keys that a scene gives and that can be swept, each with its entry and another one that is valid."""
    found = {}
    for key, reader in key_readers([Scene], table):
        entry = entry_of(table, key)
        if not may_be_swept(key) or isinstance(entry, dict | list | None):
            continue
        for other in other_entries(key, entry, reader):
            try:
                read(with_entry(table, key, other))
            except SceneError:
                continue
            found[key] = [entry, other]
            break
    return found


def computed(table: dict[str, Any]) -> Labelled:
    result = execute(make_plan(read(table)), None)
    assert result.variables.keys().isdisjoint(result.coordinates)
    return result


def assert_same_bits(swept: Labelled, cell: int, alone: Labelled) -> None:
    (dim,) = (name for name in swept.sizes if name not in alone.sizes)

    def of_cell(array: Array) -> Any:
        return array.values.take(cell, array.dims.index(dim)) if dim in array.dims else array.values

    arrays, lone = swept.variables | swept.coordinates, alone.variables | alone.coordinates
    for name in lone.keys() - {"run_time"}:
        np.testing.assert_array_equal(of_cell(arrays[name]), lone[name].values, err_msg=f"{dim}: {name}")


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", [large(kind) if kind in LONG else kind for kind in KINDS])
@pytest.mark.filterwarnings("ignore")
def test_a_cell_is_its_scene_alone(kind: str) -> None:
    table = KINDS[kind]
    first = computed(table)
    for key, entries in swept_keys(table).items():
        swept = computed({**table, "sweep": {key: entries}})
        assert_same_bits(swept, 0, first)
        assert_same_bits(swept, 1, computed(with_entry(table, key, entries[1])))
        assert len(set(swept.coordinates["cell_key"].values)) == 2


def one_of_its_kind(key: str) -> str:
    """Return a key with one name in place of those of shape parameters, populations and quantities that are drawn."""
    section, *inner = key.removeprefix("asperities.second.").removeprefix("asperities.").split(".")
    if key.startswith("asperities."):
        inner = ["parameter"] if section == "correlation" else inner
        section = "parameter" if section in {name for shape in SHAPES.values() for name in shape.units} else section
        drawn = section in ("parameter", "height")
        return f"asperities.{'.'.join(['drawn', *inner] if drawn else [section, *inner])}"
    last = key.rsplit(".", maxsplit=1)[-1]
    return "nominal.parameter" if section == "nominal" and last not in ("shape", "error") else key


OF_FILES = {f"asperities.{name}" for name in ("file", "size", "unit", "channel", "detrend", "cutoff", "outliers")}
"""Keys of maps and saved ensembles, which have tests of their own."""
OTHER_KEYS = {"asperities.source", "asperities.shape", "nominal.shape"}
"""Keys that other keys go with, so that hardly any scene stays valid with another name."""


def test_every_kind_of_key_that_can_be_swept_is_among_them() -> None:
    can_be = {key for key in scene_schema()["properties"]["sweep"]["properties"] if may_be_swept(key)}
    covered = {one_of_its_kind(key) for table in KINDS.values() for key in swept_keys(table)}
    assert {one_of_its_kind(key) for key in can_be if "." in key} - covered == OF_FILES | OTHER_KEYS


class Weather(Section):
    """A section that nobody thought of."""

    humidity: float


def test_a_section_that_nobody_thought_of_is_in_the_digest() -> None:
    extended = create_model("Extended", __base__=Scene, weather=(Weather | None, None))
    scenes = [extended.of({**elastic(), "weather": entry}, None) for entry in (None, {"humidity": 1}, {"humidity": 2})]
    assert len({Digests().of(each) for each in scenes}) == 3


def test_the_layout_of_a_result_is_not_in_the_digest() -> None:
    digests, table = Digests(), elastic()
    other = {"title": "Another", "output": {"variables": ["force"]}, "batch": {"realizations": 9}}
    more = {**table, **other, "accuracy": {"relative": 0.1}}
    assert other.keys() | {"accuracy", "sweep"} == set(LAYOUT)
    assert digests.of(read(table)) == digests.of(read(more))
