"""Files of each kind to be changed, the commands that read them, and how these must end."""

import shutil
from collections.abc import Iterator
from contextlib import chdir, contextmanager, nullcontext
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import tomli_w
import xarray as xr
from click.testing import CliRunner, Result
from foreign import Content, Variable, control_characters, undefined, write
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.errors import FailedRuns
from roughmdr.storage.netcdf_store import read_netcdf

FEW = {**ASPERITIES, "count": 5}
SCENE = scene(
    asperities=FEW,
    batch={"realizations": 2},
    path={"separation": {"start": "2 um", "stop": "-1 um", "steps": 6}, "unload": True},
)
TABLE = {
    **{key: value for key, value in FEW.items() if key != "radius"},
    **{"shape": "tabulated", "r": [0, "1 um", "3 um"], "f": [0, "10 nm", "100 nm"]},
}
RESULTS = {
    "curves": SCENE,
    "statistics": {**SCENE, "output": {"keep": "statistics"}},
    "sweep": {**SCENE, "sweep": {"adhesion.work": [0.01, 0.02], "asperities.radius": ["50 um", "1e300 m"]}},
    "accuracy": {
        **SCENE,
        "adhesion": {"model": "jkr", "work": 0.05, "strength": 1e9},
        "batch": {},
        "accuracy": {"relative": 0.5, "max_realizations": 8},
        "sweep": {"mode": "zip", "adhesion.work": [0.01, 0.02]},
    },
}
OF_RESULT = (
    "info changed.nc",
    "info changed.nc --cells",
    "plot changed.nc -o picture.png",
    "plot changed.nc -o picture.png --with-expected --with-theory",
    "export changed.nc -o table.json --to json --branch unloading --error 0.1",
    "generate changed.nc -o made.nc --fresh",
    "run {}.toml -o changed.nc",
    "run changed.nc -o again.nc",
)
OF_INPUT = ("generate {}.toml -o made.nc --fresh", "run {}.toml -o again.nc")


@contextmanager
def filled(folder: Path) -> Iterator[Path]:
    """A folder to be in, with a file of each kind and scenes that read ``changed.nc``."""
    with chdir(folder):
        for name, table in RESULTS.items():
            Path(f"{name}.toml").write_text(tomli_w.dumps(table))
            with pytest.warns(FailedRuns) if name == "sweep" else nullcontext():
                rm.run(f"{name}.toml", f"{name}.nc")
        rm.generate(FEW, seed=1).to_netcdf("ensemble.nc")
        rm.generate(TABLE, seed=1).to_netcdf("table.nc")
        at, rough = np.arange(12) * 1e-6, 1e-7 * np.random.default_rng(0).normal(size=(12, 12))
        data = xr.Dataset({"height": (("x", "y"), rough)}, coords={"x": at, "y": at}, attrs={"periodic": 1})
        data.to_netcdf("map.nc")
        for name, source in (("ensemble", "file"), ("table", "file"), ("map", "surface")):
            section = {"source": source, "file": "changed.nc"}
            Path(f"{name}.toml").write_text(tomli_w.dumps({**SCENE, "asperities": section, "batch": {}}))
        yield folder


def called(command: str) -> Result:
    return CliRunner().invoke(main, command.split())


def checked(command: str) -> Result:
    """A command that must end as it should."""
    done = called(command)
    assert isinstance(done.exception, SystemExit | None), (command, done.exception)
    assert done.exit_code in (0, 1, 2), (command, done.output)
    assert "Traceback" not in done.output
    assert not control_characters(done.output), (command, done.output)
    if done.exit_code == 0:
        assert not undefined(done.output), (command, done.output)
    return done


def put(content: Content, *, believed: bool) -> bool:
    """Put it at ``changed.nc``, with a checksum of its own where it is to be ``believed``; whether that can be."""
    for left in ("again.nc", "changed.nc"):  # the library may still hold open what it could not write
        Path(left).unlink(missing_ok=True)
    shutil.rmtree("changed.nc.parts", ignore_errors=True)
    try:
        write(content, Path("changed.nc"))
    except Exception:  # netCDF itself refuses what was made up
        return False
    if believed:
        try:
            checksum = read_netcdf(Path("changed.nc")).checksum()
        except ValueError:  # it cannot even be read, or holds what no text is
            return True
        with netCDF4.Dataset("changed.nc", "a") as file:
            file.checksum = checksum
    return True


def all_failed(content: Content) -> None:
    runs = content.variables["status"].dims
    content.variables["status"].values[...] = 1
    if "pull_off_count" in content.variables:
        content.variables["pull_off_count"].values[...] = 0.0
    for name, (dims, values, _) in content.variables.items():
        if (
            dims in (runs, (*runs, "step"))
            and values.dtype.kind == "f"
            and name not in ("separation", "realization_count", "pull_off_count")
        ):
            values[...] = np.nan


def remarked(content: Content) -> None:
    dims, status = content.variables["status"][:2]
    remarks = np.full(status.shape, "OutOfRange: no", dtype=object)
    content.variables["remark"] = Variable(dims, remarks, {})
