"""Runs find at their output what is not their own: another result, files in the folder of its parts, odd results."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import interrupted
from click.testing import CliRunner
from scenes import scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.cli import main
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read
from roughmdr.storage.files import destination

FEW = {"source": "random", "shape": "paraboloid", "count": 20, "patch": "1 mm", "radius": "50 um"}
PATH = {"separation": {"start": "2 sigma", "stop": "0 sigma", "steps": 5}}


def few(**changes: Any) -> dict[str, Any]:
    asperities = {**FEW, "height": {"distribution": "normal", "std": "1 um"}}
    return scene(**{"asperities": asperities, "path": PATH, "batch": {"realizations": 6}, **changes})


FORCE_AND_AREA = {"variables": ["force", "contact_area"]}
OTHERS: dict[str, dict[str, Any] | None] = {
    "another scene": {"seed": 2},
    "more realisations": {"batch": {"realizations": 9}},
    "another variable": {"output": {"variables": ["energy"]}},
    "itself": {"output": FORCE_AND_AREA},
    "no result": None,
}


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("other", OTHERS)
def test_an_interrupted_fresh_run_goes_on_beside_the_file_that_it_replaces(
    keep: str, other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever file it is: --fresh was given to replace it."""
    out = tmp_path / "out.nc"
    changes = OTHERS[other]
    if changes is None:
        out.write_text("no result")
    else:
        rm.run(few(**changes), out)
    before = out.read_bytes()
    table = few(output={"keep": keep, **FORCE_AND_AREA})
    interrupted(table, out, 2, monkeypatch, resume=False)
    interrupted(table, out, 0, monkeypatch)
    assert out.read_bytes() == before
    done = execute(make_plan(read(table)), out, Backend(runs_per_task=2)).to_xarray()
    assert out.read_bytes() != before
    whole = rm.run(table)
    xr.testing.assert_identical(done.drop_vars("run_time").drop_attrs(), whole.drop_vars("run_time").drop_attrs())
    assert not destination(out).with_name("out.nc.parts").exists()


@pytest.mark.parametrize("later", ["another scene goes on", "another result is there"])
def test_an_interrupted_fresh_run_replaces_nothing_else(
    later: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, table = tmp_path / "out.nc", few(seed=2)
    rm.run(few(seed=1), out)
    interrupted(table, out, 2, monkeypatch, resume=False)
    if later == "another scene goes on":
        table = few(seed=2, batch={"realizations": 4})
    else:
        rm.run(few(seed=1, batch={"realizations": 9}), out)
    content = out.read_bytes()
    with pytest.raises(rm.StoreError, match="holds results of another scene"):
        rm.run(table, out)
    assert out.read_bytes() == content


@pytest.mark.large
def test_kept_runs_of_other_cells_excuse_no_loss(tmp_path: Path) -> None:
    """They were kept when a run was refused, since its result would have held less than the one that is there."""
    out = tmp_path / "out.nc"
    rm.run(few(sweep={"adhesion.work": [0.01]}, batch={"realizations": 30}), out)
    content = out.read_bytes()
    accuracy = {"relative": 0.5, "method": "sampled"}
    for works, says in (([0.01, 0.03], "realisations of a cell"), ([0.03], "holds results of another scene")):
        table = few(sweep={"adhesion.work": works}, batch={"realizations": 1}, accuracy=accuracy)
        with pytest.raises(rm.RoughmdrError, match=says):
            execute(make_plan(read(table)), out, Backend(runs_per_task=1))
        assert out.read_bytes() == content
        assert destination(out).with_name("out.nc.parts").exists()


@pytest.mark.parametrize("linked", [False, True])
def test_what_others_have_in_the_folder_of_parts_stays(linked: bool, tmp_path: Path) -> None:
    out, parts = tmp_path / "out.nc", tmp_path / "out.nc.parts"
    folder = tmp_path / "elsewhere" if linked else parts
    (folder / "mine").mkdir(parents=True)
    files = [folder / "mine" / "thesis.txt", folder / "notes.tmp", folder / "a.txt", folder / "result.nc"]
    for file in files:
        file.write_text("mine")
    if linked:
        parts.symlink_to(folder)
    rm.run(few(), out)
    assert out.exists()
    assert all(file.read_text() == "mine" for file in files)


@pytest.mark.few(1)
@pytest.mark.parametrize("lacking", ["remark", "adhesion_law"])
@pytest.mark.parametrize("command", [["info"], ["info", "--cells"], ["plot", "-o", "a.png"]])
def test_a_result_without_what_explains_it_is_shown(
    lacking: str, command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = rm.run(few(adhesion={"model": "dugdale", "work": "10 mJ/m^2", "range": "1 nm"}))
    result["status"][0] = 1
    result.drop_vars(lacking, errors="ignore").to_netcdf("a.nc")
    done = CliRunner().invoke(main, [command[0], "a.nc", *command[1:]])
    assert done.exit_code in (0, 2), done.output
    assert not isinstance(done.exception, KeyError)


@pytest.mark.parametrize("source", [None, 5, [], np.zeros(2)])
def test_what_is_no_scene_is_refused(source: object) -> None:
    with pytest.raises(rm.SceneError, match="it must be a path, a dictionary or a Scene"):
        rm.run(source)
