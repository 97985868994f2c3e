"""Each cell of a sweep is the run of its own scene, bit for bit, whichever key of whichever kind of scene is swept."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from batches import assert_same, interrupted
from forms import large
from kinds import EXPECTED, KINDS, elastic
from pydantic import create_model

from roughmdr.batch.plan import make_plan
from roughmdr.errors import SceneError
from roughmdr.runner.backend import Backend
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

LONG = ("pairwise", "adhesive pairs", "effective", "viscoelastic", "mean field", "reference")
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
@pytest.mark.parametrize("kind", [large(kind) if kind in LONG else kind for kind in KINDS if "drawn" not in kind])
@pytest.mark.filterwarnings("ignore")
def test_a_cell_is_its_scene_alone(kind: str) -> None:
    table = KINDS[kind]
    first = computed(table)
    for key, entries in swept_keys(table).items():
        swept = computed({**table, "sweep": {key: entries}})
        assert_same_bits(swept, 0, first)
        assert_same_bits(swept, 1, computed(with_entry(table, key, entries[1])))
        assert len(set(swept.coordinates["cell_key"].values)) == 2


DRAWN = [kind for kind, table in KINDS.items() if table.get("batch") != EXPECTED and kind != "effective"]


@pytest.mark.few(2)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("kind", [large(kind) if kind in LONG else kind for kind in DRAWN])
@pytest.mark.filterwarnings("ignore")
def test_bits_depend_on_no_workers_no_tasks_and_no_end_before_the_end(
    kind: str, keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Some runs are in a file, others were computed when a run was interrupted."""
    out, table = tmp_path / "out.nc", copy.deepcopy(KINDS[kind])
    table["output"] = {**table.get("output", {}), "keep": keep}
    if "accuracy" not in table:
        execute(make_plan(read({**table, "batch": {"realizations": 2}})), out)
        table["batch"] = {"realizations": 7}
    plan = make_plan(read(table))
    at_once = execute(plan, None, Backend(workers=1, runs_per_task=1000)).to_xarray()
    assert_same(execute(plan, None, Backend(workers=2, runs_per_task=3)).to_xarray(), at_once)
    interrupted(table, out, 1, monkeypatch)
    assert_same(execute(plan, out, Backend(workers=3, runs_per_task=3)).to_xarray(), at_once)
    if keep == "statistics":
        curves = computed({**table, "output": {**table["output"], "keep": "curves"}}).to_xarray()
        for name in set(plan.scene.output.variables) - set(curves.coords):
            mean = curves[name].mean("realization")
            np.testing.assert_allclose(at_once[f"{name}_mean"], mean, rtol=1e-12, atol=1e-14 * np.abs(mean).max())


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
