"""Each scene is run by the command line; its stated error is held against the error that its force has."""

import math
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tomli_w
import xarray as xr
from click.testing import CliRunner

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.scene import read
from studies.study import named
from studies.trust.scenes import CASES, QUICK, Case
from studies.trust.truth import MAPS, by_boundary_elements, by_pairs, by_range_of_adhesion, of_map
from studies.trust.truth import Path as FlatPath
from studies.versus_bem.ensembles import write_map

_TOLD = ("contact", "model error", "trust", "warning")


class Run(NamedTuple):
    """One run from the command line, at its closest approach, where the model error is largest."""

    exit_status: int
    printed: str
    """Its lines on contact, model error, trust and warnings; or the reason against it."""
    contact_fraction: float = math.nan
    contact_radius: float = math.nan
    """Root mean square [m]."""
    model_error: float = math.nan
    separation: float = math.nan
    force: float = math.nan
    pull_off: float = math.nan
    """[N]; NaN without an unloading."""


class Truth(NamedTuple):
    """True forces [N], and the points of the grid for a contact radius; NaN where there are none."""

    force: float = math.nan
    scatter: float = math.nan
    """Standard error of the mean over several maps."""
    pull_off: float = math.nan
    radius_points: float = math.nan


_NAMES = {
    "exit_status": ("exit status of the run", "1"),
    "contact_fraction": ("summed contact area over the nominal area at closest approach", "1"),
    "contact_radius": ("root mean square of the contact radii at closest approach", "m"),
    "model_error": ("model error at closest approach", "1"),
    "separation": ("separation at closest approach", "m"),
    "force": ("force of independent asperities at closest approach", "N"),
    "pull_off": ("pull-off force of independent asperities", "N"),
    "true_force": ("true force at closest approach, infinite in full contact", "N"),
    "scatter": ("standard error of the true force, of a mean over maps", "N"),
    "true_pull_off": ("true pull-off force", "N"),
    "radius_points": ("contact radius over the spacing of the grid of boundary elements", "1"),
}


def carry_out(case: Case, folder: Path) -> tuple[Run, Truth]:
    """Run a scene in a folder, and find the true force."""
    file, out = folder / "scene.toml", folder / "out.nc"
    file.write_text(tomli_w.dumps(case.scene))
    if case.oracle == "map" and case.surface is not None:
        write_map(case.surface.height(), case.surface.size, folder / "map.nc")
    done = CliRunner().invoke(main, ["run", str(file), "-o", str(out), "--fresh"])
    if done.exit_code:
        return Run(done.exit_code, done.stderr.strip().splitlines()[-1]), Truth()
    with xr.open_dataset(out) as stored:
        result = stored.squeeze(drop=True).load()
    return _compare(case, file, result, "\n".join(_told(done.stdout)))


def _told(printed: str) -> Iterator[str]:
    """Yield the lines that say how far the force can be trusted."""
    name = ""
    for line in printed.splitlines():
        name = line[:12].strip() or name
        if name in _TOLD:
            yield line


def _compare(case: Case, file: Path, result: xr.Dataset, printed: str) -> tuple[Run, Truth]:
    closest = int(np.argmin(result["separation"].to_numpy()))
    at = result.isel(step=closest)
    size = case.surface.size if case.surface else math.sqrt(float(_ensemble(file).attrs["nominal_area"]))
    run = Run(
        0,
        printed,
        float(at["contact_fraction"]),
        size * math.sqrt(float(at["contact_fraction"] / (math.pi * at["contact_count"]))),
        float(at["model_error_curve"]),
        float(at["separation"]),
        float(at["force"]),
        float(result.get("pull_off_force", math.nan)),
    )
    return run, _truth(case, file, run, FlatPath(result["separation"].to_numpy(), closest))


def _truth(case: Case, file: Path, run: Run, path: FlatPath) -> Truth:
    modulus, work = (scene := read(file)).effective_modulus, scene.work
    if case.surface is not None:
        several = range(1, MAPS + 1) if case.oracle == "maps" else (1,)
        forces = of_map(case.surface, several, modulus, run.separation)
        scatter = float(np.std(forces, ddof=1)) / math.sqrt(len(forces)) if len(forces) > 1 else 0.0
        spacing = case.surface.size / (case.surface.points * case.surface.refined)
        return Truth(float(np.mean(forces)), scatter, radius_points=run.contact_radius / spacing)
    ensemble = _ensemble(file)
    if case.oracle == "pairs":
        force, pull_off = by_pairs(ensemble, modulus, work, path)
        if work:
            return Truth(force + by_range_of_adhesion(ensemble, modulus, work, path), 0.0, pull_off)
        return Truth(force, 0.0)
    spacing = math.sqrt(float(ensemble.attrs["nominal_area"])) / case.points
    force = by_boundary_elements(ensemble, case.points, modulus, run.separation)
    return Truth(force, 0.0, radius_points=run.contact_radius / spacing)


def _ensemble(file: Path) -> xr.Dataset:
    """Return the asperities of the first realisation, with their positions."""
    scene = read(file)
    return rm.generate(scene.asperities, seed=scene.seed)


def measure(quick: bool) -> xr.Dataset:
    """Carry out all scenes, or a few small ones."""
    cases = [case for case in CASES if not quick or case.name in QUICK]
    with tempfile.TemporaryDirectory() as name, chdir(name), warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        found = [carry_out(case, Path(name)) for case in cases]
    columns = {
        **{name: [getattr(run, name) for run, _ in found] for name in Run._fields},
        **{("true_" if name in Run._fields else "") + name: [getattr(truth, name) for _, truth in found]
           for name in Truth._fields},
    }  # fmt: skip
    words = {name: [getattr(case, name) for case in cases] for name in ("name", "oracle", "changes")}
    return xr.Dataset(
        {name: ("scene", columns[name], named(*attributes)) for name, attributes in _NAMES.items()},
        {name: ("scene", column) for name, column in {**words, "printed": columns["printed"]}.items()},
    )
