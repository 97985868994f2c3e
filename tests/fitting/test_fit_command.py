"""roughmdr fit: its text, its file, its picture, and what it refuses to replace."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import tomli_w
import xarray as xr
from command import roughmdr
from measurements import CASES, noise_of

import roughmdr as rm
from roughmdr.errors import StoreError
from roughmdr.fitting.stored import read_fit

FREE = "--free", "adhesion.work, material.modulus"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fit")
    case = CASES["adhesive"]
    force = case.force()
    measured = case.measure(noise_of("constant", force), force)
    (measured * [1e6, 1e3]).to_csv(folder / "curve.csv", index=False, header=["separation [um]", "force [mN]"])
    (folder / "scene.toml").write_text(tomli_w.dumps(case.scene))
    done = roughmdr("fit", "curve.csv", "scene.toml", "-o", "fit.nc", *FREE, cwd=folder)
    assert done.returncode == 0, done.stderr
    (folder / "said.txt").write_text(done.stdout)
    return folder


def test_what_it_says(folder: Path) -> None:
    said = (folder / "said.txt").read_text()
    lines = said.splitlines()
    assert lines[0].startswith("fitted       adhesion.work     ")
    assert " ± 0." in lines[0]
    assert "mJ/m^2 (" in lines[0]
    for text in ("material.modulus", "% of the largest force (r.m.s. of 80 points)", "laws in", "trust", "model error"):
        assert text in said
    assert lines[-1] == "fit          fit.nc"


def test_the_file(folder: Path) -> None:
    with xr.open_dataset(folder / "fit.nc") as fit:
        assert fit.adhesion_work.units == "J m-2"
        assert fit.attrs["kind"] == "fit"
        assert "fit curve.csv scene.toml" in fit.attrs["history"]
        assert fit.correlation.dims == ("parameter", "parameter_2")
        assert list(fit.parameter_name.values) == ["adhesion.work", "material.modulus"]
        assert dict(fit.sizes) == {"point": 80, "parameter": 2, "parameter_2": 2}
        assert (fit.force - fit.force_fitted - fit.residual == 0.0).all()
        assert [str(each) for each in fit.branch.values[[0, 39, 40, 79]]] == ["loading"] * 2 + ["unloading"] * 2


def test_it_is_run_and_keeps_to_the_conventions(folder: Path) -> None:
    assert roughmdr("run", "fit.nc", "-o", "law.nc", "--quiet", cwd=folder).returncode == 0
    checker = Path(sys.executable).parent / "compliance-checker"
    done = subprocess.run(
        [checker, "--test=cf:1.11", folder / "fit.nc"], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.large
def test_only_a_fit_is_replaced(folder: Path) -> None:
    again = roughmdr("fit", "curve.csv", "scene.toml", "-o", "fit.nc", *FREE, cwd=folder)
    assert again.returncode == 0, again.stderr
    (folder / "notes.nc").write_text("notes")
    refused = roughmdr("fit", "curve.csv", "scene.toml", "-o", "notes.nc", *FREE, cwd=folder)
    assert refused.returncode == 2
    assert "notes.nc: exists already and is no fit: give another output, or --fresh to replace it" in refused.stderr
    assert (folder / "notes.nc").read_text() == "notes"
    assert roughmdr("fit", "curve.csv", "scene.toml", "-o", "notes.nc", *FREE, "--fresh", cwd=folder).returncode == 0
    other = roughmdr("run", "scene.toml", "-o", "fit.nc", "--set", "path.separation=[1e-6]", cwd=folder)
    assert other.returncode == 2


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["curve.csv", "scene.toml", "-o", "x.txt", *FREE], "x.txt: the name of a fit must end in .nc"),
        (["none.csv", "scene.toml", "-o", "x.nc", *FREE], "none.csv: no such file"),
        (["curve.csv", "scene.toml", "-o", "curve.csv", *FREE], "curve.csv: is an input"),
        (["curve.csv", "scene.toml", "-o", "x.nc", "--free", "adhesion.wrk"], "did you mean 'adhesion.work'"),
        (["curve.csv", "scene.toml", "-o", "x.nc", *FREE, "--set", "adhesion.work=-1"], "--set: adhesion.work = -1"),
    ],
)
def test_wrong_input_is_told(folder: Path, arguments: list[str], says: str) -> None:
    done = roughmdr("fit", *arguments, cwd=folder)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert not (folder / "x.nc").exists()


def test_the_picture(folder: Path) -> None:
    from roughmdr.pictures.fit import draw_fit

    figure = draw_fit(read_fit(folder / "fit.nc"))
    law, residual = figure.axes
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "fitted law",
        "measured, loading",
        "measured, unloading",
    ]
    assert law.get_ylabel() == "force [mN]"
    assert residual.get_xlabel() == "measured separation [µm]"
    figure.savefig(folder / "fit.png")


@pytest.mark.few(2)
@pytest.mark.parametrize("lost", ["residual", "branch", "adhesion_work_low", "parameter_name", "force_fitted"])
def test_a_file_that_lacks_something_is_refused(folder: Path, tmp_path: Path, lost: str) -> None:
    with xr.open_dataset(folder / "fit.nc") as fit:
        fit.drop_vars(lost).to_netcdf(tmp_path / "less.nc")
    with pytest.raises(StoreError, match="not a fit as roughmdr writes it"):
        read_fit(tmp_path / "less.nc")


def test_files_of_another_kind_are_no_fit(folder: Path) -> None:
    with pytest.raises(StoreError, match="not a netCDF file"):
        read_fit(folder / "scene.toml")
    xr.Dataset().to_netcdf(folder / "empty.nc")
    with pytest.raises(StoreError, match="holds no fit"):
        read_fit(folder / "empty.nc")


def test_info_and_cite_know_a_fit_and_export_says_what_it_is(folder: Path) -> None:
    told = roughmdr("info", "fit.nc", cwd=folder)
    assert told.returncode == 0
    assert told.stdout.startswith("fitted       adhesion.work")
    with xr.open_dataset(folder / "fit.nc") as fit:
        assert rm.info(fit) == rm.info(folder / "fit.nc") == told.stdout.rstrip("\n")
        with pytest.raises(StoreError, match=r"not as roughmdr\.fit returns it: it has no residual"):
            rm.info(fit.drop_vars("residual"))
    assert "Johnson" in roughmdr("cite", "fit.nc", cwd=folder).stdout
    refused = roughmdr("export", "fit.nc", "-o", "law.csv", "--to", "csv", cwd=folder)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert "holds a fit, no result" in refused.stderr


def test_a_fit_of_more_parameters_is_not_replaced_unasked(folder: Path, tmp_path: Path) -> None:
    shutil.copy(folder / "fit.nc", tmp_path / "fit.nc")
    arguments = ("fit", folder / "curve.csv", folder / "scene.toml", "-o", "fit.nc", "--free", "material.modulus")
    refused = roughmdr(*arguments, cwd=tmp_path)
    assert refused.returncode == 2
    assert "holds a fit of adhesion.work too" in refused.stderr
    assert roughmdr(*arguments, "--fresh", cwd=tmp_path).returncode == 0
