"""The command line: exit status, messages, files."""

import subprocess
import sys
from pathlib import Path

import numba
import pytest
import tomli_w
import xarray as xr
from command import in_a_process, roughmdr
from scenes import scene

SCENES = Path(__file__).parents[1] / "pipelines" / "scenes"


@pytest.fixture
def small(tmp_path: Path) -> Path:
    (tmp_path / "small.toml").write_text(tomli_w.dumps(scene()))
    return tmp_path


def test_run_and_plot(small: Path) -> None:
    clear = "--set", "path.separation.start=6 sigma"
    done = roughmdr("run", "small.toml", "-o", "out.nc", "--set", "batch.realizations=3", *clear, cwd=small)
    assert done.returncode == 0, done.stderr
    for text in ("A small scene: 3 realisations x 80 steps", "pull-off     -", "± ", "run time", "out.nc"):
        assert text in done.stdout
    assert done.stderr.splitlines()[-1] == "A small scene: 3 of 3 runs"
    with xr.open_dataset(small / "out.nc") as result:
        assert result.sizes["realization"] == 3
        assert "--set batch.realizations=3" in result.attrs["history"]
    for extra, name in ([], "a.png"), (["--variable", "force"], "b.pdf"):
        drawn = roughmdr("plot", "out.nc", "-o", name, *extra, cwd=small)
        assert drawn.returncode == 0, drawn.stderr
        assert (small / name).stat().st_size > 5000
    assert (small / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.large
def test_a_folder_beside_the_clone_does_not_hide_the_package(tmp_path: Path) -> None:
    """Python takes a folder called as the package for a package of its own unless it finds a real one."""
    (tmp_path / "roughmdr").mkdir()
    code = "import roughmdr as rm; print(rm.run.__module__)"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "roughmdr.runner.run"), done.stderr


def test_quiet_says_nothing(small: Path) -> None:
    done = roughmdr("run", "small.toml", "-o", "out.nc", "--quiet", "--workers", 1, cwd=small)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.large
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_run_says_that_it_compiles_and_only_then(small: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(small / "cache"))
    monkeypatch.delenv("ROUGHMDR_CACHE", raising=False)
    run = "run", "small.toml", "--set", "batch.realizations=1", "--set", "adhesion.work=0", "-o"
    says = [in_a_process(*run, name, cwd=small).stderr for name in ("first.nc", "second.nc")]
    assert says[0].splitlines()[0] == "A small scene: compiling the kernels (once) ..."
    assert says[0].count("compiling") == 1
    assert says[1] == "A small scene: 1 of 1 runs\n"


@pytest.mark.large
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_quiet_run_compiles_in_silence(small: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(small / "cache"))
    monkeypatch.delenv("ROUGHMDR_CACHE", raising=False)
    done = in_a_process("run", "small.toml", "-o", "out.nc", "--quiet", "--set", "adhesion.work=0", cwd=small)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list((small / "cache").rglob("*.nbc"))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["run", "none.toml", "-o", "out.nc"], "none.toml: no such file"),
        (["run", "small.toml", "-o", "none/out.nc"], "none/out.nc: the folder none does not exist"),
        (["run", "small.toml", "-o", "out.nc", "--set", "asperities.hieght=1"], "did you mean 'height'"),
        (["run", "small.toml", "-o", "out.nc", "--set", "asperities.source=surface"], "asperities.file: is missing"),
        (["run", "small.toml"], "Missing option"),
        (["run", "small.toml", "-o", "out.nc", "--workers", "0"], "--workers"),
        (["plot", "none.nc", "-o", "a.png"], "none.nc: no such file"),
        (["plot", "small.toml", "-o", "a.png"], "not a netCDF file"),
        (["nothing"], "No such command"),
    ],
)
def test_wrong_input_is_exit_status_2_with_a_message_and_no_file(small: Path, arguments: list[str], says: str) -> None:
    done = roughmdr(*arguments, cwd=small)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert [path.name for path in small.iterdir()] == ["small.toml"]


def test_a_picture_of_what_is_not_there(small: Path) -> None:
    assert roughmdr("run", "small.toml", "-o", "out.nc", "--quiet", cwd=small).returncode == 0
    for arguments, says in (
        (["-o", "a.png", "--variable", "energy"], "it holds force"),
        (["-o", "a.xyz"], "the name of a picture must end in .png, .pdf or .svg"),
    ):
        done = roughmdr("plot", "out.nc", *arguments, cwd=small)
        assert done.returncode == 2
        assert says in done.stderr
    assert sorted(path.name for path in small.iterdir()) == ["out.nc", "small.toml"]


@pytest.mark.large
def test_a_picture_of_a_crooked_path_with_an_odd_title(small: Path) -> None:
    crooked = [
        "--set",
        'path.separation=["2 um","0 um","2 um","0.5 um","2 um","-1 um"]',
        "--set",
        r"title='a$\foo$ [/b]'",
    ]
    assert roughmdr("run", "small.toml", "-o", "out.nc", *crooked, cwd=small).returncode == 0
    drawn = roughmdr("plot", "out.nc", "-o", "a.png", cwd=small)
    assert drawn.returncode == 0, drawn.stderr


_INTERRUPTED_IN_THE_FIRST_TASK = """
import os, signal
import roughmdr.runner.local as local
from roughmdr.cli import main

compute, signals = local.compute, [signal.SIGINT]

def interrupted(*arguments):
    if signals:
        os.kill(os.getpid(), signals.pop())
    return compute(*arguments)

local.compute = interrupted
main()
"""


@pytest.mark.large
def test_an_interrupt_is_exit_status_130_and_leaves_nothing(small: Path) -> None:
    command = [sys.executable, "-c", _INTERRUPTED_IN_THE_FIRST_TASK, "run", "small.toml", "-o", "out.nc"]
    done = subprocess.run(command, cwd=small, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 130
    assert "interrupted; nothing was written" in done.stderr
    assert "Traceback" not in done.stderr
    assert [path.name for path in small.iterdir()] == ["small.toml"]


def test_a_synthetic_surface_end_to_end(tmp_path: Path) -> None:
    script = SCENES.parents[1] / "data_gen" / "surface.py"
    made = subprocess.run(
        [sys.executable, script, "map.nc", "--points", "96"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stderr
    done = roughmdr(
        "run", SCENES / "measured_surface.toml", "--set", "asperities.file=map.nc", "-o", "out.nc", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "out.nc") as result:
        assert float(result.force.max()) > 0.0
        assert float(result.force.min()) < 0.0
        assert float(result.contact_count.max()) > 5.0
        assert (result.contact_count[:, [0, -1]] == 0.0).all()


@pytest.mark.large
def test_the_scaling_study_in_its_quick_form(tmp_path: Path) -> None:
    script = SCENES.parent / "study.py"
    done = subprocess.run(
        [sys.executable, script, "scaling", "-o", tmp_path, "--quick"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "scaling.nc") as result:
        assert result.cost.sizes == {"contact": 2, "method": 2}
        assert (result.cost > 0.0).all()
        assert result.law_brentq.dropna("law_shape").sizes == {"law_shape": 10}
        assert result.law_time.sizes == {"law_shape": 11, "law": 3}
        assert (result.law_time > 0.0).all()


@pytest.mark.large
def test_the_study_of_plans_in_its_quick_form(tmp_path: Path) -> None:
    script = SCENES.parent / "study.py"
    done = subprocess.run(
        [sys.executable, script, "foreseen", "-o", tmp_path, "--quick"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "foreseen.nc") as result:
        planned, taken = result.memory.sel(of="plan"), result.memory.sel(of="run")
        assert (planned / taken > 0.5).all()
        assert (planned / taken < 2.0).all()
