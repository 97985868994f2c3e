"""The script for releases, in a clone: version, change log, citation, tag and wheel agree."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent.parent
KEPT = (
    "CHANGELOG.md",
    "CITATION.cff",
    "LICENSE",
    "README.md",
    "pyproject.toml",
    ".ci/conda/recipe.yaml",
    ".ci/release.py",
    "roughmdr/__init__.py",
    "roughmdr/py.typed",
    "roughmdr/starter.toml",
    "roughmdr/report/papers.bib",
)


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of its own with what a release touches."""
    for name in ("AUTHOR", "COMMITTER"):
        monkeypatch.setenv(f"GIT_{name}_NAME", "a tester")
        monkeypatch.setenv(f"GIT_{name}_EMAIL", "tester@example.org")
    for name in KEPT:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    log = tmp_path / "CHANGELOG.md"
    log.write_text(log.read_text().replace("# Changes\n", "# Changes\n\n## 7.8.9 (not yet released)\n\nMore.\n", 1))
    (tmp_path / ".gitignore").write_text("dist/\n")
    for command in (["init", "-q"], ["add", "--all"], ["commit", "-q", "-m", "all"]):
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    return tmp_path


def release(clone: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    script = [sys.executable, str(clone / ".ci" / "release.py"), *arguments]
    return subprocess.run(script, cwd=clone, capture_output=True, text=True, check=False, env=dict(os.environ))


def test_a_release_is_tagged_and_built(clone: Path) -> None:
    done = release(clone, "7.8.9")
    assert not done.returncode, done.stderr
    assert tomllib.loads((clone / "pyproject.toml").read_text())["project"]["version"] == "7.8.9"
    assert 'version: "7.8.9"' in (clone / ".ci" / "conda" / "recipe.yaml").read_text()
    assert "version: 7.8.9" in (clone / "CITATION.cff").read_text()
    assert "## 7.8.9 (not" not in (clone / "CHANGELOG.md").read_text()
    tagged = subprocess.run(
        ["git", "show", "v7.8.9:pyproject.toml"], cwd=clone, capture_output=True, text=True, check=True
    )
    assert 'version = "7.8.9"' in tagged.stdout
    assert (clone / "dist" / "roughmdr-7.8.9.tar.gz").exists()
    files = zipfile.ZipFile(clone / "dist" / "roughmdr-7.8.9-py3-none-any.whl").namelist()
    assert {"roughmdr/py.typed", "roughmdr/starter.toml", "roughmdr/report/papers.bib"} <= set(files)
    assert any(name.endswith("licenses/LICENSE") for name in files)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [((), "three numbers"), (("1.0",), "three numbers"), (("3.0.0",), "no section '## 3.0.0")],
)
def test_a_release_that_is_not_ready_is_refused(clone: Path, arguments: tuple[str, ...], reason: str) -> None:
    done = release(clone, *arguments)
    assert done.returncode == 1
    assert reason in done.stderr


def test_a_tree_with_changes_is_refused(clone: Path) -> None:
    (clone / "README.md").write_text("changed")
    assert "not committed" in release(clone, "7.8.9").stderr


def test_nothing_is_installed_by_a_name_that_is_not_published() -> None:
    """Whoever registers the name would be installed; guides and messages install from the clone."""
    texts = [path for folder in ("roughmdr", "docs", "pipelines") for path in (ROOT / folder).rglob("*.*")]
    named = [
        str(path.relative_to(ROOT))
        for path in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *texts]
        if path.suffix in (".md", ".py", ".toml") and re.search(r"install\s+'?roughmdr", path.read_text("utf-8"))
    ]
    assert not named
