"""Sources that decide compiled code and numbers, by copies of the package that differ in one line."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest
import tomli_w
from scenes import scene

from roughmdr.numerics.fingerprint import COMPILED, NUMBERS, fingerprint

PACKAGE = Path(__file__).parent.parent.parent / "roughmdr"
_RUN = """
import sys

from roughmdr.batch.resume.find import ReusableRows
from roughmdr.cli import main
used = []
read = ReusableRows.read
ReusableRows.read = lambda self, rows: [used.append(each.realizations) or each for each in read(self, rows)]
try:
    main({arguments!r})
except SystemExit as end:
    assert not end.code, end.code
print("used again:", sum(used))
"""


def run(package: Path, folder: Path, realizations: int) -> tuple[int, int]:
    """A run by a copy of the package: how many runs it used again, and how many compiled files it added."""
    before = set(folder.rglob("*.nbc"))
    arguments = ["run", "small.toml", "-o", "out.nc", "--set", f"batch.realizations={realizations}", "--quiet"]
    environment = {**os.environ, "PYTHONPATH": str(package.parent), "XDG_CACHE_HOME": str(folder / "cache")}
    code = f"import sys; sys.path.insert(0, {str(package.parent)!r})" + _RUN.format(arguments=arguments)
    environment.pop("NUMBA_DISABLE_JIT", None)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return int(done.stdout.rpartition("used again: ")[2]), len(set(folder.rglob("*.nbc")) - before)


def replace(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


@pytest.mark.large
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="processes of its own compile")
def test_only_what_decides_numbers_costs_what_was_compiled_and_computed(tmp_path: Path) -> None:
    package = tmp_path / "copy" / "roughmdr"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "small.toml").write_text(tomli_w.dumps(scene(batch=None)))
    used, compiled = run(package, tmp_path, 2)
    assert used == 0
    assert compiled > 0
    replace(package / "pictures" / "law.py", '"""', '"""Draw what follows. ')
    assert run(package, tmp_path, 4) == (2, 0)
    replace(package / "kernels" / "closed" / "jkr_paraboloid.py", "_SMALLEST = 1e-270", "_SMALLEST = 1e-271")
    (tmp_path / "out.nc").unlink()
    used, compiled = run(package, tmp_path, 4)
    assert used == 0
    assert compiled > 0


def test_what_is_compiled_is_among_the_sources_that_decide_it() -> None:
    compiled = [path for path in PACKAGE.rglob("*.py") if "from roughmdr.numerics.jit import" in path.read_text()]
    assert len(compiled) > 10
    for path in compiled:
        assert str(path.relative_to(PACKAGE)).startswith(COMPILED), path


def test_each_part_is_there() -> None:
    assert all((PACKAGE / part).exists() for part in NUMBERS)
    assert set(COMPILED) < set(NUMBERS)
    assert fingerprint(COMPILED) != fingerprint(NUMBERS)
