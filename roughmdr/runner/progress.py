"""Progress of a batch: a bar on a terminal, a line now and then elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_SECONDS_BETWEEN_LINES = 10.0


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


def tell_compiling(title: str, *, quiet: bool) -> None:
    """Say on the standard error stream that kernels are compiled, which takes seconds, but only once."""
    if not quiet and sys.stderr is not None:
        _tell(f"{title}: compiling the kernels (once) ...")


def _tell(line: str) -> None:
    with suppress(OSError):  # nobody reads it
        print(line, file=sys.stderr, flush=True)


@contextmanager
def progress(title: str, *, quiet: bool) -> Iterator[Progress]:
    """Open a display on the standard error stream."""
    if quiet or sys.stderr is None:
        yield Progress(title)
    elif sys.stderr.isatty():
        with _bar(title) as display:
            yield display
    else:
        lines = _Lines(title)
        yield lines
        lines.print()


class _Lines(Progress):
    def __init__(self, title: str) -> None:
        super().__init__(title)
        self._printed = time.monotonic()

    def update(self) -> None:
        if self.done and time.monotonic() - self._printed >= _SECONDS_BETWEEN_LINES:
            self.print()

    def print(self) -> None:
        more = f", {self.reused} used again" if self.reused else ""
        self._printed = time.monotonic()
        _tell(f"{self.title}: {self.done} of {self.total} runs{more}")


@contextmanager
def _bar(title: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Bar(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(title, total=0)

        class Display(Progress):
            def update(self) -> None:
                more = f" ({self.reused} used again)" if self.reused else ""
                bar.update(task, total=self.total, completed=self.done, description=f"{title}{more}")

        yield Display(title)
