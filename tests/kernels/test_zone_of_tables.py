"""The integrals over the cohesive zone of tables, by few nodes on each piece, against adaptive quadrature."""

import math
from itertools import pairwise

import numpy as np
import pytest
from forms import large_where_compiled
from scipy.integrate import quad

import roughmdr as rm
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import ProfileShape

EVEN, WIDE = np.linspace(0.0, 8e-6, 9), np.append(0.0, np.geomspace(2e-10, 8e-6, 5))
SHAPES = {
    "even table": rm.Tabulated(r=EVEN, f=0.02 * EVEN + 2e4 * EVEN**2),
    "wide table": rm.Tabulated(r=WIDE, f=2e4 * WIDE**2),
    "even MDR table": rm.MdrTable(a=EVEN[1:], g=EVEN[1:] ** 1.7),
    "wide MDR table": rm.MdrTable(a=WIDE[1:], g=WIDE[1:] ** 1.2),
}


def kernels_of(shape: ProfileShape) -> tuple[ProfileKernels, Floats]:
    params = np.asarray(shape.nondimensional()[2])
    kernels = choose(shape.name, Adhesion(0.05, "dugdale", 1e6), params[None])
    assert isinstance(kernels, ProfileKernels)
    return kernels, np.append(params, np.zeros(-kernels.first_node))  # all that the integrals read


def by_quadrature(kernels: ProfileKernels, row: Floats, a: float, c: float) -> Floats:
    """J, K and L from knot to knot, over angles packed to where a piece begins: there g' begins like a root."""
    g = kernels.mdr_profile(a, row)[2]

    def term(z: float, kind: int, begin: float, end: float) -> float:
        angle = begin + (end - begin) * z * z
        x = c * math.sin(angle)
        _, _, value, slope = kernels.mdr_profile(x, row)
        terms = value - g, x * slope, (value - g) * (c * math.cos(angle)) ** 2
        return 2.0 * z * (end - begin) * terms[kind]

    knots = [kernels.breakpoint(i, row)[0] for i in range(kernels.breakpoint_count(row))]
    angles = [math.asin(x / c) for x in (a, *(knot for knot in knots if a < knot < c), c)]
    found = np.zeros(3)
    for kind in range(3):
        for ends in pairwise(angles):
            found[kind] += quad(term, 0.0, 1.0, (kind, *ends), epsabs=0.0, epsrel=1e-12, limit=400)[0]
    return found


@large_where_compiled
@pytest.mark.few(2)
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("wide", [0.03, 1.0, 30.0])
def test_they_are_the_integrals(name: str, wide: float) -> None:
    kernels, row = kernels_of(SHAPES[name])
    last = kernels.breakpoint(kernels.breakpoint_count(row) - 1, row)[0]
    for a in np.array([0.01, 0.2, 0.7]) * last:
        found = kernels.zone_quadrature(a, kernels.mdr_profile(a, row)[2], wide * a, row)
        np.testing.assert_allclose(found, by_quadrature(kernels, row, a, math.hypot(a, wide * a)), rtol=1e-11)
