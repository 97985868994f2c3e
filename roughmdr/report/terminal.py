"""Messages and exit statuses of the command line.

Text that may come from a file is escaped, so that the terminal does not act on it.
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
from roughmdr.schema.wording import escape_controls

INCOMPLETE = 1
"""Exit status if runs failed, or a batch had to stop."""
_WRONG_INPUT, _INTERRUPTED = 2, 130


class Command(click.Command):
    """A command that tells if its help cannot be printed."""

    def make_context(self, *args: Any, **options: Any) -> click.Context:
        """Read the arguments; click prints the answers to --help and --version here."""
        try:
            return super().make_context(*args, **options)
        except OSError as error:
            print_error(_unwritable(sys.stdout, error))
            sys.exit(_WRONG_INPUT)


class Group(Command, click.Group):
    """A command group that turns errors raised on purpose, and lack of memory, into messages and exit statuses."""

    command_class = Command

    def invoke(self, ctx: click.Context) -> object:
        """Run a command."""
        try:
            with warnings.catch_warnings():
                warnings.showwarning = print_warning
                return super().invoke(ctx)
        except click.ClickException as error:
            message = io.StringIO()
            error.show(message)
            print_text(message.getvalue().removesuffix("\n"), err=True)
            sys.exit(error.exit_code)
        except RoughmdrError as error:
            print_error(error)
            sys.exit(INCOMPLETE if isinstance(error, Unfinished) else _WRONG_INPUT)
        except MemoryError as error:
            print_text(f"roughmdr: out of memory{f': {error}' if str(error) else ''}", err=True)
            sys.exit(INCOMPLETE)
        except (KeyboardInterrupt, click.Abort) as interrupt:
            print_text(f"roughmdr: {str(interrupt) or 'interrupted; nothing was written'}", err=True)
            # Threads may still be computing; a normal exit would wait for them.
            os._exit(_INTERRUPTED)


def print_text(text: str, *, err: bool = False) -> None:
    """Print text that may come from a file, with control characters escaped."""
    _print(escape_controls(text), err=err)


def print_warning(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Print a warning to standard error, in place of ``warnings.showwarning``."""
    print_text(f"roughmdr: {category.__name__}: {message}", err=True)


def print_error(error: RoughmdrError) -> None:
    """Print the message of an error to standard error; the faults of a scene line by line, in colour."""
    faults = error.faults if isinstance(error, SceneError) else ()
    for line in map(_coloured, faults) if faults else map(escape_controls, str(error).splitlines()):
        _print(f"roughmdr: {line}", err=True)


def _print(text: str, *, err: bool) -> None:
    """Print escaped text; in colour if the stream is a terminal and NO_COLOR is not set.

    RoughmdrError if standard output cannot be written; standard error that cannot be written is ignored.
    """
    stream = sys.stderr if err else sys.stdout
    encoding = getattr(stream, "encoding", None) or "utf-8"
    text = text.encode(encoding, "backslashreplace").decode(encoding)
    try:
        click.echo(text, err=err, color=False if os.environ.get("NO_COLOR") else None)
    except OSError as error:
        if error.errno == errno.EPIPE and not err:
            raise  # the reader has closed the pipe: click exits silently
        unwritable = _unwritable(stream, error)
        if not err:
            raise unwritable from None


def _unwritable(stream: TextIO, error: OSError) -> RoughmdrError:
    """Return the error of a stream that cannot be written, after redirecting it to nowhere.

    Otherwise Python would try to write it again at exit.
    """
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return RoughmdrError(f"the standard output cannot be written: {error.strerror}")


def _coloured(fault: Fault) -> str:
    key, value, text, location = map(escape_controls, fault)
    message, hint, name = text.partition("did you mean")
    return str(
        Fault(
            location=location and click.style(location, bold=True),
            key=key and click.style(key, fg="cyan", bold=True),
            value=value and click.style(value, fg="red"),
            message=message + (hint and click.style(hint + name, fg="green")),
        )
    )
