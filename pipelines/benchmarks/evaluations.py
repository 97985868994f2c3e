"""How often the integrals over a cohesive zone are evaluated; to be called where nothing is compiled."""

import cProfile
import math

import numpy as np

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns, Material
from roughmdr.kernels.profile.layout import COUNT
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
CONTACTS = 60


def evaluations(name: str, strength: float, alike: int = 1) -> tuple[int, int, int]:
    """Count evaluations to prepare asperities that are all alike and for ``CONTACTS`` of the first, and how many of
    these were searched for.
    """
    shape: Shape = SHAPES[name](**EXAMPLES[name])
    width, rise, params = (np.full(alike, each) for each in shape.nondimensional())
    kernels = choose(name, Adhesion(WORK, "dugdale", strength), params)
    with np.errstate(all="ignore"):
        with cProfile.Profile() as preparing:
            row = kernels.prepare(
                Material(MODULUS, WORK, strength), Columns(width, rise, params), 0, alike, 0.0, math.inf
            )[0]
        with cProfile.Profile() as solving:
            for x in np.geomspace(0.1, 1e3, CONTACTS).tolist():
                kernels.contact_at(x, float(row[COUNT]), row)
    once, each = _calls(preparing, "gap_integrals_closed"), _calls(solving, "gap_integrals_closed")
    return once, each, _calls(solving, "solve_on_branch")


def _calls(profile: cProfile.Profile, name: str) -> int:
    """Return how often functions of a name were called."""
    return sum(number for code, number, *_ in profile.getstats() if not isinstance(code, str) and code.co_name == name)
