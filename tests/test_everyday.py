"""new, plan, info, generate, and messages on a terminal: in processes of their own."""

import os
import pty
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from command import ROUGHMDR, in_a_process, roughmdr
from forms import large
from pydantic import BaseModel
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.scene.scene import Scene
from roughmdr.schema.faults import sections_of
from roughmdr.schema.units import _BASES, format_quantity
from roughmdr.variables import OUTPUT_VARIABLES

UNITS = {"kB": 1e3, "MB": 1e6, "GB": 1e9}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "small.toml").write_text(tomli_w.dumps(scene()))
    return tmp_path


def keys_of(section: type[BaseModel]) -> set[str]:
    return {
        key
        for name, field in section.model_fields.items()
        for key in ({name} | {k for inner in sections_of(field.annotation) for k in keys_of(inner)})
    }


def test_the_starter_scene_runs_and_shows_every_choice(tmp_path: Path) -> None:
    assert roughmdr("new", "mine.toml", cwd=tmp_path).returncode == 0
    text = (tmp_path / "mine.toml").read_text()
    for key in keys_of(Scene):
        assert re.search(rf"\b{key}\b", text), f"{key} is not in the starter scene"
    for name in (
        *OUTPUT_VARIABLES,
        *(base[0] for spellings in _BASES.values() for base in spellings if base[0] in ("m", "Pa")),
    ):
        assert name in text
    done = roughmdr("run", "mine.toml", "-o", "out.nc", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    again = roughmdr("new", "mine.toml", cwd=tmp_path)
    assert (again.returncode, (tmp_path / "mine.toml").read_text()) == (2, text)
    assert "exists already" in again.stderr


@pytest.mark.large
def test_every_choice_that_the_starter_scene_leaves_out_is_right() -> None:
    text = (Path(rm.__file__).parent / "starter.toml").read_text()
    sweep = text[text.index("# [sweep]") :].replace("\n# ", "\n").removeprefix("# ")
    assert rm.run(tomllib.loads(text[: text.index("# [sweep]")] + sweep)).sizes["adhesion_work"] == 2
    for line in ('placement = "hard_core"', 'min_distance = "1 um"', 'effective_modulus = "3.9 MPa"', "[counter]"):
        assert f"# {line}" in text
    chosen = text.replace('# placement = "hard_core"', 'placement = "hard_core"').replace("# min_d", "min_d")
    chosen = (
        chosen.replace("# [counter]", "[counter]").replace('# modulus = "70', 'modulus = "70').replace("# poi", "poi")
    )
    assert rm.run(tomllib.loads(chosen)).force.shape == (16, 400)
    auto = (
        text.replace('model = "jkr"  ', 'model = "auto"')
        .replace("# strength", "strength")
        .replace("# error = 0.01", "error = 0.01")
    )
    assert (rm.run(tomllib.loads(auto)).tabor_number > 0.0).all()
    assert rm.run(
        tomllib.loads(auto.replace("strength", "# strength").replace("# range =", "range ="))
    ).adhesion_law.any()


# Not from getrusage: a child begins with the peak of the process that it was forked from.
_PEAK = """
from roughmdr.cli import main
main({arguments!r}, standalone_mode=False)
with open("/proc/self/status") as status:
    print(next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmHWM")))
"""


@pytest.mark.large
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of a process is read from /proc")
def test_the_plan_says_what_the_run_then_does(folder: Path) -> None:
    large = ["--set", "asperities.count=300000", "--set", "asperities.patch=0.02", "--set", "batch.realizations=6"]
    done = in_a_process("plan", "small.toml", *large, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert [path.name for path in folder.iterdir()] == ["small.toml"]
    assert "6 realisations x 80 steps: 6 in total" in done.stdout
    assert re.search(r"^time +about [\d.]+ s, of which [\d.]+ s to start$", done.stdout, re.MULTILINE)
    size, unit = re.search(r"^memory +about ([\d.]+) (\w+),", done.stdout, re.MULTILINE).groups()  # type: ignore[union-attr]
    command = ["run", "small.toml", "-o", "out.nc", *large]
    taken = subprocess.run(
        [sys.executable, "-c", _PEAK.format(arguments=command)], cwd=folder, capture_output=True, text=True, check=True
    ).stdout
    assert 0.5 < float(size) * UNITS[unit] / float(taken.split()[-1]) < 2.0
    with xr.open_dataset(folder / "out.nc") as result:
        for line in result.attrs["left_out"].splitlines():
            assert line in done.stdout


def test_info_says_what_a_result_holds(folder: Path) -> None:
    sweep = ["--set", 'sweep.adhesion.work=["10 mJ/m^2","50 mJ/m^2"]', "--set", 'path.separation.start="8 sigma"']
    assert roughmdr("run", "small.toml", "-o", "out.nc", *sweep, cwd=folder).returncode == 0
    done = roughmdr("info", "out.nc", cwd=folder)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "out.nc") as result:
        force = result.pull_off_force
        mean, error = force.mean("realization"), force.std("realization", ddof=1) / 4.0
        for i, work in enumerate((10, 50)):
            shown = format_quantity(float(mean[i]), "N", error=float(error[i]))
            assert re.search(rf"{re.escape(shown)}, .* +adhesion_work = {work} mJ/m\^2$", done.stdout, re.MULTILINE)
        texts = ["A small scene: 2 adhesion_work x 16 realisations x 80 steps", "seed         7", "numpy"]
        texts += [result.attrs["history"], result.attrs["left_out"].splitlines()[0], 'modulus = "3 MPa"', "kB"]
    for text in texts:
        assert text in done.stdout


def test_generate_writes_the_asperities_of_a_run(folder: Path) -> None:
    done = roughmdr("generate", "small.toml", "-o", "ensemble.nc", "--realization", 3, cwd=folder)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "ensemble.nc") as ensemble:
        expected = rm.generate(ASPERITIES, seed=7, realization=3)
        np.testing.assert_array_equal(ensemble.height, expected.height)
        np.testing.assert_array_equal(ensemble.radius, expected.radius)
        assert ensemble.attrs["patch"] == 1e-3
        assert ensemble.attrs["seed"] == 7
        law = rm.load_separation(ensemble, separation=[1e-6], effective_modulus=3e6)
        assert float(law.force[0]) > 0.0
    swept = roughmdr("generate", "small.toml", "-o", "x.nc", "--set", "sweep.asperities.count=[1,2]", cwd=folder)
    assert swept.returncode == 2
    assert "choose one with --set asperities.count=VALUE" in swept.stderr


def test_a_result_is_run_again_from_itself_alone(folder: Path) -> None:
    assert roughmdr("run", "small.toml", "-o", "out.nc", cwd=folder).returncode == 0
    (folder / "small.toml").unlink()
    done = roughmdr("run", "out.nc", "-o", "again.nc", "--set", "seed=7", cwd=folder)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "out.nc") as first, xr.open_dataset(folder / "again.nc") as again:
        assert first.drop_vars("run_time").equals(again.drop_vars("run_time"))
        assert first.attrs["scene"] == again.attrs["scene"]
    over = roughmdr("run", "out.nc", "-o", "out.nc", cwd=folder)
    assert over.returncode == 2
    assert "is an input" in over.stderr


def on_a_terminal(*arguments: str, cwd: Path, **environment: str) -> str:
    """Return the text that a command shows where its error stream is a terminal."""
    leader, follower = pty.openpty()
    with subprocess.Popen(
        [*ROUGHMDR, *arguments], cwd=cwd, stdout=follower, stderr=follower, env={**os.environ, **environment}
    ) as process:
        os.close(follower)
        shown = b""
        while True:
            try:
                part = os.read(leader, 65536)
            except OSError:  # the terminal is gone with the process
                break
            if not part:
                break
            shown += part
    os.close(leader)
    assert process.returncode == 2
    return shown.decode()


@pytest.mark.large
def test_messages_are_in_colour_on_a_terminal_and_plain_elsewhere(folder: Path) -> None:
    wrong: dict[str, Any] = scene(asperities={**ASPERITIES, "hieght": 1}, adhesion={"model": "jkr", "work": "5 m"})
    (folder / "wrong.toml").write_text(tomli_w.dumps(wrong))
    command = ("run", "wrong.toml", "-o", "out.nc")
    plain = roughmdr(*command, cwd=folder).stderr
    assert "\x1b" not in plain
    assert "did you mean 'height'?" in plain
    coloured = on_a_terminal(*command, cwd=folder)
    assert "\x1b[" in coloured
    bare = re.sub(r"\x1b\[[0-9;]*m", "", coloured).replace("\r\n", "\n")
    assert bare == plain
    assert "\x1b" not in on_a_terminal(*command, cwd=folder, NO_COLOR="1")


@pytest.mark.large
@pytest.mark.parametrize("elsewhere", [True, large(False)])
def test_it_works_where_the_home_folder_cannot_be_written(folder: Path, elsewhere: bool) -> None:
    """Compiled code goes where NUMBA_CACHE_DIR says, or nowhere. Root may write anywhere: a file stands in the way."""
    (folder / "home").write_text("no folder")
    environment = {**os.environ, "HOME": str(folder / "home" / "none"), "XDG_CACHE_HOME": ""}
    environment["NUMBA_CACHE_DIR"] = str(folder / "cache") if elsewhere else ""
    command = [*ROUGHMDR, "run", "small.toml", "-o", "out.nc", "--set", "adhesion.work=0"]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (folder / "out.nc").exists()
    assert (folder / "cache").exists() == elsewhere
    assert not elsewhere or list((folder / "cache").rglob("*.nbc"))
