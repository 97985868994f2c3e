"""Each scene is run by the command line; its stated error is held against the error that its force has."""

import math
import tempfile
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
import xarray as xr
from click.testing import CliRunner

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from studies.comparison import FACTOR, bounds, draw_stated, in_cases, panels
from studies.study import Figure, Study, table, without_limits
from studies.trust.samples import CASES as SURFACES, measure_samples, report_samples
from studies.trust.scenes import CASES, QUICK, Case
from studies.trust.truth import MAPS, by_boundary_elements, by_pairs, by_range_of_adhesion, of_map
from studies.versus_bem.ensembles import side, write_map

_TOLD = ("contact", "model error", "trust", "warning")
_NAMES = {
    "exit_status": ("exit status of the run", "1"),
    "contact_fraction": ("summed contact area over the nominal area at closest approach", "1"),
    "model_error": ("model error at closest approach", "1"),
    "separation": ("separation at closest approach", "m"),
    "force": ("force of independent asperities at closest approach", "N"),
    "pull_off": ("pull-off force of independent asperities", "N"),
    "true_force": ("true force at closest approach, infinite in full contact", "N"),
    "scatter": ("standard error of the true force, of a mean over maps", "N"),
    "true_pull_off": ("true pull-off force", "N"),
    "radius_points": ("r.m.s. contact radius over the spacing of the grid of boundary elements", "1"),
}
_ORACLES = {
    "pairs": "asperities that feel each other in pairs",
    "boundary elements": "boundary elements",
    "map": "boundary elements on the map",
    "maps": "boundary elements, mean of Gaussian maps",
}


def carry_out(case: Case, folder: Path) -> dict[str, Any]:
    """Run a scene in a folder: return the numbers of ``_NAMES``, and what it printed on trust, or why it refused."""
    file, out = folder / "scene.toml", folder / "out.nc"
    file.write_text(tomli_w.dumps(case.scene))
    if case.oracle == "map" and case.surface is not None:
        write_map(case.surface.height(), case.surface.size, folder / "map.nc")
    done = CliRunner().invoke(main, ["run", str(file), "-o", str(out), "--fresh"])
    found: dict[str, Any] = dict.fromkeys(_NAMES, math.nan) | {"exit_status": done.exit_code}
    if done.exit_code:
        return found | {"printed": done.stderr.strip().splitlines()[-1]}
    with xr.open_dataset(out) as stored:
        result = stored.squeeze(drop=True).load()
    closest = int(np.argmin(result["separation"].to_numpy()))
    at = result.isel(step=closest)
    found |= {name: float(at[name]) for name in ("contact_fraction", "separation", "force")}
    found |= {"model_error": float(at["model_error_curve"]), "pull_off": float(result.get("pull_off_force", math.nan))}
    path, scene = result["separation"].to_numpy(), read(file)
    found |= _truth(case, scene, path[: closest + 1], float(path[-1]))
    size = case.surface.size if case.surface else math.sqrt(scene.asperities.nominal_area or math.nan)
    radius = size * math.sqrt(float(at["contact_fraction"] / (math.pi * at["contact_count"])))
    return found | {"radius_points": radius / found["radius_points"], "printed": "\n".join(_told(done.stdout))}


def _told(printed: str) -> list[str]:
    """Return the lines that say how far the force can be trusted."""
    name, found = "", []
    for line in printed.splitlines():
        name = line[:12].strip() or name
        if name in _TOLD:
            found.append(line)
    return found


def _truth(case: Case, scene: Scene, loading: Floats, end: float) -> dict[str, float]:
    """Return true forces [N], and the spacing of the grid [m] in place of the points of a radius."""
    modulus, work, separation = scene.effective_modulus, scene.work, float(loading[-1])
    if case.surface is not None:
        several = range(1, MAPS + 1) if case.oracle == "maps" else (1,)
        forces = of_map(case.surface, several, modulus, separation)
        scatter = float(np.std(forces, ddof=1)) / math.sqrt(len(forces)) if len(forces) > 1 else 0.0
        spacing = case.surface.size / (case.surface.points * case.surface.refined)
        return {"true_force": float(np.mean(forces)), "scatter": scatter, "radius_points": spacing}
    ensemble = rm.generate(scene.asperities, seed=scene.seed)  # with positions
    if case.oracle == "boundary elements":
        force = by_boundary_elements(ensemble, case.points, modulus, separation)
        return {"true_force": force, "scatter": 0.0, "radius_points": side(ensemble) / case.points}
    force, pull_off = by_pairs(ensemble, modulus, work, separation, end)
    if not work:
        return {"true_force": force, "scatter": 0.0}
    longer = by_range_of_adhesion(ensemble, modulus, work, loading)
    return {"true_force": force + longer, "scatter": 0.0, "true_pull_off": pull_off}


def measure(quick: bool) -> xr.Dataset:
    """Carry out all scenes, or a few small ones."""
    cases = [case for case in CASES if not quick or case.name in QUICK]
    with tempfile.TemporaryDirectory() as name, chdir(name), without_limits():
        found = [carry_out(case, Path(name)) for case in cases]
    words = {name: ("scene", [getattr(case, name) for case in cases]) for name in ("name", "oracle", "changes")}
    printed = {"printed": ("scene", [each["printed"] for each in found])}
    return xr.merge([xr.Dataset(in_cases(_NAMES, found, "scene"), words | printed), measure_samples(quick)])


def errors(result: xr.Dataset) -> Floats:
    """Return the true relative error of the force in each scene, 1 in full contact; NaN of those refused."""
    return np.asarray(np.abs(1.0 - result["force"] / result["true_force"]))


def draw(result: xr.Dataset) -> Figure:
    """Draw the model error over the true error, a point a scene."""
    figure, (panel,) = panels(7.2, 6.0, 1)
    error, stated, oracle = errors(result), result["model_error"].to_numpy(), result["oracle"].to_numpy()
    draw_stated(panel, error, stated, {words: oracle == name for name, words in _ORACLES.items()})
    for i in np.flatnonzero(np.isfinite(error)):
        name = str(result["name"].values[i])
        panel.annotate(name, (error[i], stated[i]), xytext=(6, -8), textcoords="offset points", fontsize=8)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the table of the scenes, the counts, and the lines that were printed."""
    error, stated = errors(result), result["model_error"].to_numpy()
    known = np.isfinite(error)
    bounded, within = bounds(error, stated)
    rows, printed = [], []
    for i, name in enumerate(result["name"].to_numpy().tolist()):
        lines = str(result["printed"].values[i]).splitlines()
        printed.append("\n".join([f"{name}:", *(f"    {line}" for line in lines)]))
        changes = f" ({result['changes'].values[i]})" if result["changes"].values[i] else ""
        if not known[i]:
            rows.append([name + changes, "", f"refused, exit status {result['exit_status'].values[i]:g}", *[""] * 5])
            continue
        trust = next((line[12:].strip() for line in lines if line.startswith("trust")), "")
        answers = ["yes" if part[i] else "no" for part in (bounded, within)]
        rows.append([name + changes, _percent(result["contact_fraction"].values[i]), trust, _percent(stated[i]),
                     _percent(error[i]), _ORACLES[str(result["oracle"].values[i])], *answers])  # fmt: skip
    head = ["scene", "contact", "trust", "model error", "true error", "by", "bounded", f"within a factor of {FACTOR:g}"]
    refused = int((~known).sum())
    off = np.abs(1.0 - result["pull_off"].to_numpy() / result["true_pull_off"].to_numpy())
    each = ", ".join(f"{_percent(off[i])} ({result['name'].values[i]})" for i in np.flatnonzero(np.isfinite(off)))
    return f"""The stated error of the force at closest approach, against the true one. In {int(known.sum())} scenes
with a force the model error bounds the true error in {int(bounded[known].sum())}, and is within a factor of
{FACTOR:g} of it in {int(within[known].sum())}; {refused} more {"is" if refused == 1 else "are"} refused.
{f"Pull-off forces are off by {each}, by pairs." if each else ""}

{table(head, rows)}

{report_samples(result)}
Printed:

{chr(10).join(printed)}
"""


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"


STUDY = Study(
    "trust", "How far the force can be trusted: stated and true errors", measure, draw, report,
    f"{len(QUICK)} of {len(CASES)} scenes; 12 of 50 samples of three surfaces in place of {len(SURFACES)}",
)  # fmt: skip
