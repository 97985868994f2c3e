"""The command as it was given, and how a command begins."""

import gc
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roughmdr.cli.terminal import print_note

if TYPE_CHECKING:
    from roughmdr.result.view import ResultView


@contextmanager
def without_garbage_collection() -> Iterator[None]:
    """Suspend garbage collection during imports: it would take a tenth of their time and find nothing."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def command_line() -> str:
    """Return the command as it is recorded in a file's history."""
    return f"roughmdr {shlex.join(sys.argv[1:])}".encode("utf-8", "replace").decode()


def read_warned(file: Path) -> "ResultView":
    """Return the result in a file, after a note where its numbers cannot be trusted; StoreError if it is none."""
    from roughmdr.result.view import ResultView
    from roughmdr.storage.result_file import read_result

    result = ResultView(read_result(file))
    warn_of(file, result.doubt)
    return result


def warn_of(file: Path, doubt: str) -> None:
    """Print why the numbers in a file cannot be trusted, unless they can."""
    if doubt:
        print_note(f"{click.format_filename(file)}: {doubt}")
