"""Every kind of file that the program writes, under the checker of the CF conventions."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from command import roughmdr
from forms import large
from scenes import ASPERITIES, CONDUCTION, scene
from test_cli import SCENES

from roughmdr.variables import CONDUCTANCES, CURVE_VARIABLES

SMALL: dict[str, Any] = {**ASPERITIES, "count": 30}
_DRAWN = {key: value for key, value in SMALL.items() if key != "radius"}
POWER = {**_DRAWN, "shape": "power_law", "exponent": 2.5, "coefficient": 1e7}
PRODUCT = {"adhesion.work": [0.0, 0.05, 0.02], "asperities.height.distribution": ["normal", "uniform"]}
SIGMA = {"mode": "zip", "path.separation.start": ["3 sigma", "4 sigma"], "asperities.coefficient": [1e7, 5e6]}
EVERY = {"variables": list(CURVE_VARIABLES | CONDUCTANCES)}
RESULTS = {
    "curves": scene(asperities=SMALL, output=EVERY, conduction=CONDUCTION),
    "statistics": scene(asperities=SMALL, output={**EVERY, "keep": "statistics"}, conduction=CONDUCTION),
    "product": scene(asperities=SMALL, sweep={**PRODUCT, "asperities.height.std": ["2 um", "1 um"]}),
    "product of statistics": scene(asperities=SMALL, sweep=PRODUCT, output={"keep": "statistics"}),
    "zip": scene(asperities=POWER, sweep=SIGMA),
    "single": scene(asperities=SMALL, adhesion=None, batch=None),
}


@pytest.fixture(scope="module", params=["curves", large("every kind")])
def written(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A result and its asperities, or a file of every kind."""
    folder = tmp_path_factory.mktemp("cf")

    def run(*arguments: object) -> None:
        done = roughmdr(*arguments, cwd=folder)
        assert done.returncode == 0, done.stderr

    names = RESULTS if request.param == "every kind" else [request.param]
    for name in names:
        table = RESULTS[name]
        (folder / f"{name}.toml").write_text(tomli_w.dumps(table))
        run("run", f"{name}.toml", "-o", f"{name}.nc")
    for name in {"curves", "zip"} & set(names):
        run(
            "generate",
            f"{name}.toml",
            "-o",
            f"{name} asperities.nc",
            "--set",
            "asperities.coefficient=3e6" if name == "zip" else "seed=1",
        )
    if request.param == "curves":
        return sorted(folder.glob("*.nc"))
    script = SCENES.parents[1] / "data_gen" / "surface.py"
    subprocess.run([sys.executable, script, "map.nc", "--points", "64"], cwd=folder, check=True, capture_output=True)
    run("run", SCENES / "measured_surface.toml", "--set", "asperities.file=map.nc", "-o", "surface.nc")
    run("generate", SCENES / "measured_surface.toml", "--set", "asperities.file=map.nc", "-o", "surface asperities.nc")
    return sorted(folder.glob("*.nc"))


@pytest.mark.large
def test_the_checker_finds_nothing(written: list[Path]) -> None:
    assert len(written) in (2, len(RESULTS) + 5)
    checker = Path(sys.executable).with_name("compliance-checker")
    done = subprocess.run(
        [checker, "--test=cf:1.11", "--criteria=strict", *written], capture_output=True, text=True, check=False
    )
    # Where names are swept, the checker's test of rising coordinates subtracts them from each other, and says so.
    assert done.returncode == 0 or "'str' and 'str'" in done.stderr, f"{done.stdout}\n{done.stderr}"
    assert done.stdout.count("All tests passed!") == len(written), done.stdout


def test_the_checker_would_find_something(tmp_path: Path) -> None:
    import netCDF4

    with netCDF4.Dataset(tmp_path / "bad.nc", "w") as file:
        file.createDimension("x", 3)
        file.createVariable("x", "f8", ("x",))[:] = np.array([1.0, 3.0, 2.0])
    command = [Path(sys.executable).with_name("compliance-checker"), "--test=cf:1.11", tmp_path / "bad.nc"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "All tests passed!" not in done.stdout
