"""Ctrl-C and SIGTERM: once, and what is under way is finished and kept; twice, and it ends at once."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_SAID = b"\nroughmdr: finishing what is under way; once more: stop at once\n"


class Interrupted(KeyboardInterrupt):
    """A batch was interrupted; the message says what is kept."""


@contextmanager
def interruptible(begun: Callable[[], bool], kept: Callable[[], str]) -> Iterator[threading.Event]:
    """An event that is set when the batch is to stop; ``kept`` says what is safe then.

    Unless what is finished is kept, it ends at once.
    """
    stop = threading.Event()

    def handle(number: int, frame: FrameType | None) -> None:
        if stop.is_set() or not begun():
            raise Interrupted(f"interrupted; {kept()}")
        stop.set()
        with suppress(OSError):
            os.write(2, _SAID)

    if threading.current_thread() is not threading.main_thread():
        yield stop
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    handled = [number for number, handler in before.items() if handler not in (signal.SIG_IGN, None)]
    try:
        for number in handled:
            signal.signal(number, handle)
        yield stop
    finally:
        for number in handled:
            signal.signal(number, before[number])
