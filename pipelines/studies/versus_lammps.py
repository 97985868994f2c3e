"""Spheres that yield, pressed on a plane wall and drawn off step by step by LAMMPS's granular model ``mdr``.

LAMMPS is no part of the project: ``ROUGHMDR_LAMMPS`` in the environment holds a command that runs it. Its sphere grows
as it flows, which rows tell, and its factor for walls is taken out of its forces.
"""

import math
import os
import shlex
import subprocess
from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from roughmdr.stages.plastic import mdr
from roughmdr.stages.plastic.body import LIMIT, RADIUS, ROWS, Body, Mark, State
from studies.study import Study, named, table

COMMAND = "ROUGHMDR_LAMMPS"
_R, _E = 1e6, 1e9
"""Radius [m] and E* [Pa]: LAMMPS holds lengths to 1e-10 m only."""
_SCRIPT = """atom_style sphere 1
atom_modify map array
newton off
comm_modify vel yes
region box block -4e6 4e6 -4e6 4e6 -4e6 4e6
create_box 1 box
create_atoms 1 single 0 0 2e6
set atom 1 diameter 2e6 density 1e3
variable r atom radius
pair_style granular
pair_coeff * * {0}
region wall plane 0 0 0 0 0 1 side in
fix wall all wall/gran/region granular {0} region wall
"""
_MODEL = "mdr {:.17g} {} {:.17g} {:.17g} 0.5 0.5 tangential linear_nohistory 0 0 damping mdr 1"
_STEP = 'set atom 1 z {:.17g}\nrun 1 post no\nprint "state $(v_r[1]:%.17g) $(fz[1]:%.17g)"\n'
_DRAWN = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.87, 0.93, 0.97, 0.99, 0.995, 1.005, 1.1)
"""Rises over that at which contact is lost."""


class Case(NamedTuple):
    """E*/Y, Poisson's ratio, the depth d/R to which a sphere is pressed, and l(a_max) over A/2 there."""

    ratio: float
    poisson: float = 0.3
    depth: float = 4e-3
    reach: float = 0.0

    def body(self) -> Body:
        """Return the constants of the sphere, whose work of adhesion follows from its reach."""
        dry = Body(_E, _E / self.ratio, 0.0, self.poisson, 0.5 * _E * (1.0 - self.poisson), 1.0)
        b, height, _ = contact(dry, _R, self.depth * _R, 0.0)[1]
        return dry._replace(work=(self.reach * height) ** 2 * _E / (2.0 * math.pi * b))


CASES = (
    *(Case(200.0 * 10.0**n, nu) for nu in (0.0, 0.3, 0.49) for n in range(7)),
    *(Case(ratio, reach=reach) for ratio in (2e3, 2e5, 2e8) for reach in (0.03, 0.1, 0.3, 1.0, 3.0)),
    *(Case(2e3, depth=depth) for depth in (1e-3, 2e-2)),
)


def contact(body: Body, radius: float, d: float, u: float) -> tuple[State, Mark, Floats, tuple[float, float]]:
    """Return the contact at a rise ``u`` above the largest indentation ``d`` [m], its mark, numbers and ends.

    It yields where one without adhesion does, as in LAMMPS.
    """
    asperity, kernels = np.zeros(ROWS), mdr.kernels(adhesive=body.work > 0.0)
    asperity[RADIUS] = radius
    kernels.prepare(asperity, body._replace(work=0.0))
    mark = kernels.mark(d, asperity, body)
    return kernels.state(d - u, u, mark, asperity, body), mark, asperity, kernels.ends(d, mark, asperity, body)


def follow(case: Case, command: str) -> Floats:
    """Return rows of radius, largest overlap and rise [m], and force [N], on two ways down and up, by LAMMPS."""
    body, heights, kept = case.body(), list[float](), list[int]()
    yields, depth = float(contact(body, _R, _R, 0.0)[2][LIMIT]), case.depth * _R
    first, last = np.geomspace(yields * (1 + 1e-7), depth / 2, 400), np.linspace(depth / 2, depth, 100)
    for down, drawn in (([yields / 2, *first], (*_DRAWN[:10:2], *_DRAWN[9::-4])), (last, _DRAWN)):
        heights += [_R - d for d in down]
        lost = contact(body, _R, down[-1], 0.0)[3][1]
        kept += [len(heights) - back for back in (81, 41, 1)] + list(range(len(heights), len(heights) + len(drawn)))
        heights += [heights[-1] + part * lost for part in drawn]
    model = _MODEL.format(_E * (1.0 - case.poisson**2), case.poisson, body.yield_strength, body.work)
    script = _SCRIPT.format(model) + "".join(map(_STEP.format, heights))
    done = subprocess.run(shlex.split(f"{command} -log none"), input=script, text=True, capture_output=True, check=True)
    said = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("state ")]
    (radius, force), z = np.array(said, dtype=float).T, np.array(heights)
    deepest = np.maximum.accumulate(radius - z)
    rows = (radius, deepest, deepest - radius + z, force / (1.0 + np.exp(10.7 * (1.0 - z / _R) - 10.0)))
    return np.transpose(rows)[kept]


def compare(body: Body, rows: Floats) -> Floats:
    """Return errors of LAMMPS's forces over the force of flow.

    Under adhesion LAMMPS presses without, pins 0.98 to 0.99 a_max and peels for good: NaN where that matters.
    """
    errors, before = np.full(len(rows), np.nan), 0.0
    for i, (radius, d, u, force) in enumerate(rows):
        own, (b, height, _), _, (_, lost) = contact(body, radius, d, u)
        flow = 0.5 * math.pi * b * height * body.effective_modulus
        if b > 0.0 and (body.work == 0.0 or u == 0.0 or (u > before and own.radius < 0.98 * b)):
            errors[i] = (force - (own.force if u < lost else 0.0)) / flow
        before = u
    return errors


def measure(quick: bool) -> xr.Dataset:
    """Compare all cases; nothing where LAMMPS is not there."""
    command, found = os.environ.get(COMMAND), [np.empty((6, 0))]
    for case in (CASES[1::14] if quick else CASES) if command else ():
        rows = follow(case, command or "")
        fixed = rows - (rows[:, :1] - _R) * [1.0, 1.0, 0.0, 0.0]
        errors = [compare(case.body(), each) for each in (rows, fixed)]
        found.append(np.array([*errors, *(np.full(len(rows), number) for number in case)]))
    words = ("error of LAMMPS's force over that of flow", "error where the sphere does not grow", *Case._fields)
    names, numbers = ("error", "fixed_error", *Case._fields), np.concatenate(found, axis=1)
    return xr.Dataset({name: ("state", own, named(of)) for name, of, own in zip(names, words, numbers, strict=True)})


def report(result: xr.Dataset) -> str:
    """Say how far LAMMPS is off, by adhesion and depth."""
    if result.sizes["state"] == 0:
        return f"LAMMPS was left out: the environment variable {COMMAND} holds no command that runs it."
    rows = []
    for (reach, depth), own in result.groupby(["reach", "depth"]):
        largest = (f"{float(abs(own[name]).max()):.1e}" for name in ("error", "fixed_error"))
        rows.append([f"{reach:g}", f"{depth:g}", str(int(own["error"].count())), *largest])
    return table(["l(a_max) over A/2", "d/R", "states", "largest difference", "if the sphere did not grow"], rows)


STUDY = Study("versus_lammps", "Spheres that yield beside LAMMPS", measure, {}, report, "3 of 38 cases")
