"""A scalar kernel over an array."""

from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, cast

import numpy as np

from roughmdr._jit import specialise
from roughmdr.arguments import Floats

_kernel: Callable[..., float]  # the name that ``specialise`` fills


def _loop(values: Floats, arguments: tuple[Any, ...], out: Floats) -> None:
    for i in range(values.size):
        out[i] = _kernel(values[i], *arguments)


@cache
def _compiled(kernel: Callable[..., float]) -> Callable[..., Any]:
    owner = kernel.__module__.rpartition(".")[2]
    return specialise(cast(FunctionType, _loop), f"{owner}_{kernel.__qualname__}", {"_kernel": kernel})


def apply(kernel: Callable[..., float], values: Floats, *arguments: object) -> Floats:
    """``kernel(value, *arguments)`` for each of a one-dimensional array of values."""
    out = np.empty_like(values)
    _compiled(kernel)(values, arguments, out)
    return out
