"""Ctrl-C and SIGTERM: the first finishes the tasks under way and keeps them, the second ends the batch at once."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_FINISHING = b"\nroughmdr: finishing what is under way; once more: stop at once\n"


class Interrupted(KeyboardInterrupt):
    """A batch was interrupted; the message says what is kept."""


@contextmanager
def interruptible(is_kept: Callable[[], bool], saved_message: Callable[[], str]) -> Iterator[threading.Event]:
    """Make an event that is set when the batch is to stop; the batch ends at once unless finished tasks are kept."""
    stop = threading.Event()

    def handle(number: int, frame: FrameType | None) -> None:
        if stop.is_set() or not is_kept():
            raise Interrupted(f"interrupted; {saved_message()}")
        stop.set()
        with suppress(OSError):
            os.write(2, _FINISHING)

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
