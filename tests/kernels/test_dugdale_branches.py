"""Shapes whose branches under adhesion with a range are sought in long steps, as they have just one."""

from typing import Any

import numba
import numpy as np
import pytest

import roughmdr as rm
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile import build
from roughmdr.kernels.profile.layout import COUNT, FOOT, UNIT

pytestmark = pytest.mark.skipif(
    numba.config.DISABLE_JIT, reason="Python floats raise where compiled ones overflow to inf"
)
E = 3e9
SHAPES = [rm.Cone(slope=0.13), rm.Paraboloid(radius=4e-6), rm.Sphere(radius=4e-6)]


def test_they_are_those_of_the_kernels() -> None:
    assert {type(shape) for shape in SHAPES} == build._ONE_BRANCH


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
@pytest.mark.parametrize("control", [0.0, 1.0], ids=["fixed grips", "dead load"])
def test_it_is_unstable_below_the_foot_and_stable_above(shape: Any, control: float) -> None:
    """At states some ten times nearer to each other than the steps of the search."""
    rng = np.random.default_rng(7)
    width, rise, params = (np.asarray(part, dtype=np.float64)[None] for part in shape.nondimensional())
    law: Any
    for log_tabor, log_work in zip(rng.uniform(-2.0, 1.3, 40), rng.uniform(-3.0, 0.5, 40), strict=True):
        work = 10.0**log_work
        strength = 10.0**log_tabor / float(rm.tabor(shape, effective_modulus=E, work=work, strength=1.0))
        adhesion = Adhesion(work, "dugdale", strength)
        law = choose(shape.name, adhesion, params)
        row = law.prepare(law.material(E, adhesion), Columns(width, rise, params), 0, 1, control, 0.0)[0]
        foot = row[FOOT]
        assert row[COUNT] == 1.0
        for s in foot * np.linspace(0.01, 0.999, 100 if foot > 0.0 else 0):
            assert not law.control_at(s, row)[1] > 0.0, (work, strength, s / foot)
        for s in max(foot, 0.01) * (1.001 + np.geomspace(1e-4, 1e4, 250)):
            if s < 1.0 or law.mdr_profile((s - 1.0) * row[UNIT], row)[0] < 0.999 * law.end:
                assert law.control_at(s, row)[1] > 0.0, (work, strength, s, foot)
