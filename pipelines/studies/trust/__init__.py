"""Each scene is run by the command line; its stated error is held against the error that its force has.

True forces are by boundary elements, or of paraboloids that feel each other in pairs. Pairs adhere as in JKR; the
difference that the range of adhesion makes is added from independent asperities.
"""

import math
import tempfile
from contextlib import chdir
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from oracles.boundary_elements import HeightMap
from oracles.pairwise import Paraboloids, periodic_green

import roughmdr as rm
from roughmdr.aggregate.tabor import ASSUMED_RANGE
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from studies.comparison import FACTOR, bounds, law_of, of_rows
from studies.study import Study, table, without_limits
from studies.traps import said_and_found
from studies.trust.samples import CASES as SURFACES, measure_samples, report_samples
from studies.trust.scenes import CASES, QUICK, Case
from studies.versus_bem.ensembles import distances, height_map, side, write_map

_NAMES = {
    "exit_status": ("exit status of the run", "1"),
    "contact_fraction": ("summed contact area over the nominal area at closest approach", "1"),
    "model_error": ("model error at closest approach", "1"),
    "force": ("force of independent asperities at closest approach", "N"),
    "true_force": ("true force at closest approach, infinite in full contact", "N"),
}
_ORACLES = {
    "pairs": "asperities that feel each other in pairs",
    "boundary elements": "boundary elements",
    "map": "boundary elements on the map",
    "maps": "boundary elements, mean of Gaussian maps",
}
_LIFTED = 0.3  # largest lift of the surface between contacts by their pressure, over the deepest overlap
_LOADING = 60  # steps of the path that pairs are taken along
MAPS = 5  # Gaussian maps whose mean force is compared with the expected law


def carry_out(case: Case, folder: Path) -> dict[str, Any]:
    """Run a scene in a folder: return the numbers of ``_NAMES``, and what it printed on trust, or why it refused."""
    if case.oracle == "map" and case.surface is not None:
        write_map(case.surface.height(), case.surface.size, folder / "map.nc")
    run, result = said_and_found(case.scene, folder)
    labels = {"name": case.name, "oracle": case.oracle, "changes": case.changes}
    found = dict.fromkeys(_NAMES, math.nan) | {"exit_status": run.exit_code} | labels
    if result is None:
        return found | {"printed": run.stderr.strip().splitlines()[-1]}
    result = result.squeeze(drop=True)
    separation = result["separation"].to_numpy()
    loading = separation[: int(np.argmin(separation)) + 1]
    at = result.isel(step=loading.size - 1)
    return found | {
        "contact_fraction": float(at["contact_fraction"]),
        "model_error": float(at["model_error_curve"]),
        "force": float(at["force"]),
        "true_force": true_force(case, read(folder / "scene.toml"), loading),
        "printed": next((line for line in run.stdout.splitlines() if line.startswith("trust ")), ""),
    }


def true_force(case: Case, scene: Scene, loading: Floats) -> float:
    """Return the true force [N] at the end of the loading."""
    modulus, work, separation = scene.effective_modulus, scene.work, float(loading[-1])
    if case.surface is not None:
        heights = map(case.surface.height, range(1, MAPS + 1 if case.oracle == "maps" else 2))
        maps = (HeightMap(refined(each, case.surface.refined), case.surface.size, modulus) for each in heights)
        return float(np.mean([each.press(separation).force for each in maps]))
    ensemble = rm.generate(scene.asperities, seed=scene.seed)  # with positions
    if case.oracle == "boundary elements":
        return by_boundary_elements(ensemble, case.points, modulus, separation)
    force = by_pairs(ensemble, modulus, work, separation)
    return force + by_range_of_adhesion(ensemble, modulus, work, loading) if work else force


def by_boundary_elements(ensemble: xr.Dataset, points: int, modulus: float, separation: float) -> float:
    """Return the force [N] of asperities at a separation [m]; infinite in full contact."""
    size = side(ensemble)
    return HeightMap(height_map(ensemble, points), size, modulus).press(separation).force


def refined(height: Floats, factor: int) -> Floats:
    """Return a periodic map, of as many points in both directions, with its waves on a grid finer by a whole factor."""
    waves = np.fft.fftshift(np.fft.fft2(height))
    added = height.shape[0] * (factor - 1) // 2
    return np.asarray(np.fft.ifft2(np.fft.ifftshift(np.pad(waves, added))).real * factor**2)


def by_pairs(ensemble: xr.Dataset, modulus: float, work: float, closest: float) -> float:
    """Return the force [N] of paraboloids at the closest separation [m], loaded from first touch on."""
    height, radius = (ensemble[name].to_numpy() for name in ("height", "radius"))
    flanks = height[:, None] - 0.5 * distances(ensemble) ** 2 / radius[:, None]
    high = height > closest - _LIFTED * (height.max() - closest)
    may_touch = high & ~(flanks > height).any(axis=0)  # tops below the flank of another never do
    x, y, height, radius = (ensemble[name].to_numpy()[may_touch] for name in ("x", "y", "height", "radius"))
    pressed = Paraboloids(height, radius, periodic_green(x, y, side(ensemble), modulus), modulus, work)
    return [pressed.press(float(h)).force for h in np.linspace(height.max(), closest, _LOADING)][-1]


def by_range_of_adhesion(ensemble: xr.Dataset, modulus: float, work: float, path: Floats) -> float:
    """Return how much more force [N] at closest approach an adhesion has that reaches as far as that of van der Waals.

    It is that of independent asperities, by Dugdale's model beside JKR.
    """
    law = partial(law_of, ensemble, separation=path, effective_modulus=modulus, work=work, variables="force")
    dugdale, jkr = law(adhesion="dugdale", range=ASSUMED_RANGE), law()
    return float(dugdale["force"][-1] - jkr["force"][-1])


def measure(quick: bool) -> xr.Dataset:
    """Carry out all scenes, or a few small ones."""
    cases = [case for case in CASES if not quick or case.name in QUICK]
    with tempfile.TemporaryDirectory() as name, chdir(name), without_limits():
        found = [carry_out(case, Path(name)) for case in cases]
    return xr.merge([of_rows(_NAMES, found, "scene"), measure_samples(quick)])


def errors(result: xr.Dataset) -> Floats:
    """Return the true relative error of the force in each scene, 1 in full contact; NaN of those refused."""
    return np.asarray(np.abs(1.0 - result["force"] / result["true_force"]))


def report(result: xr.Dataset) -> str:
    """Return the table of the scenes, and the counts."""
    error, stated = errors(result), result["model_error"].to_numpy()
    known = np.isfinite(error)
    bounded, within = bounds(error, stated)
    rows = []
    for i in range(result.sizes["scene"]):
        one = {name: result[name].values[i] for name in (*_NAMES, "name", "changes", "oracle", "printed")}
        name = f"{one['name']} ({one['changes']})" if one["changes"] else str(one["name"])
        if known[i]:
            answers = ["yes" if part[i] else "no" for part in (bounded, within)]
            shares = [_percent(one["contact_fraction"]), one["printed"][12:].strip(), _percent(stated[i])]
            rows.append([name, *shares, _percent(error[i]), _ORACLES[one["oracle"]], *answers])
        else:
            rows.append([name, "", f"refused, exit status {one['exit_status']:g}", *[""] * 5])
    head = ["scene", "contact", "trust", "model error", "true error", "by", "bounded", f"within a factor of {FACTOR:g}"]
    refused = int((~known).sum())
    return f"""The stated error of the force at closest approach, against the true one. In {int(known.sum())} scenes
with a force the model error bounds the true error in {int(bounded[known].sum())}, and is within a factor of
{FACTOR:g} of it in {int(within[known].sum())}; {refused} more {"is" if refused == 1 else "are"} refused.

{table(head, rows)}

{report_samples(result)}
"""


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"


STUDY = Study(
    "trust", "How far the force can be trusted: stated and true errors", measure, {}, report,
    f"{len(QUICK)} of {len(CASES)} scenes; 12 of 50 samples of three surfaces in place of {len(SURFACES)}",
)  # fmt: skip
