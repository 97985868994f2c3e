"""Plotting and describing results from Python, and changes of a scene there: as the commands do it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import roughmdr, said
from scenes import ASPERITIES, scene

import roughmdr as rm

FEW = {**ASPERITIES, "count": 20}
SMALL = scene(asperities=FEW, batch={"realizations": 3})
SWEEP = {"adhesion.work": ["10 mJ/m^2", "50 mJ/m^2"]}


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("cells", [False, True])
def test_info_is_the_text_that_the_command_prints(tmp_path: Path, keep: str, cells: bool) -> None:
    out = tmp_path / "out.nc"
    rm.run({**SMALL, "output": {"keep": keep}, "sweep": SWEEP}, out)
    assert rm.info(out, cells=cells) == rm.info(str(out), cells=cells)
    assert rm.info(out, cells=cells) + "\n" == said("info", out, *["--cells"] * cells)


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_info_of_a_dataset_is_that_of_its_file_without_a_size(tmp_path: Path, keep: str) -> None:
    table = {**SMALL, "output": {"keep": keep}, "sweep": SWEEP}
    of_dataset = rm.info(rm.run(table, tmp_path / "out.nc"))
    lines = rm.info(tmp_path / "out.nc").splitlines()
    assert [line for line in lines if not line.startswith("size ")] == of_dataset.splitlines()
    with xr.open_dataset(tmp_path / "out.nc") as opened:
        assert rm.info(opened) == of_dataset


def test_numbers_that_may_not_be_those_written_are_shown_with_a_warning(tmp_path: Path) -> None:
    result, out = rm.run(SMALL, tmp_path / "out.nc"), tmp_path / "out.nc"
    without = result.assign_attrs()
    del without.attrs["checksum"]
    changed = {"are not those that were written": result.assign(force=2.0 * result.force), "may not be those": without}
    for says, dataset in changed.items():
        out.unlink()
        dataset.to_netcdf(out)
        for read in (rm.info, rm.plot):
            with pytest.warns(UserWarning, match=f"its numbers {says}"):
                read(out)


@pytest.mark.parametrize("given", [3, None, xr.Dataset({"force": ("step", np.zeros(2))}), "none.nc", Path("none.nc")])
def test_what_is_no_result_is_refused(given: Any) -> None:
    for read in (rm.info, rm.plot):
        with pytest.raises(rm.StoreError, match=r"result|no such file"):
            read(given)


@pytest.mark.large
def test_a_plot_is_a_figure_and_a_file_if_asked_for(tmp_path: Path) -> None:
    result = rm.run(SMALL, tmp_path / "out.nc")
    assert len(rm.plot(result).axes) >= 4
    drawn = [rm.plot(given, variables="force") for given in (result, tmp_path / "out.nc")]
    for figure in drawn:
        panel, *_ = figure.axes
        assert panel.get_ylabel().startswith("force [")
        lines = [line.get_xydata() for line in drawn[0].axes[0].get_lines()]
        for line, other in zip(panel.get_lines(), lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), other)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]
    rm.plot(result, tmp_path / "a.png", variables=["force"])
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    (tmp_path / "text.png").write_text("what somebody wrote")
    for out, says in (("a.nc", "must end in .png"), ("text.png", "is no png"), ("out.nc", "is an input|must end")):
        with pytest.raises(rm.StoreError, match=says):
            rm.plot(tmp_path / "out.nc", tmp_path / out)
    rm.plot(result, tmp_path / "text.png", fresh=True)
    assert (tmp_path / "text.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(rm.StoreError, match="variable 'energy' is not in the result"):
        rm.plot(result, variables=["energy"])


@pytest.mark.large
def test_a_plot_of_a_dataset_has_the_curves_over_it_that_its_file_has(tmp_path: Path) -> None:
    result = rm.run(SMALL, tmp_path / "out.nc")
    counts = []
    for given in (result, tmp_path / "out.nc"):
        with pytest.warns(rm.LimitWarning, match="theory: .*not drawn"):
            both = rm.plot(given, variables="force", with_expected=True, with_theory=True)
        plain = rm.plot(given, variables="force")
        counts.append([len(figure.axes[0].get_lines()) for figure in (plain, both)])
    assert counts[0] == counts[1]
    assert counts[0][1] > counts[0][0]


def test_keys_are_set_as_on_the_command_line(tmp_path: Path) -> None:
    write_scene(tmp_path, {**SMALL, "sweep": SWEEP})
    set_here = {"adhesion.work": "20 mJ/m^2", "batch.realizations": 2, "path.separation": np.array([2e-6, 1e-6])}
    result = rm.run(tmp_path / "scene.toml", set=set_here)
    options = ["adhesion.work=20 mJ/m^2", "batch.realizations=2", "path.separation=[2e-6, 1e-6]"]
    arguments = [part for option in options for part in ("--set", option)]
    said("run", "scene.toml", "-o", "out.nc", *arguments, cwd=tmp_path)
    with xr.open_dataset(tmp_path / "out.nc") as other:
        xr.testing.assert_equal(result.drop_vars("run_time"), other.load().drop_vars("run_time"))
        assert result.attrs["scene"] == other.attrs["scene"]
    assert "adhesion_work" not in result.sizes


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"adhesion.work": "5 m"}, r"^set: adhesion.work = '5 m': 'm' is a unit of m"),
        ({"asperities.hieght": 1}, "did you mean 'height'"),
        ({"adhesion..work": 1}, "set: 'adhesion..work' is no key"),
        ({3: 1}, "set: 3 is no key"),
        ({"seed.x": 3}, "set seed.x: "),
    ],
)
def test_a_key_that_cannot_be_set_is_named(changes: dict[Any, Any], says: str) -> None:
    with pytest.raises(rm.SceneError, match=says):
        rm.run(SMALL, set=changes)


def test_what_was_left_out_is_said_where_it_is_asked_for(tmp_path: Path) -> None:
    write_scene(tmp_path, SMALL)
    run = ["run", "scene.toml", "-o", "out.nc"]
    commands = (run, [*run, "--verbose"], ["plan", "scene.toml"], ["info", "out.nc"])
    assert ["left out" in said(*words, cwd=tmp_path) for words in commands] == [False, True, True, True]
    both = roughmdr(*run, "--verbose", "--quiet", cwd=tmp_path)
    assert (both.returncode, "--quiet and --verbose exclude each other" in both.stderr) == (2, True)


def test_failed_and_unfinished_runs_can_be_caught_by_name() -> None:
    with pytest.warns(rm.FailedRuns):
        rm.run({**SMALL, "sweep": {"asperities.radius": ["50 um", "1e300 m"]}})
    assert issubclass(rm.Unfinished, rm.StoreError)
