"""What is printed, escaped: nothing that comes from a file reaches the terminal as a command to it."""

import errno
import os
import sys
from contextlib import suppress

import click

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.wording import harmless


def say(text: str, *, err: bool = False) -> None:
    """Print what may come from a file, and so may hold what a terminal acts on."""
    _print(harmless(text), err=err)


def say_warning(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Print a warning on the standard error stream; it takes the place of ``warnings.showwarning``."""
    say(f"roughmdr: {category.__name__}: {message}", err=True)


def say_error(error: RoughmdrError) -> None:
    """Print the message of an error on the standard error stream, that of a scene with its faults line by line."""
    faults = error.faults if isinstance(error, SceneError) else ()
    for line in map(_coloured, faults) if faults else map(harmless, str(error).splitlines()):
        _print(f"roughmdr: {line}", err=True)


def _print(text: str, *, err: bool) -> None:
    """Print what is harmless; in colour where that is a terminal and NO_COLOR is not set.

    The standard error stream may lead nowhere; RoughmdrError where the standard output cannot be written.
    """
    stream = sys.stderr if err else sys.stdout
    encoding = getattr(stream, "encoding", None) or "utf-8"
    text = text.encode(encoding, "backslashreplace").decode(encoding)
    try:
        click.echo(text, err=err, color=False if os.environ.get("NO_COLOR") else None)
    except OSError as error:
        if error.errno == errno.EPIPE and not err:
            raise  # whoever read it has seen enough: click ends without a word
        with suppress(OSError):  # or the end of Python would write it again
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        if not err:
            raise RoughmdrError(f"the standard output cannot be written: {error.strerror}") from None


def _coloured(fault: Fault) -> str:
    key, value, text, place = map(harmless, fault)
    message, hint, name = text.partition("did you mean")
    return str(
        Fault(
            place=place and click.style(place, bold=True),
            key=key and click.style(key, fg="cyan", bold=True),
            value=value and click.style(value, fg="red"),
            message=message + (hint and click.style(hint + name, fg="green")),
        )
    )
