"""Progress of a batch: a bar on a terminal, a line now and then elsewhere; with the steps of runs that last.

Runs in threads of this process show their steps. Those in other processes, here or on a cluster, are counted when they
are done.
"""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from roughmdr.numerics.underway import steps_done

_SECONDS_BETWEEN_LINES = 10.0
_SECONDS_OF_A_RUN = 3.0  # time [s] without a finished run after which the bar shows steps
_MAX_SHOWN = 4  # most runs under way that are named


class Progress:
    """Counts runs, and shows nothing."""

    def __init__(self, title: str) -> None:
        self.title, self.total, self.done, self.reused = title, 0, 0, 0

    def add(self, *, total: int = 0, done: int = 0, reused: int = 0) -> None:
        """Add runs that are to be done, are done, or are reused."""
        self.total, self.done, self.reused = self.total + total, self.done + done, self.reused + reused
        self.update()

    def update(self) -> None:
        """Show the counts, if it is time for it."""

    def tell(self, line: str) -> None:
        """Show a line of text."""

    @property
    def _under_way(self) -> str:
        """Steps of the runs under way, as "; step 3 of 40"; empty where nothing is known."""
        shown = [f"step {done} of {steps}" for done, steps in steps_done()]
        more = f" and {len(shown) - _MAX_SHOWN} more" if len(shown) > _MAX_SHOWN else ""
        return f"; {', '.join(shown[:_MAX_SHOWN])}{more}" if shown else ""


def tell_compiling(title: str, *, quiet: bool) -> None:
    """Say on the standard error stream that kernels are compiled, which takes seconds, but only once."""
    if not quiet and sys.stderr is not None:
        _tell(f"{title}: compiling the kernels (once) ...")


def _tell(line: str) -> None:
    with suppress(OSError):  # nobody reads it
        print(line, file=sys.stderr, flush=True)


@contextmanager
def progress(title: str, *, quiet: bool, kind: str = "runs") -> Iterator[Progress]:
    """Open a display on the standard error stream."""
    if quiet or sys.stderr is None:
        yield Progress(title)
    elif sys.stderr.isatty():
        with _bar(title) as display, _updated(display, 0.5 * _SECONDS_OF_A_RUN):
            yield display
    else:
        lines = _Lines(title, kind)
        with _updated(lines, 0.1 * _SECONDS_BETWEEN_LINES):
            yield lines
        lines.print()


@contextmanager
def _updated(display: Progress, interval: float) -> Iterator[None]:
    """Update a display every ``interval`` [s] from a thread of its own."""
    ended = threading.Event()

    def update() -> None:
        while not ended.wait(interval):
            display.update()

    thread = threading.Thread(target=update, name="roughmdr-progress", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


class _Lines(Progress):
    def __init__(self, title: str, kind: str) -> None:
        super().__init__(title)
        self._kind, self._printed, self._last, self._lock = kind, time.monotonic(), "", threading.Lock()

    def update(self) -> None:
        with self._lock:
            line = f"{self._counts}{self._under_way}"
            if self.total and line != self._last and time.monotonic() - self._printed >= _SECONDS_BETWEEN_LINES:
                self._printed, self._last = time.monotonic(), line
                _tell(line)

    def tell(self, line: str) -> None:
        _tell(f"{self.title}: {line}")

    @property
    def _counts(self) -> str:
        more = f", {self.reused} used again" if self.reused else ""
        return f"{self.title}: {self.done} of {self.total} {self._kind}{more}"

    def print(self) -> None:
        _tell(self._counts)


@contextmanager
def _bar(title: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress as Bar, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Bar(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(title, total=0)

        class Display(Progress):
            changed, last = time.monotonic(), 0

            def update(self) -> None:
                if self.done != self.last:
                    self.changed, self.last = time.monotonic(), self.done
                lasts = time.monotonic() - self.changed >= _SECONDS_OF_A_RUN
                more = f" ({self.reused} used again)" if self.reused else ""
                more += self._under_way if lasts else ""
                bar.update(task, total=self.total, completed=self.done, description=f"{title}{more}")

            def tell(self, line: str) -> None:
                bar.console.print(line, markup=False, highlight=False)

        yield Display(title)
