"""Every block of code in README and docs is run as a reader would run it: page by page, in a fresh folder.

The blocks of a page follow each other: Python has one namespace, commands and Python share the folder. A TOML block is
a scene: one that begins with a comment that is a name, such as ``# scene.toml``, is written to that file; another
replaces the sections that it names in ``scene.toml`` (or in the scene that ``roughmdr new`` writes) and is read.
Output that a page shows is no code, and its fence says ``text``.
"""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from forms import large
from sybil import Example, Sybil
from sybil.parsers.myst import CodeBlockParser, PythonCodeBlockParser

from roughmdr.scene.read import read

ROOT = Path(__file__).parent.parent.parent
PAGES = [ROOT / "README.md", *sorted(path for path in (ROOT / "docs").rglob("*.md") if "_build" not in path.parts)]
LONG = [
    "README",
    "adhesion",
    "analysis",
    "asperities",
    "batches",
    "contact_engineering",
    "contacts_that_yield",
    "greenwood_williamson",
    "interaction",
    "lammps",
    "layers",
    "measured_curves",
    "paths",
    "start",
]
"""Pages whose blocks take longest: long forms."""
LANGUAGES = {"python", "toml", "sh", "text", "bibtex"}
STARTER = (ROOT / "roughmdr" / "starter.toml").read_text()

_DRY = f'make() {{ command make --dry-run --directory "{ROOT}" "$@" > /dev/null; }}\n'
"""Targets of make are looked up, not made: they are what runs these tests."""


def run_commands(example: Example) -> None:
    """Run a block of commands; what is started in its background ends with it."""
    command = f"set -euo pipefail\ntrap 'kill $(jobs -p) 2>/dev/null || true' EXIT\n{_DRY}{example.parsed}"
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", command], env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False
    )
    assert not done.returncode, f"{example.parsed}\n{done.stdout}\n{done.stderr}"


def read_scene(example: Example) -> None:
    """Write a named scene to its file; read it, or what a nameless one makes of the page's scene."""
    text = str(example.parsed)
    name = re.match(r"# (\S+\.toml)\n", text)
    if name:
        Path(name[1]).write_text(text)
        read(name[1])
        return
    basis = Path("scene.toml")
    changed = tomllib.loads(basis.read_text() if basis.exists() else STARTER) | tomllib.loads(text)
    read(changed)


READER = Sybil(
    parsers=[
        PythonCodeBlockParser(),
        CodeBlockParser(language="sh", evaluator=run_commands),
        CodeBlockParser(language="toml", evaluator=read_scene),
    ]
)


@pytest.mark.parametrize(
    "page",
    [large(path) if path.stem in LONG else path for path in PAGES],
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_the_blocks_of_a_page_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pipelines").symlink_to(ROOT / "pipelines")
    (tmp_path / "data_gen").symlink_to(ROOT / "data_gen")
    for example in READER.parse(page).examples():
        example.evaluate()


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_fence_says_what_it_holds(page: Path) -> None:
    """So that no block goes unrun: one without a language, or in an unknown one, would."""
    opening = True
    for line in page.read_text().splitlines():
        if line.lstrip().startswith("```"):
            language = line.strip().removeprefix("```").split()[0] if line.strip() != "```" else ""
            assert not opening or language in LANGUAGES or language.startswith("{"), line
            opening = not opening
    assert not any(
        re.match(r"    (roughmdr|pip|make|python|\[\w+\])\b", line) for line in page.read_text().splitlines()
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_to_files_that_are_there(page: Path) -> None:
    for target in re.findall(r"\]\((?!https?:)([^)#\s]+)", page.read_text()):
        generated = {"gallery", "generated"} & set(Path(target).parts)
        assert generated or (page.parent / target).exists(), target
