"""What a run finds at its output that is not its own: another result, files in the folder of its parts, odd results."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import interrupted
from click.testing import CliRunner
from scenes import scene

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.plan import make_plan
from roughmdr.runner.batch import execute
from roughmdr.scene import read
from roughmdr.store import destination

FEW = {"source": "random", "shape": "paraboloid", "count": 20, "patch": "1 mm", "radius": "50 um"}
PATH = {"separation": {"start": "2 sigma", "stop": "0 sigma", "steps": 5}}


def few(**changes: Any) -> dict[str, Any]:
    asperities = {**FEW, "height": {"distribution": "normal", "std": "1 um"}}
    return scene(**{"asperities": asperities, "path": PATH, "batch": {"realizations": 6}, **changes})


@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_an_interrupted_fresh_run_goes_on_beside_the_result_that_it_replaces(
    keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its parts are kept beside a result of another scene, which --fresh was given to replace."""
    out, other = tmp_path / "out.nc", tmp_path / "other.nc"
    rm.run(few(seed=1), other)
    table = few(seed=2, output={"keep": keep})
    interrupted(table, out, 2, monkeypatch)
    other.rename(out)
    done = execute(make_plan(read(table), 2), out).to_xarray()
    whole = rm.run(table)
    xr.testing.assert_identical(done.drop_vars("run_time").drop_attrs(), whole.drop_vars("run_time").drop_attrs())
    assert not destination(out).with_name("out.nc.parts").exists()


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
