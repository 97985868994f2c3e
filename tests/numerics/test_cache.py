"""Compiled code on disk: in other places, in several folders, some of them read-only, and for processes at once."""

import ctypes
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numba
import pytest

from roughmdr.numerics import cache

PACKAGE = Path(__file__).parent.parent.parent / "roughmdr"
_CALL = """
import json, sys
from roughmdr.numerics import cache, vector_math
from roughmdr.numerics.jit import compiled
bits = {name: compiled(getattr(vector_math, name))(0.3).hex() for name in sys.argv[1:]}
where = {file.split("-")[0].split(".")[-1]: folder and str(folder.parent) for file, folder in cache.USED.items()}
print(json.dumps({"package": cache.__file__, "bits": bits, "where": where, "written": str(cache.folders().written)}))
"""
_PR_CAPBSET_DROP, _CAP_DAC_OVERRIDE = 24, 1  # numbers of Linux: without this capability root must obey modes


def _obey_permissions() -> None:
    if os.geteuid() == 0:
        assert ctypes.CDLL(None).prctl(_PR_CAPBSET_DROP, _CAP_DAC_OVERRIDE, 0, 0, 0) == 0


def begin(package: Path, folder: Path, folders: list[Path], *names: str) -> "subprocess.Popen[str]":
    """A process in which functions of a copy of the package are called."""
    named = {"ROUGHMDR_CACHE": os.pathsep.join(map(str, folders)), "XDG_CACHE_HOME": str(folder / "own")}
    environment = {**os.environ, **named, "PYTHONPATH": str(package.parent)}
    environment.pop("NUMBA_DISABLE_JIT", None)
    command, code = [sys.executable, "-c"], f"import sys; sys.path.insert(0, {str(package.parent)!r})\n{_CALL}"
    return subprocess.Popen(
        [*command, code, *names],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=_obey_permissions,  # noqa: PLW1509 - there are no threads
    )


def told(process: "subprocess.Popen[str]") -> dict[str, Any]:
    out, _ = process.communicate()
    assert process.returncode == 0
    table: dict[str, Any] = json.loads(out)
    return table


@pytest.mark.large
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="processes of its own compile")
def test_a_copy_elsewhere_finds_the_code_in_folders_that_it_may_not_write(tmp_path: Path) -> None:
    """Two processes begin with an empty folder at once; a copy of the package reads what they left."""
    first, missing = tmp_path / "first", tmp_path / "first" / "file" / "none"
    both = [told(each) for each in [begin(PACKAGE, tmp_path, [first], "expm1", "atan") for _ in range(2)]]
    assert both[0]["bits"] == both[1]["bits"]
    assert any(None in each["where"].values() for each in both), "numba no longer asks the cache of a function"
    (first / "file").write_text("no folder")
    before = sorted(first.rglob("*"))
    assert len({path.name.split("-")[0] for path in before if path.suffix == ".nbc"}) >= 2, "numba kept no code"
    assert not [path for path in before if path.is_file() and path.suffix not in ("", ".nbc")], "unfinished files"
    package = tmp_path / "elsewhere" / "roughmdr"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    for path in (first, *before):
        path.chmod(0o555)
    try:
        again = told(begin(package, tmp_path, [missing, first], "expm1", "atan", "sqrt"))
    finally:
        for path in (first, *before):
            path.chmod(0o755)
    assert Path(again["package"]).is_relative_to(package)
    assert {name: again["bits"][name] for name in ("expm1", "atan")} == both[0]["bits"]
    compiled = {name for name, folder in again["where"].items() if folder is None}
    assert compiled == {"sqrt"}
    assert {again["where"][name] for name in again["where"].keys() - compiled} == {str(first)}
    assert sorted(first.rglob("*")) == before
    assert Path(again["written"]).is_relative_to(tmp_path / "own")
    assert [path.name.split("-")[0].split(".")[-1] for path in (tmp_path / "own").rglob("*.nbc")] == ["sqrt"]


def files() -> Any:
    implementation = SimpleNamespace(filename_base="f-1.py3", locator=SimpleNamespace(get_source_stamp=lambda: "0"))
    return cache._Files("module.f", implementation)


def test_processes_that_write_at_once_never_mix_up_types_or_processors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An index that each reads before the other writes it would lose a form, or name the code of the other."""
    monkeypatch.setattr(cache, "folders", lambda: cache.Folders((tmp_path / "none", tmp_path), tmp_path))
    one, other = files(), files()
    keys = [(types, ("linux", processor), "code") for types in ("(int64,)", "(float64,)") for processor in ("a", "b")]
    assert [each.load(key) for each in (one, other) for key in keys] == [None] * 8
    for number, key in enumerate(keys):
        (one, other)[number % 2].save(key, number)
    assert [files().load(key) for key in keys] == [0, 1, 2, 3]
    assert len(list(tmp_path.iterdir())) == 4
    next(tmp_path.iterdir()).write_bytes(b"")  # cut off, as by a copy that was interrupted
    assert [files().load(key) for key in keys].count(None) == 1
