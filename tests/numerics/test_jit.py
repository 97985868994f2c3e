"""Loops that are handed their kernels."""

from collections.abc import Callable
from types import ModuleType

import pytest

from roughmdr.numerics.jit import njit, specialise


class _Law(ModuleType):
    adhesive: bool
    offset: float
    kernel: Callable[[float], float]
    jump: Callable[[float], float]


law = _Law("law")


@njit
def _double(x: float) -> float:
    return 2.0 * x


@njit
def _square(x: float) -> float:
    return x * x


def _loop(x: float, count: int) -> float:
    total = 0.0
    for _ in range(count):
        total += law.kernel(x) + law.offset
        if law.adhesive:
            total -= law.jump(x)
    return total


def _filled(name: str, kernel: Callable[[float], float], offset: float) -> _Law:
    filled = _Law(name)
    filled.adhesive, filled.offset, filled.kernel = False, offset, kernel
    return filled


@pytest.mark.parametrize("x", [0.7, -3.25e-9, 4.5e12])
def test_each_law_has_a_loop_of_its_own(x: float) -> None:
    doubled, squared = (specialise(_loop, _filled(*of)) for of in (("double", _double, 0.5), ("square", _square, -2.0)))
    assert doubled(x, 1) == 2.0 * x + 0.5
    assert squared(x, 1) == x * x - 2.0
    assert doubled(x, 1) == 2.0 * x + 0.5


def test_a_branch_that_a_law_never_takes_needs_no_kernel() -> None:
    """There is no ``jump``: it is not even compiled."""
    without = _filled("without_jump", _double, 0.0)
    assert not hasattr(without, "jump")
    assert specialise(_loop, without)(1.5, 3) == 9.0
    adhesive = _filled("with_jump", _double, 0.0)
    adhesive.adhesive, adhesive.jump = True, _square
    assert specialise(_loop, adhesive)(1.5, 3) == 9.0 - 3.0 * 1.5**2
