"""A scalar kernel over an array."""

from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise


class _Kernel(ModuleType):
    """One kernel, by the name by which the loops call it."""

    function: Callable[..., Any]


kernel = _Kernel("kernel")


def _loop(values: Floats, arguments: tuple[Any, ...], out: Floats) -> None:
    for i in range(values.size):
        out[i] = kernel.function(values[i], *arguments)


def _loop_of_three(values: Floats, arguments: tuple[Any, ...], out: Floats) -> None:
    for i in range(values.size):
        out[0, i], out[1, i], out[2, i] = kernel.function(values[i], *arguments)


@once
def _compiled(loop: FunctionType, kernel: Callable[..., Any]) -> Callable[..., Any]:
    one = _Kernel(f"{kernel.__module__.removeprefix('roughmdr.')}_{kernel.__qualname__}".replace(".", "_"))
    one.function = kernel
    return specialise(loop, one)


def apply(kernel: Callable[..., float], values: Floats, *arguments: object) -> Floats:
    """Return ``kernel(value, *arguments)`` for each of a one-dimensional array of values."""
    out = np.empty_like(values)
    _compiled(_loop, kernel)(values, arguments, out)
    return out


def apply_all(kernel: Callable[..., tuple[float, float, float]], values: Floats, *arguments: object) -> Floats:
    """Return the three results of ``kernel(value, *arguments)`` for each value, [result, value]."""
    out = np.empty((3, values.size))
    _compiled(_loop_of_three, kernel)(values, arguments, out)
    return out
