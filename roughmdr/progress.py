"""How far a batch is: a bar on a terminal, a line now and then elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Protocol

_SECONDS_BETWEEN_LINES = 10.0


class Advance(Protocol):
    """Tells that ``count`` more runs are done."""

    def __call__(self, count: int) -> None:
        """Count on."""


@contextmanager
def progress(title: str, total: int, *, quiet: bool) -> Iterator[Advance]:
    """A display on the standard error stream for ``total`` runs."""
    if quiet or sys.stderr is None:
        yield lambda count: None
    elif sys.stderr.isatty():
        with _bar(title, total) as advance:
            yield advance
    else:
        yield _lines(title, total)


@contextmanager
def _bar(title: str, total: int) -> Iterator[Advance]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as display:
        task = display.add_task(title, total=total)
        yield lambda count: display.advance(task, count)


def _lines(title: str, total: int) -> Advance:
    done, said = 0, time.monotonic()

    def advance(count: int) -> None:
        nonlocal done, said
        done += count
        now = time.monotonic()
        if done == total or now - said >= _SECONDS_BETWEEN_LINES:
            said = now
            with suppress(OSError):  # nobody listens
                print(f"{title}: {done} of {total} runs", file=sys.stderr, flush=True)

    return advance
