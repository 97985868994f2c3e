"""How far a batch is: a bar on a terminal, a line now and then elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Protocol

_SECONDS_BETWEEN_LINES = 10.0


class Progress(Protocol):
    """A display of runs."""

    def expect(self, count: int) -> None:
        """There are so many more runs to do."""

    def advance(self, count: int) -> None:
        """So many more are done."""

    def use_again(self, count: int) -> None:
        """So many were there already."""


@contextmanager
def progress(title: str, *, quiet: bool) -> Iterator[Progress]:
    """A display on the standard error stream."""
    if quiet or sys.stderr is None:
        yield _Nothing()
    elif sys.stderr.isatty():
        with _bar(title) as display:
            yield display
    else:
        lines = _Lines(title)
        yield lines
        lines.say()


class _Nothing:
    def expect(self, count: int) -> None:
        pass

    def advance(self, count: int) -> None:
        pass

    def use_again(self, count: int) -> None:
        pass


class _Lines:
    def __init__(self, title: str) -> None:
        self._title, self._said = title, time.monotonic()
        self._total = self._done = self._again = 0

    def expect(self, count: int) -> None:
        self._total += count

    def advance(self, count: int) -> None:
        self._done += count
        if time.monotonic() - self._said >= _SECONDS_BETWEEN_LINES:
            self.say()

    def use_again(self, count: int) -> None:
        self._again += count

    def say(self) -> None:
        more = f", {self._again} used again" if self._again else ""
        self._said = time.monotonic()
        with suppress(OSError):  # nobody listens
            print(f"{self._title}: {self._done} of {self._total} runs{more}", file=sys.stderr, flush=True)


@contextmanager
def _bar(title: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Bar(*columns, console=Console(stderr=True)) as bar:
        task, again = bar.add_task(title, total=0), 0

        class Display:
            def expect(self, count: int) -> None:
                bar.update(task, total=(bar.tasks[task].total or 0) + count)

            def advance(self, count: int) -> None:
                bar.advance(task, count)

            def use_again(self, count: int) -> None:
                nonlocal again
                again += count
                bar.update(task, description=f"{title} ({again} used again)")

        yield Display()
