"""The relative error of the force that each kernel states of itself: within the promised accuracy, and not below truth.

Promised are 1e-13 of the force at its state in closed form (DESIGN, accuracy), 1e-12 with adhesion of finite range.
"""

import math

import numpy as np
import pytest
from oracles.jkr import JkrPowerLaw
from oracles.multiprecision import mp

import roughmdr as rm
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.shapes.base import Shape

E, W = 4e6, 0.05
ROUNDING = 0.5 * np.finfo(float).eps
JKR = Adhesion(W)
DUGDALE = Adhesion(W, "dugdale", 5e5)
CASES = [
    (rm.Paraboloid(radius=5e-5), Adhesion(), 1.05e-13),
    (rm.Cone(slope=0.1), Adhesion(), 1.05e-13),
    (rm.PowerLaw(exponent=1.5, coefficient=30.0), Adhesion(), 1.05e-13),
    (rm.FlatPunch(radius=2e-6), Adhesion(), 1.05e-13),
    (rm.Paraboloid(radius=5e-5), JKR, 1.05e-13),
    (rm.Cone(slope=0.1), JKR, 1.05e-13),
    (rm.PowerLaw(exponent=1.5, coefficient=30.0), JKR, 1.05e-13),
    (rm.FlatPunch(radius=2e-6), JKR, 1.05e-13),
    (rm.FlatPunch(radius=2e-6), DUGDALE, 1.05e-12),
]
IDS = [f"{shape.name}, {adhesion.model if adhesion.work else 'elastic'}" for shape, adhesion, _ in CASES]


def exact_force(shape: Shape, adhesion: Adhesion, depth: float) -> float:
    """The force at an indentation, to 40 digits."""
    if isinstance(shape, rm.FlatPunch):
        return float(2 * mp.mpf(E) * mp.mpf(shape.radius) * mp.mpf(depth))
    oracle = JkrPowerLaw(shape, E, adhesion.work)
    return float(oracle.state(oracle.radius("indentation", mp.mpf(depth)))["force"])


@pytest.mark.parametrize(("shape", "adhesion", "promised"), CASES, ids=IDS)
def test_a_kernel_states_more_than_a_few_roundings_and_no_more_than_is_promised(
    shape: Shape, adhesion: Adhesion, promised: float
) -> None:
    params = np.atleast_2d(shape.nondimensional()[2])
    kernels = choose(shape.name, adhesion, params)
    own = params[0] if kernels.iterative or kernels.one_by_one else params[0, 0]
    of_force, _ = kernels.relative_errors(own)
    assert 8.0 * ROUNDING < of_force <= promised


@pytest.mark.parametrize(("shape", "adhesion", "promised"), CASES[:-1], ids=IDS[:-1])
def test_the_force_is_as_right_as_that_where_nothing_else_is_lost(
    shape: Shape, adhesion: Adhesion, promised: float
) -> None:
    """Deep in contact, where neither the indentation nor the fold takes digits."""
    for depth in (3.1e-7, 1.7e-6, 2.9e-5):
        law = rm.indent(shape, effective_modulus=E, work=adhesion.work, indentation=depth)
        assert float(law.force) == pytest.approx(exact_force(shape, adhesion, depth), rel=2.0 * promised, abs=0.0)
        assert math.isfinite(float(law.stiffness))
