"""Compiling before the first run."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from click.testing import CliRunner
from scenes import scene

from roughmdr.cli import main
from roughmdr.runner.warm import _shortened, small_scenes
from roughmdr.scene import read
from roughmdr.shapes import SHAPES

_RUN = """
import sys
from roughmdr.cli import main
from roughmdr.numerics.cache import USED
try:
    main(sys.argv[1:])
except SystemExit as end:
    assert not end.code, end.code
print("compiled by it:", sum(folder is None for folder in USED.values()), "of", len(USED))
"""


@pytest.mark.large
def test_a_scene_that_is_warm_compiles_nothing(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(tomli_w.dumps(scene(adhesion=None, batch={"realizations": 3})))
    environment = {**os.environ, "ROUGHMDR_CACHE": str(tmp_path / "cache")}
    environment.pop("NUMBA_DISABLE_JIT", None)

    def call(*arguments: str) -> str:
        command = [sys.executable, "-c", _RUN, *arguments]
        return subprocess.run(command, cwd=tmp_path, env=environment, check=True, capture_output=True, text=True).stdout

    words = call("warm", "small.toml")
    kept = list((tmp_path / "cache").rglob("*.nbc"))
    assert int(re.findall(r"compiled +(\d+) functions", words)[0]) == len(kept) > 0
    assert str(tmp_path / "cache") in words
    assert "compiled by it: 0 of" in call("run", "small.toml", "-o", "out.nc")
    assert len(list((tmp_path / "cache").rglob("*.nbc"))) == len(kept)


@pytest.mark.parametrize(
    "path",
    [
        {"separation": {"start": "3 sigma", "stop": {"contact_fraction": 0.01}, "steps": 200}, "unload": True},
        {"preload": "1 mN", "steps": 300, "unload": True},
        {"preload": "1 mN"},
        {"separation": ["1 sigma", "0 sigma"]},
        {"separation": "1 sigma", "lateral": {"stop": "0.1 um", "steps": 50}},
    ],
)
def test_a_scene_is_shortened_in_its_steps_and_runs_only(path: dict[str, Any]) -> None:
    sections = {"adhesion": None, "tangential": {"friction": 0.3}} if "lateral" in path else {}
    asked = read(scene(path=path, batch={"realizations": 16}, **sections))
    (short,) = _shortened(asked)
    assert short.batch.realizations == 1
    assert short.asperities == asked.asperities
    assert short.path.control == asked.path.control
    assert " 8 steps" in repr(short) or isinstance(path.get("separation"), list | str)


def test_both_estimators_of_an_error_that_is_asked_for_are_compiled() -> None:
    asked = read(scene(batch=None, accuracy={"relative": 0.01}))
    assert [each.batch.estimator for each in _shortened(asked)] == ["stratified", "expected"]


@pytest.mark.large
def test_small_scenes_have_every_shape_under_every_model() -> None:
    tables = {table["title"]: table for table in small_scenes()}
    assert {f"{shape}, {model}" for shape in SHAPES for model in ("none", "jkr", "dugdale")} <= set(tables)
    for title, table in tables.items():
        if not title.endswith((", force", ", spring", ", expected", ", none", ", dugdale")):
            assert read(table).title == title


def test_changes_need_a_scene() -> None:
    done = CliRunner().invoke(main, ["warm", "--set", "seed=3"])
    assert done.exit_code == 2
    assert "--set needs a SCENE" in done.output
