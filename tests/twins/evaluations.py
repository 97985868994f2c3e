"""How often contacts are searched for and profiles or zones evaluated; to be called where nothing is compiled."""

import cProfile
import math
from typing import Any

import numpy as np

from roughmdr.aggregate.loop import sum_over_asperities
from roughmdr.aggregate.totals import FORCE
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile.layout import COUNT
from roughmdr.loading.staircase import no_memory, staircase
from roughmdr.shapes import SHAPES, Shape

MODULUS, WORK = 4e6, 0.05
EXAMPLES: dict[str, dict[str, float]] = {
    "cone": {"slope": 0.1},
    "power_law": {"exponent": 2.7, "width": 1e-5, "rise": 1e-6},
    "sphere": {"radius": 5e-5},
    "truncated_cone": {"slope": 0.1, "flat_radius": 2e-6},
    "truncated_paraboloid": {"radius": 5e-5, "flat_radius": 2e-6},
    "rounded_cone": {"slope": 0.1, "blend_radius": 5e-6},
    "capped_paraboloid": {"radius": 5e-5, "cap_radius": 9e-5, "blend_radius": 5e-6},
    "rounded_punch": {"flat_radius": 2e-6, "edge_radius": 5e-5},
}
_R = np.linspace(0.0, 4e-5, 30)
OTHERS: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": 5e-5},
    "tabulated": {"r": _R.tolist(), "f": (1e-2 * _R + 1e4 * _R**2).tolist()},
}
"""Shapes of which the zone has no such integrals: the first needs none, those of the second are found by quadrature."""
CONTACTS = 60
_ASPERITIES, _STEPS = 12, 25
_OF_PROFILE = "indentation_at", "radius_force_stiffness", "contact_near"
_OF_ZONE = "gap_integrals", "gap_integrals_closed"


def evaluations(name: str, strength: float, alike: int = 1) -> tuple[int, int, int]:
    """Count evaluations to prepare asperities that are all alike and for ``CONTACTS`` of the first, and how many of
    these were searched for.
    """
    shape: Shape = SHAPES[name](**EXAMPLES[name])
    width, rise, params = (np.full(alike, each) for each in shape.nondimensional())
    kernels = choose(name, Adhesion(WORK, "dugdale", strength), params)
    with np.errstate(all="ignore"):
        with cProfile.Profile() as preparing:
            material = kernels.material(MODULUS, Adhesion(WORK, "dugdale", strength))
            row = kernels.prepare(material, Columns(width, rise, params), 0, alike, 0.0, math.inf)[0]
        with cProfile.Profile() as solving:
            for x in np.geomspace(0.1, 1e3, CONTACTS).tolist():
                kernels.contact_at(x, float(row[COUNT]), row)
    once, each = _calls(preparing, "gap_integrals_closed"), _calls(solving, "gap_integrals_closed")
    return once, each, _calls(solving, "solve_on_branch")


def in_the_sum(name: str, work: float, strength: float) -> tuple[float, float, float]:
    """Count what the sum over asperities that differ in width calls on loading and unloading; work [J/m2], strength
    [Pa], inf for JKR.

    Return searches a contact and step, evaluations of the profile (or of the integrals over the zone) a contact and
    step, and those once an asperity. What is done once is told apart by paths of some steps and of twice as many.
    """
    shape: Shape = SHAPES[name](**(EXAMPLES | OTHERS)[name])
    chance = np.random.default_rng(3)
    height = np.sort(chance.normal(scale=1e-6, size=_ASPERITIES))[::-1].copy()
    width, rise, params = (np.repeat(np.asarray(each)[None], _ASPERITIES, axis=0) for each in shape.nondimensional())
    columns = Columns(width if shape.shared else width * chance.uniform(0.8, 1.2, _ASPERITIES), rise, params)
    adhesion = Adhesion(work, "dugdale", strength) if strength < math.inf else Adhesion(work)
    kernels, evaluated, counts = choose(name, adhesion, params), _OF_ZONE if adhesion.cohesive else _OF_PROFILE, []
    for steps in (_STEPS, 2 * _STEPS):
        loading = np.linspace(2e-6, -1e-6, steps)
        path = np.concatenate([loading, loading[::-1]])
        memory = staircase(path) if work else no_memory(path)
        with np.errstate(all="ignore"), cProfile.Profile() as profile:
            visits = sum_over_asperities(kernels, height, columns, MODULUS, adhesion, path, memory, {FORCE})[2]
        counts.append([visits, _calls(profile, "solve_on_branch"), _calls(profile, *evaluated)])
    visits, searches, calls = (fine - coarse for coarse, fine in zip(*counts, strict=True))
    each = calls / visits
    return searches / visits, each, (counts[0][2] - each * counts[0][0]) / _ASPERITIES


def _calls(profile: cProfile.Profile, *names: str) -> int:
    """Return how often functions of these names were called."""
    return sum(number for code, number, *_ in profile.getstats() if not isinstance(code, str) and code.co_name in names)
