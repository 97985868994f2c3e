"""A scalar kernel over an array."""

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, cast

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import specialise

_kernel: Callable[..., Any]  # the name that ``specialise`` fills


def _loop(values: Floats, arguments: tuple[Any, ...], out: Floats) -> None:
    for i in range(values.size):
        out[i] = _kernel(values[i], *arguments)


def _loop_of_three(values: Floats, arguments: tuple[Any, ...], out: Floats) -> None:
    for i in range(values.size):
        out[0, i], out[1, i], out[2, i] = _kernel(values[i], *arguments)


@cache
def _compiled(loop: Callable[..., None], kernel: Callable[..., Any]) -> Callable[..., Any]:
    owner = kernel.__module__.rpartition(".")[2]
    return specialise(cast(FunctionType, loop), f"{owner}_{kernel.__qualname__}", {"_kernel": kernel})


def apply(kernel: Callable[..., float], values: Floats, *arguments: object) -> Floats:
    """``kernel(value, *arguments)`` for each of a one-dimensional array of values."""
    out = np.empty_like(values)
    _compiled(_loop, kernel)(values, arguments, out)
    return out


def apply_all(kernel: Callable[..., tuple[float, float, float]], values: Floats, *arguments: object) -> Floats:
    """The same for a kernel of three results, which come as the rows of an array."""
    out = np.empty((3, values.size))
    _compiled(_loop_of_three, kernel)(values, arguments, out)
    return out
