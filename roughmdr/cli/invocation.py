"""The command as it was given, and how a command begins."""

import gc
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roughmdr.report.terminal import print_note

if TYPE_CHECKING:
    from roughmdr.storage.labelled import Labelled


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


def warn_if_changed(file: Path, result: "Labelled") -> None:
    """Print a warning if the numbers in a file cannot be trusted."""
    if fault := result.integrity_fault():
        print_note(f"{click.format_filename(file)}: {fault}")
