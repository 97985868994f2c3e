"""Messages and exit statuses of the command line.

Text that comes from a file is escaped, so that the terminal does not act on it.
"""

import errno
import io
import os
import sys
import warnings
from contextlib import suppress
from typing import Any, TextIO

import click

from roughmdr.errors import Fault, RoughmdrError, SceneError, Unfinished
from roughmdr.schema.wording import harmless

NOT_ALL = 1
"""Exit status where runs failed, or what was begun could not go on."""
_WRONG_INPUT, _INTERRUPTED = 2, 130


class Command(click.Command):
    """A command whose help may fail to be printed."""

    def make_context(self, *args: Any, **options: Any) -> click.Context:
        """Read the arguments; for --help and --version click prints the answer here."""
        try:
            return super().make_context(*args, **options)
        except OSError as error:
            say_error(_unwritable(sys.stdout, error))
            sys.exit(_WRONG_INPUT)


class Group(Command, click.Group):
    """A command group that turns errors raised on purpose, and the end of the memory, into messages."""

    command_class = Command

    def invoke(self, ctx: click.Context) -> object:
        """Run a command."""
        try:
            with warnings.catch_warnings():
                warnings.showwarning = say_warning
                return super().invoke(ctx)
        except click.ClickException as error:
            message = io.StringIO()
            error.show(message)
            say(message.getvalue().removesuffix("\n"), err=True)
            sys.exit(error.exit_code)
        except RoughmdrError as error:
            say_error(error)
            sys.exit(NOT_ALL if isinstance(error, Unfinished) else _WRONG_INPUT)
        except MemoryError as error:
            say(f"roughmdr: out of memory{f': {error}' if str(error) else ''}", err=True)
            sys.exit(NOT_ALL)
        except (KeyboardInterrupt, click.Abort) as interrupt:
            say(f"roughmdr: {str(interrupt) or 'interrupted; nothing was written'}", err=True)
            # Threads may still compute, and what they finish is not waited for.
            os._exit(_INTERRUPTED)


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
        unwritable = _unwritable(stream, error)
        if not err:
            raise unwritable from None


def _unwritable(stream: TextIO, error: OSError) -> RoughmdrError:
    """The error of a stream that cannot be written, which is led nowhere: the end of Python would write it again."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return RoughmdrError(f"the standard output cannot be written: {error.strerror}")


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
