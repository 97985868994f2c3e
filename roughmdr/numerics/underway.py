"""Progress of long computations: each notes its steps under its thread, and a display in another thread reads them."""

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple, TypeVar

import numpy as np

from roughmdr.numerics.arguments import Floats

_T = TypeVar("_T")


class _Computation(NamedTuple):
    done: Callable[[], int]
    steps: int


_underway: list[tuple[int, _Computation]] = []
"""Computations by thread, in the order in which they began."""


@contextmanager
def _noted(done: Callable[[], int], steps: int) -> Iterator[None]:
    """Note a computation of this thread, in place of the one that it is a part of, whichever of both ends first."""
    noted = threading.get_ident(), _Computation(done, steps)
    _underway.append(noted)
    try:
        yield
    finally:
        _underway.remove(noted)


def each_step(steps: Sequence[_T]) -> Iterator[_T]:
    """Yield the steps of a loop, noting how many of them are done."""
    number = 0
    with _noted(lambda: number, len(steps)):
        for number, step in enumerate(steps):  # noqa: B007 - the lambda reads the number
            yield step


@contextmanager
def filling(values: Floats) -> Iterator[None]:
    """Note that compiled code fills these values, all NaN at first, step by step."""
    values[:] = np.nan
    with _noted(lambda: int(np.count_nonzero(~np.isnan(values))), values.size):
        yield


def steps_done() -> list[tuple[int, int]]:
    """Return the number of finished steps of each computation in this process, and of all its steps."""
    innermost = dict(list(_underway))
    return [(computation.done(), computation.steps) for computation in innermost.values()]
