"""Hooks into numba's compiler: a call at the first function, and no garbage collection meanwhile."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core.event import Listener, install_listener, register

_COMPILE = "numba:compile"  # the event: a function that the cache on disk lacks is compiled
_register: Callable[[str, Listener], None] = register


class _Rest(Listener):
    """Lets Python's garbage collector rest while numba compiles, which it does for one thread at a time.

    Most objects that numba makes stay until the end; a search among them takes a tenth of the time.
    """

    _depth, _resume = 0, False

    def on_start(self, event: object) -> None:
        if self._depth == 0:
            self._resume = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: object) -> None:
        self._depth -= 1
        if self._depth == 0 and self._resume:
            gc.enable()


class _First(Listener):
    """Waits for the first function that is compiled."""

    def __init__(self, found: Callable[[], None]) -> None:
        self._waiting = [found]

    def on_start(self, event: object) -> None:
        if self._waiting:
            self._waiting.pop()()

    def on_end(self, event: object) -> None: ...


def let_collector_rest() -> None:
    """Let the garbage collector rest from now on whenever numba compiles."""
    _register(_COMPILE, _Rest())


@contextmanager
def compiling(begins: Callable[[], None]) -> Iterator[None]:
    """Call ``begins`` once, when a first function is to be compiled; never if the cache on disk has them all."""
    with install_listener(_COMPILE, _First(begins)):
        yield
