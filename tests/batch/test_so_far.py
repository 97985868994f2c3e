"""The law so far of a batch that is not over: the same numbers as a result of the same runs has."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from batches import Batch, interrupted, running, slow_scene, write_scene
from command import said
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.resume import kept as module
from roughmdr.batch.resume.kept import Kept, LawSoFar, SoFar, progress_of

FEW = {**ASPERITIES, "count": 50}


def law_of(folder: Path) -> LawSoFar:
    kept = Kept(folder)
    law = SoFar(progress_of(kept)).law(kept)
    assert law is not None
    return law


def check(law: LawSoFar, table: dict[str, Any], **cell: int) -> None:
    """A result of the same number of runs has the same mean and standard error."""
    whole = rm.run({**table, "batch": {**table["batch"], "realizations": law.moments.size}}).isel(cell)
    found = whole if f"{law.variable}_mean" in whole else whole.roughmdr.statistics()
    for name, values in (("mean", law.moments.mean), ("sem", law.moments.standard_error)):
        expected = found[f"{law.variable}_{name}"].to_numpy()
        np.testing.assert_allclose(values, expected[law.steps], rtol=1e-12, atol=1e-13 * np.abs(expected).max())


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"output": {"keep": "statistics"}},
        {"path": {"force": ["1 uN", "5 uN", "10 uN"]}},
        {"output": {"variables": ["contact_count"]}, "path": {"separation": ["1 um"]}},
    ],
)
def test_it_is_the_law_of_the_runs_that_are_kept(
    changes: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = scene(**{"asperities": FEW, "batch": {"realizations": 12}, **changes})
    interrupted(table, tmp_path / "out.nc", 3, monkeypatch)
    law = law_of(tmp_path / "out.nc.parts")
    assert law.moments.size == 6
    check(law, table)


@pytest.mark.large
def test_of_a_sweep_the_first_cell_is_told_and_each_of_its_files_is_read_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    swept = {"adhesion.work": ["1 mJ/m^2", "50 mJ/m^2"]}
    table = scene(asperities=FEW, batch={"realizations": 4}, sweep=swept, path={"separation": ["2 um", "1 um"]})
    folder = tmp_path / "out.nc.parts"
    interrupted(table, tmp_path / "out.nc", 1, monkeypatch)
    law = SoFar(progress_of(Kept(folder)))
    read = []
    reader = module.read_task_result
    monkeypatch.setattr(module, "read_task_result", lambda *file: read.append(file[1]) or reader(*file))
    first = law.law(Kept(folder))
    assert first is not None
    assert (first.cell, first.moments.size) == (0, 2)
    interrupted(table, tmp_path / "out.nc", 2, monkeypatch)
    second = law.law(Kept(folder))
    assert second is not None
    assert second.moments.size == 4
    check(second, table, adhesion_work=0)
    assert read == sorted(set(read)) == ["000001.npz", "000002.npz"]  # and the third is of another cell
    told = said("info", folder)
    assert re.search(r"^law so far   mean force over 4 runs, adhesion\.work = 1 mJ/m\^2$", told, re.MULTILINE)
    assert re.search(r"^ {13}\S+ ± \S+ [um]N at separation 1 um, loading$", told, re.MULTILINE)
    written = json.loads(said("info", folder, "--json"))["parts"]["law"]
    assert written == {
        "swept": {"adhesion_work": 0.001},
        "variable": "force",
        "runs": 4,
        "control": "separation",
        "values": [2e-6, 1e-6],
        "mean": second.moments.mean.tolist(),
        "standard_error": second.moments.standard_error.tolist(),
    }
    for limit in ({"_FILES": 1}, {"_AT_ONCE": 0}):
        with monkeypatch.context() as patch:
            patch.setattr(module, *limit.popitem())
            assert "law so far   mean force over 2 of 4 runs, " in said("info", folder)


def test_files_that_vanish_or_are_damaged_do_not_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = scene(asperities=FEW, batch={"realizations": 12}, path={"separation": ["2 um", "1 um"]})
    folder = tmp_path / "out.nc.parts"
    interrupted(table, tmp_path / "out.nc", 4, monkeypatch)
    (folder / "000002.npz").unlink()
    (folder / "000003.npz").write_bytes(b"PK")
    assert law_of(folder).moments.size == 4
    monkeypatch.setattr(module, "_FILES", 1)
    kept = Kept(folder)
    law = SoFar(progress_of(kept))
    assert [each.moments.size for _ in range(4) if (each := law.law(kept))] == [2, 2, 2, 4]
    manifest = folder / "manifest.jsonl"
    manifest.write_text(manifest.read_text().replace("roughmdr 0", "roughmdr 9"))
    kept = Kept(folder)
    assert SoFar(progress_of(kept)).law(kept) is None
    assert "law so far" not in said("info", folder)


@pytest.mark.large
def test_a_batch_that_was_killed(tmp_path: Path) -> None:
    folder, table = tmp_path / "batch", slow_scene(96, count=2000)
    write_scene(folder, table)
    with running(Batch(folder, "--workers", "1")) as batch:
        batch.wait_for_lines(5)
        batch.kill()
    check(law_of(folder / "out.nc.parts"), table)
