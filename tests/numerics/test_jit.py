"""Loops that are handed their kernels."""

import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import FunctionType, ModuleType
from typing import Any

import numba
import pytest

from roughmdr.numerics.jit import as_argument, njit, once, specialise


class _Kernels(ModuleType):
    adhesive: bool
    offset: float
    function: Callable[[float], float]
    jump: Callable[[float], float]


kernel = _Kernels("kernel")


@njit
def _double(x: float) -> float:
    return 2.0 * x


@njit
def _square(x: float) -> float:
    return x * x


def _loop(x: float, count: int) -> float:
    total = 0.0
    for _ in range(count):
        total += kernel.function(x) + kernel.offset
        if kernel.adhesive:
            total -= kernel.jump(x)
    return total


def _filled(name: str, function: Callable[[float], float], offset: float) -> _Kernels:
    filled = _Kernels(name)
    filled.adhesive, filled.offset, filled.function = False, offset, function
    return filled


@pytest.mark.parametrize("x", [0.7, -3.25e-9, 4.5e12])
def test_each_namespace_of_kernels_has_a_loop_of_its_own(x: float) -> None:
    doubled, squared = (specialise(_loop, _filled(*of)) for of in (("double", _double, 0.5), ("square", _square, -2.0)))
    assert doubled(x, 1) == 2.0 * x + 0.5
    assert squared(x, 1) == x * x - 2.0
    assert doubled(x, 1) == 2.0 * x + 0.5


def test_a_branch_that_kernels_never_take_needs_no_kernel() -> None:
    """There is no ``jump``: it is not even compiled."""
    without = _filled("without_jump", _double, 0.0)
    assert not hasattr(without, "jump")
    assert specialise(_loop, without)(1.5, 3) == 9.0
    adhesive = _filled("with_jump", _double, 0.0)
    adhesive.adhesive, adhesive.jump = True, _square
    assert specialise(_loop, adhesive)(1.5, 3) == 9.0 - 3.0 * 1.5**2


@njit
def _twice(kernel: Callable[[float], float], x: float) -> float:
    return kernel(kernel(x))


def _overloads(function: object) -> list[object]:
    """The types for which a function is compiled in the form that Python calls."""
    return list(getattr(function, "overloads", ()))


@pytest.mark.parametrize("x", [0.7, -3.25e-9, 4.5e12])
def test_code_that_takes_functions_is_compiled_once_for_all(x: float) -> None:
    doubled, squared = as_argument(_double, x), as_argument(_square, x)
    assert _twice(doubled, x) == 4.0 * x
    before = len(_overloads(_twice))
    assert _twice(squared, x) == (x * x) * (x * x)
    assert len(_overloads(_twice)) == before
    assert as_argument(_double, 2.0 * x) is doubled


def test_a_function_is_compiled_for_python_only_if_that_calls_it() -> None:
    kernel = njit(FunctionType(_double.__code__, globals(), "kernel"))
    assert specialise(_loop, _filled("of_a_kernel", kernel, 0.25))(1.5, 2) == 6.5
    assert not _overloads(kernel)
    assert kernel(1.5) == 3.0
    assert len(_overloads(kernel)) == (0 if numba.config.DISABLE_JIT else 1)  # type: ignore[attr-defined]


def in_threads(make: Callable[[int], Any], count: int = 8) -> list[Any]:
    """Return the results of threads that begin together and take turns as often as Python lets them."""
    gate, interval = threading.Barrier(count), sys.getswitchinterval()

    def wait_and_make(number: int) -> Any:
        gate.wait()
        return make(number)

    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(count) as threads:
            return list(threads.map(wait_and_make, range(count)))
    finally:
        sys.setswitchinterval(interval)


def test_threads_may_specialise_at_once() -> None:
    """Python's parser of syntax trees fails with a SystemError where two threads are in it."""

    def specialised(number: int) -> list[object]:
        return [specialise(_loop, _filled(f"threads_{number}_{each}", _double, 1.0)) for each in range(10)]

    assert len({id(loop) for made in in_threads(specialised) for loop in made}) == 80


def test_what_is_made_once_is_made_once_by_threads() -> None:
    calls = []

    @once
    def make(number: int, *, twice: bool = False) -> object:
        calls.append(number)
        return make(number - 1, twice=twice) if number else object()

    assert len(set(map(id, in_threads(lambda _: make(3))))) == 1
    assert calls == [3, 2, 1, 0]
    assert make(3, twice=True) is not make(3)
