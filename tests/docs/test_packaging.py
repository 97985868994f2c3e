"""The image and the recipe for conda, as far as they can be tested without building them, agree with the project."""

import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest
import yaml

from roughmdr.cli import main

ROOT = Path(__file__).parent.parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
CONDA_NAMES = {"dask": "dask-core", "matplotlib": "matplotlib-base", "netCDF4": "netcdf4"}
"""Names in conda-forge where they are others."""


def recipe() -> dict[str, Any]:
    text = (ROOT / ".ci" / "conda" / "recipe.yaml").read_text()
    context = yaml.safe_load(text)["context"]
    read = yaml.safe_load(re.sub(r"\$\{\{ (python_min|version) \}\}", lambda match: str(context[match[1]]), text))
    assert isinstance(read, dict)
    return read


def as_in_conda(requirement: str) -> str:
    match = re.fullmatch(r"([\w-]+)(>=[\d.]+)", requirement)
    assert match, requirement
    return f"{CONDA_NAMES.get(match[1], match[1])} {match[2]}"


def instructions() -> list[list[str]]:
    lines = (ROOT / ".ci" / "Dockerfile").read_text().splitlines()
    return [line.split(maxsplit=1) for line in lines if line and not line.startswith("#")]


def test_the_recipe_needs_what_the_project_needs() -> None:
    project, requirements = PROJECT["project"], recipe()["requirements"]
    needed = [f"python {project['requires-python']}", *map(as_in_conda, project["dependencies"])]
    assert sorted(requirements["run"]) == sorted(needed)
    assert {as_in_conda(each) for each in PROJECT["build-system"]["requires"]} < set(requirements["host"])
    assert recipe()["build"]["python"]["entry_points"] == [f"{a} = {b}" for a, b in project["scripts"].items()]


def test_the_recipe_tells_what_the_project_is() -> None:
    told, project = recipe(), PROJECT["project"]
    assert told["package"] == {"name": project["name"], "version": project["version"]}
    assert (told["about"]["summary"], told["about"]["license"]) == (project["description"], project["license"])
    assert [told["about"]["license_file"]] == project["license-files"]
    assert (ROOT / ".ci" / "conda" / told["source"]["path"]).resolve() == ROOT


def test_the_image_takes_files_that_are_there_and_commands_that_exist() -> None:
    found = instructions()
    assert found[0][0] == "FROM"
    image = re.fullmatch(r"python:(3\.\d+)-slim", found[0][1])
    assert image
    assert f"Programming Language :: Python :: {image[1]}" in PROJECT["project"]["classifiers"]
    for name, rest in found:
        if name == "COPY":
            *sources, _ = rest.split()
            assert all((ROOT / source).exists() for source in sources), rest
        elif name == "RUN" and rest.startswith("roughmdr "):
            assert shlex.split(rest)[1] in main.commands
    assert [rest for name, rest in found if name == "USER"] == ["roughmdr"]  # runs are not those of root
    assert ["ENTRYPOINT", '["roughmdr"]'] in found


@pytest.mark.large
def test_what_the_image_copies_suffices_for_a_wheel(tmp_path: Path) -> None:
    for name, rest in instructions():
        if name == "COPY":
            for source in rest.split()[:-1]:
                copy = shutil.copytree if (ROOT / source).is_dir() else shutil.copy
                copy(ROOT / source, tmp_path / source)
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "wheel"], cwd=tmp_path, check=True)
    files = zipfile.ZipFile(next((tmp_path / "dist").glob("*.whl"))).namelist()
    assert {"roughmdr/cli/__init__.py", "roughmdr/starter.toml", "roughmdr/report/page.html"} <= set(files)
