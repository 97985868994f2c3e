"""The errors that [reference] states by its grid, against grids four times as fine along each side."""

from itertools import product
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.path import solve_on_grid
from roughmdr.elements.surface import grid_shape, surface_of
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.scene.read import read
from studies.comparison import HELD, held
from studies.study import table

_WAVES = {"source": "spectrum", "patch": "100 um", "long_wave": "50 um", "rms_slope": 0.02}
_HEIGHT = {"distribution": "normal", "std": "20 nm"}
_CROWD = {"source": "random", "placement": "random", "patch": "100 um", "height": _HEIGHT}
SURFACES: tuple[tuple[dict[str, Any], str, str], ...] = (
    (_WAVES | {"hurst": 0.8, "short_wave": "20 um"}, "2.2 sigma", "0.9 sigma"),
    (_WAVES | {"hurst": 0.5, "short_wave": "14 um"}, "2.2 sigma", "0.9 sigma"),
    (_CROWD | {"shape": "paraboloid", "count": 12, "radius": "1 mm"}, "0.6 sigma", "-1.4 sigma"),
    (_CROWD | {"shape": "cone", "count": 20, "slope": 0.004}, "0.6 sigma", "-1.4 sigma"),
)
"""Asperities, and first and last separation, with 10 to 20 % in contact at the last."""
_ERRORS, _SEEDS = (0.2, 0.05, 0.02), (1, 2)
_FINER, _LEAST, _MOST = 4, 0.003, 0.2  # refinement, and contact fractions
_E = 1e9  # effective modulus [Pa]


def measure_grids(quick: bool) -> xr.Dataset:
    """Press surfaces, periodic and alone, on the grid of a [reference] and on a finer one."""
    few = 1 if quick else None
    cases = product(SURFACES, ("periodic", "free"), _ERRORS[:few], _SEEDS[:few])
    parts = [measure_case(*case) for case in cases]
    return xr.concat(parts, "grid_read").assign(references=len(parts))


def measure_case(surface: tuple[dict[str, Any], str, str], boundary: str, error: float, seed: int) -> xr.Dataset:
    """Return true and stated relative errors at given separation and force."""
    asperities, start, stop = surface
    scene = {
        "title": "grid", "seed": seed, "material": {"effective_modulus": _E}, "asperities": asperities,
        "interaction": {"model": "pairwise", "boundary": boundary},
        "path": {"separation": {"start": start, "stop": stop, "steps": 8}},
        "reference": {"model": "boundary_elements", "error": error},
    }  # fmt: skip
    result = rm.run(scene).isel(realization=0)
    fraction = (result.reference_contact_area / result.nominal_area).to_numpy()
    told = (fraction > _LEAST) & (fraction < _MOST)
    h, force = result.separation.to_numpy(), result.reference_force.to_numpy()[told]
    ensemble = Ensemble.from_dataset(rm.generate(asperities, seed=seed))
    height_map = read(scene).asperities.height_map(seed, 0)
    pressed = surface_of(ensemble, height_map, float(h.min()), periodic=boundary == "periodic")
    shape = grid_shape(pressed.sides, _FINER * float(result.reference_points) ** 0.5)
    steps = solve_on_grid(pressed, h[told], _E, shape, stiffness=True).steps
    fine = np.array([(step.force, step.area, step.stiffness) for step in steps]).T
    at_same_force = fine * (force / fine[0]) ** (np.gradient(np.log(fine), axis=1) / np.gradient(np.log(fine[0])))
    found: dict[str, Any] = {}
    for given, at, true in (
        ("separation", result.roughmdr.at_separation(h[told]), fine),
        ("force", result.roughmdr.at_force(force, reference=True), at_same_force),
    ):
        for name, exact in zip(("force", "contact_area", "stiffness"), true, strict=True):
            if name != given:
                numbers = np.array([abs(at[f"reference_{name}"] - exact), at[f"reference_{name}_error"]])
                found[f"grid_{name}_at_{given}"] = (("kind", "grid_read"), numbers / exact)
    return xr.Dataset(found, {"kind": ["true", "stated"]})


def report_grids(result: xr.Dataset) -> str:
    """Return how often the errors that a reference states hold."""
    rows = []
    for name in [str(each) for each in result if str(each).startswith("grid_")]:
        true, stated = result[name].to_numpy()
        sizes = [f"{100.0 * size:.1f} %" for size in (np.sqrt(np.mean(true**2)), np.median(stated))]
        rows.append([name[5:].replace("_at_", " at given ").replace("_", " "), *sizes, *held(true, stated)])
    found = table(["", "true, r.m.s.", "stated, median", *HELD], rows)
    return (
        f"Boundary elements of [reference], {int(result['references'])} cases, grids {_FINER} times as fine:\n\n{found}"
    )
