"""Summits that yield beside boundary elements whose pressure is at most the hardness, by Tamaas.

Tamaas is no part of the project: ``ROUGHMDR_TAMAAS`` in the environment holds a command that runs a Python that has it.
Its elements feel each other, and what flows vanishes (H. M. Stanley, T. Kato, J. Tribol. 119 (1997), 481).
"""

import os
import shlex
import subprocess
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.spectral.section import SpectrumAsperities
from roughmdr.numerics.arguments import Floats
from studies.comparison import panels
from studies.study import Figure, Study, named, table, without_limits

COMMAND = "ROUGHMDR_TAMAAS"
CASES = [(waves, slope) for waves in ((2, 16), (2, 32), (4, 16), (4, 32), (3, 24)) for slope in (0.5, 1.0, 3.0, 10.0)]
"""Longest and shortest waves along the side of a map, and E* times its r.m.s. slope over the hardness [1]."""
SOLVERS = ("saturated elements", "Bowden and Tabor", "mdr", "jackson-green", "elastic summits", "elastic elements")
_PRESSURES = np.array([0.005, 0.02, 0.05, 0.15])  # pressures over the hardness [1]
_SIDE, _HARDNESS, _MODULUS = 1e-4, 1e9, 1e11  # side of a map [m]; H and E* [Pa] as metals have them
_SCRIPT = """import sys, numpy, tamaas
folder, most, *means = sys.argv[1:]
height, found = numpy.load(f"{folder}/height.npy"), []
model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], list(height.shape))
model.E, model.nu = 1.0, 0.0
for mean in means:
    model.traction[:] = 0.0
    solver = tamaas.KatoSaturated(model, height, 1e-4, float(most))
    solver.max_iter = solver.dump_freq = 20000
    solver.solve(float(mean))
    found.append(model.traction.reshape(height.shape).copy())
numpy.save(f"{folder}/pressure.npy", found)
"""


def saturated(height: Floats, most: float, command: str) -> list[float]:
    """Return contact fractions by Tamaas, with all of the edge cells that flow; heights [side], hardness [E*]."""
    grid, areas = BoundaryElements(height, np.ones(2)), []
    with TemporaryDirectory() as folder:
        np.save(f"{folder}/height.npy", height)
        asked = map(str, (folder, most, *(_PRESSURES * most).tolist()))
        subprocess.run([*shlex.split(command), "-c", _SCRIPT, *asked], check=True)
        solved = np.load(f"{folder}/pressure.npy")
    for grid.pressure in solved:
        gap, flows, touches = grid.displacement() - height, grid.pressure >= most * (1.0 - 1e-9), grid.pressure > 0.0
        gap -= gap[touches & ~flows].mean()
        assert np.where(flows, gap, np.where(touches, abs(gap), -gap)).max() < 0.01 * height.std(), "no solution"
        edges = np.array([touches & ~np.roll(touches, step, axis) for step in (1, -1) for axis in (0, 1)])
        partly = (edges & ~flows).sum() / edges.sum()
        areas.append(partly * grid.patches().area + (1.0 - partly) * float(touches.mean()))
    return areas


def compare(waves: tuple[int, int], slope: float, command: str) -> Floats:
    """Return contact fractions of a map: [solver, pressure]."""
    scene: dict[str, Any] = {
        "title": "Summits that yield", "seed": 7, "output": {"variables": ["contact_fraction"]}, "asperities": {
            "source": "spectrum", "model": "summits", "patch": _SIDE, "hurst": 0.8, "long_wave": _SIDE / waves[0],
            "short_wave": _SIDE / waves[1], "points": 250 / waves[1], "rms_slope": slope * _HARDNESS / _MODULUS,
        }, "material": {"modulus": 0.91 * _MODULUS, "poisson": 0.3}, "path": {"pressure": list(_PRESSURES * _HARDNESS)},
    }  # fmt: skip
    laws = [rm.run(scene | {"plasticity": {"hardness": _HARDNESS, "model": model}}) for model in SOLVERS[2:4]]
    laws.append(rm.run(scene | {"reference": {"model": "boundary_elements"}}))
    height = SpectrumAsperities.model_validate(scene["asperities"]).height_map(7, 0).height / _SIDE
    found = np.empty((len(SOLVERS), _PRESSURES.size))
    found[:2] = saturated(height, _HARDNESS / _MODULUS, command), _PRESSURES
    found[2:5] = [law["contact_fraction"][0] for law in laws]
    found[5] = laws[-1]["reference_contact_fraction"][0]
    return found


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or one; nothing where Tamaas is not there."""
    command = os.environ.get(COMMAND, "")
    cases = CASES[: (1 if quick else None) if command else 0]
    with without_limits():
        found = np.reshape([compare(*case, command) for case in cases], (-1, len(SOLVERS), _PRESSURES.size))
    numbers = {"area": (("case", "solver", "pressure"), found)}
    slope = ("case", [each for _, each in cases], named("E* times the r.m.s. slope over the hardness"))
    return xr.Dataset(numbers, {"solver": list(SOLVERS), "slope": slope, "pressure": _PRESSURES})


def draw(result: xr.Dataset) -> Figure:
    """Draw contact fractions over those of saturated elements, solvers beside each other."""
    figure, (panel,) = panels(8.0, 5.0, 1)
    true, slope = result["area"].sel(solver=SOLVERS[0]), result["slope"].to_numpy()
    for i, name in enumerate(SOLVERS[1:]):
        over = 100.0 * (result["area"].sel(solver=name) / true - 1.0)
        panel.semilogx(slope * 1.06 ** (i - 2), over, "_os1x"[i], color=f"C{i}", mfc="none", label=[name, *[""] * 3])
    panel.set(xlabel="E* times r.m.s. slope over hardness", ylabel="contact area over saturated elements, less 1 [%]")
    panel.legend()
    return figure


def report(result: xr.Dataset) -> str:
    """Return differences of areas by slope."""
    if not result.sizes["case"]:
        return f"Tamaas was left out: the environment variable {COMMAND} holds no command of a Python that has it."
    area = {name: result["area"].sel(solver=name, drop=True) for name in SOLVERS}
    off = xr.Dataset({name: each / area[SOLVERS[0]] - 1.0 for name, each in area.items()}).drop_vars(SOLVERS[0])
    off["elastic summits over elements"] = area[SOLVERS[4]] / area[SOLVERS[5]] - 1.0
    rows = []
    for slope, part in [("all", off), *off.groupby("slope")]:
        cells = (100.0 * np.quantile(each, [0.5, 0.0, 1.0]) for each in part.values())
        rows.append([f"{slope}", *("{:+.0f} % ({:+.0f} to {:+.0f})".format(*each) for each in cells)])
    return f"""Contact areas at given pressure over those of saturated elements, less 1, by E* times the slope over H:

{table(["slope", *map(str, off)], rows)}"""


STUDY = Study("versus_saturated", "Summits that yield and saturated elements", measure, draw, report, "1 of 20 cases")
