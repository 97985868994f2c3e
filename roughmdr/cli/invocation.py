"""The command as it was given, and how a command begins."""

import gc
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from roughmdr.cli.terminal import print_note


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


def warn_of(file: Path, doubt: str) -> None:
    """Print why the numbers in a file cannot be trusted, unless they can."""
    if doubt:
        print_note(f"{click.format_filename(file)}: {doubt}")
