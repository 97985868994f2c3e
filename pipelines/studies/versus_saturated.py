"""Contacts that yield beside boundary elements whose pressure is at most the hardness, and the errors stated of them.

Asperities on a plane and summits of Gaussian maps are drawn at random. Elements feel each other, and what flows
vanishes (H. M. Stanley, T. Kato, J. Tribol. 119 (1997), 481). They are found by conjugate gradients with two bounds,
and of one map by Tamaas too, which is no part of the project: ``ROUGHMDR_TAMAAS`` in the environment holds a command
that runs a Python that has it.
"""

import math
import os
import shlex
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.spectral.section import SpectrumAsperities
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf
from studies.at_pressure import FRACTIONS, QUANTITIES, dataset_of, report as table_of, row_of
from studies.study import Study, in_two_processes, without_limits
from studies.versus_bem.ensembles import SIZE, Case, height_map

COMMAND = "ROUGHMDR_TAMAAS"
SEED = 2061  # seed of the surfaces; others, drawn alike, have set the constants
SURFACES = {False: 24, True: 2}  # number of surfaces in full and in reduced form
MODELS = ("mdr", "jackson-green", "kogut-etsion")
_MAP_HARDNESS = 0.01  # hardness of maps over E* [1], as metals have it
_GAP = 1e-5  # largest gap in contact, or overlap outside it, over the deepest overlap
_CHANGE = 0.02  # step of the separation for the stiffness, over the deepest overlap
_SEARCHED, _STEPS = 26, 400  # separations at which contact fractions are looked for; steps of a law
_LEAST_POINTS = 2.5  # least points of the grid a mean contact radius
_UNKNOWN = 0.01  # error of other quantities by boundary elements [1]
_SCRIPT = """import sys, numpy, tamaas
folder, most, mean = sys.argv[1:]
height = numpy.load(f"{folder}/height.npy")
model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], list(height.shape))
model.E, model.nu = 1.0, 0.0
solver = tamaas.KatoSaturated(model, height, 1e-4, float(most))
solver.max_iter = solver.dump_freq = 20000
solver.solve(float(mean))
numpy.save(f"{folder}/pressure.npy", model.traction.reshape(height.shape))
"""


class SaturatedElements(BoundaryElements):
    """Boundary elements of unit sides whose pressure is at most ``most`` [E*]."""

    def __init__(self, height: Floats, most: float) -> None:
        super().__init__(height, np.ones(2))
        self.most = most

    def press(self, separation: float) -> float:
        """Return the mean pressure at a separation, on from the pressures of the last one; NaN where none is found."""
        overlap = self.height - separation
        deepest, before, direction = float(overlap.max()), 0.0, np.zeros_like(overlap)
        for _ in range(5000):
            gap, full = self.displacement() - overlap, self.pressure >= self.most
            rest = np.where((self.pressure > 0.0) & ~full, gap, 0.0)
            if max(np.abs(rest).max(), gap[full].max(initial=0.0), -gap[~full].min()) <= _GAP * deepest:
                return float(self.pressure.mean())
            square = float(np.sum(rest * rest))
            direction = rest + (square / before if before > 0.0 else 0.0) * np.where(rest != 0.0, direction, 0.0)
            curvature = float(np.sum(direction * self._displaced(direction)))
            step = float(np.sum(rest * direction)) / curvature if curvature > 0.0 else self._cell_stiffness
            found = np.clip(self.pressure - step * direction, 0.0, self.most)
            hit = ((found == 0.0) & (gap < 0.0)) | ((found == self.most) & (gap > 0.0))
            self.pressure = np.clip(found - step * np.where(hit, gap, 0.0), 0.0, self.most)
            before = 0.0 if hit.any() else square
        return math.nan

    def area(self) -> float:
        """Return the contact fraction, with all of the edge cells that flow."""
        touches, flows = self.pressure > 0.0, self.pressure >= self.most * (1.0 - 1e-9)
        edges = np.array([touches & ~np.roll(touches, step, axis) for step in (1, -1) for axis in (0, 1)])
        partly = (edges & ~flows).sum() / max(edges.sum(), 1)
        return float(partly * self.patches().area + (1.0 - partly) * touches.mean())

    def quantities(self, separation: float) -> dict[str, float]:
        """Return quantities at a separation for E* = 1 and the unit side, and what tells their errors."""
        top, pressure = float(self.height.max()), self.press(separation)
        kept, area, patches = self.pressure, self.area(), self.patches()
        patch = BoundaryElements(np.where(kept > 0.0, 0.0, -np.inf), np.ones(2))
        changes = [step * _CHANGE * (top - separation) for step in (1.0, 2.0)]
        slopes = [(self.press(separation - each) - self.press(separation + each)) / (2.0 * each) for each in changes]
        self.pressure = kept
        points = math.sqrt(area / (math.pi * max(patches.contacts, 1))) * self.height.shape[0]
        conductance = 0.5 * patch.press(-1.0)
        found = (pressure, area, slopes[0], conductance, patches.radius_sum, separation)
        return dict(zip(QUANTITIES, found, strict=True)) | {"slope": slopes[1] / slopes[0] - 1.0, "points": points}

    def along(self) -> list[dict[str, float]]:
        """Return quantities about ``FRACTIONS``, where the grid resolves contacts."""
        top, reached = float(self.height.max()), [0.0]
        tried = top - (top - float(self.height.mean())) * np.linspace(0.0, 0.98, _SEARCHED) ** 1.3
        while reached[-1] < 1.3 * FRACTIONS[-1] and len(reached) < tried.size:
            self.press(tried[len(reached)])
            reached.append(max(float((self.pressure > 0.0).mean()), reached[-1]))
        asked = [fraction for fraction in FRACTIONS if fraction < reached[-1]]
        found = [self.quantities(float(np.interp(each, reached, tried[: len(reached)]))) for each in asked]
        return [each for each in found if each["points"] >= _LEAST_POINTS and np.isfinite([*each.values()]).all()]


def by_tamaas(elements: SaturatedElements, pressure: float, command: str) -> float:
    """Return the contact fraction by Tamaas at a pressure [E*]."""
    with TemporaryDirectory() as folder:
        np.save(f"{folder}/height.npy", elements.height)
        asked = (folder, f"{elements.most}", f"{pressure}")
        subprocess.run([*shlex.split(command), "-c", _SCRIPT, *asked], check=True, stdout=subprocess.DEVNULL)
        elements.pressure = np.load(f"{folder}/pressure.npy")
    return elements.area()


def draw_case(seed: int, number: int, folder: Path) -> tuple[dict[str, Any], Floats, float, float]:
    """Return asperities of a scene, the map [side], the side [m] and the hardness [E*]: of two one is a map."""
    chance, log = np.random.default_rng([seed, number]), np.log
    if number % 2:
        side, long, short = 1e-4, int(chance.choice([2, 3, 4])), int(chance.choice([12, 16, 24]))
        section: dict[str, Any] = {
            "source": "spectrum", "model": "summits", "patch": side, "hurst": float(chance.choice([0.3, 0.5, 0.8])),
            "long_wave": side / long, "short_wave": side / short, "points": 250 / short,
            "rms_slope": _MAP_HARDNESS * math.exp(chance.uniform(log(0.3), log(15.0))),
        }  # fmt: skip
        height = SpectrumAsperities.model_validate(section).height_map(number, 0).height
        return section, height / side, side, _MAP_HARDNESS
    placement = str(chance.choice(["random", "random", "hard_core 0.5", "hard_core 0.7", "square"]))
    shape, count = str(chance.choice(["paraboloid", "lognormal"])), int(chance.choice([36, 64, 100]))
    roughness, radius = np.exp(chance.uniform(log([0.03, 0.005]), log([1.0, 0.15]))).tolist()
    case = Case(placement, shape, count, roughness, 256, number)
    ensemble, file = case.generate(), folder / "asperities.nc"
    write_netcdf(Labelled.of(ensemble), file)
    hardness = 4.0 / (3.0 * math.pi) * radius * case.spacing  # first met at this contact radius over the spacing; R 1 m
    return {"source": "file", "file": str(file)}, height_map(ensemble, 256) / SIZE, SIZE, hardness


def compare(task: tuple[int, int]) -> list[dict[str, Any]]:
    """Return the errors of all models of a surface, by seed and number; of the first map the area by Tamaas too."""
    seed, number = task
    rows, command, other = list[dict[str, Any]](), os.environ.get(COMMAND, ""), math.nan
    with TemporaryDirectory() as folder, without_limits():
        section, height, side, hardness = draw_case(seed, number, Path(folder))
        elements = SaturatedElements(height, hardness)
        along = elements.along()
        truth = {name: np.array([each[name] for each in along]) for name in along[0]}
        if number == 1 and command:
            other = by_tamaas(elements, truth["pressure"][-1], command) / truth["contact_fraction"][-1] - 1.0
        points, slope = truth.pop("points"), truth.pop("slope")
        truth |= {name: side * truth[name] for name in QUANTITIES[2:]}
        unknown = dict.fromkeys(QUANTITIES, np.full(points.size, _UNKNOWN)) | {"stiffness": np.abs(slope)}
        unknown |= dict.fromkeys(("contact_fraction", "contact_radius_sum"), 0.06 / points)
        h = truth["separation"]
        path = np.linspace(2.0 * h[0] - h[-1], h[-1] - 0.15 * (h[0] - h[-1]), _STEPS)
        scene = {
            "title": "Contacts that yield", "seed": number, "material": {"modulus": 0.91, "poisson": 0.3},
            "path": {"separation": path.tolist()}, "output": {"variables": ["force", "contact_area", *QUANTITIES[2:5]]},
        }  # fmt: skip
        for model in MODELS:
            law = rm.run(scene | {"asperities": section, "plasticity": {"hardness": hardness, "model": model}})
            labels = {"group": "summits" if number % 2 else "asperities", "model": model, "surface": number}
            rows.append(labels | row_of(law.isel(realization=0), truth, unknown, side) | {"tamaas": other})
    return rows


def measure(quick: bool) -> xr.Dataset:
    """Compare all surfaces, or two."""
    tasks = [(SEED, number) for number in range(SURFACES[quick])]
    rows = [row for part in in_two_processes(compare, tasks) for row in part]
    return dataset_of(rows).assign_attrs(tamaas=float(np.fmax.reduce([row["tamaas"] for row in rows])))


def report(result: xr.Dataset) -> str:
    """Return how large errors are and how the stated ones do, and the area by Tamaas."""
    other = result.attrs["tamaas"]
    told = f"No {COMMAND} is set." if math.isnan(other) else f"Tamaas finds {100.0 * other:+.2g} % of area on one map."
    return f"{told} {table_of(result)}"


STUDY = Study(
    "versus_saturated", "Contacts that yield and saturated elements", measure, {}, report,
    f"{SURFACES[True]} of {SURFACES[False]} surfaces",
)  # fmt: skip
