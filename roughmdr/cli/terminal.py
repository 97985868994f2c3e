"""Messages and exit statuses of the command line.

Text that may come from a file is escaped, so that the terminal does not act on it. With --json all output of a command,
its errors and warnings included, is one document on standard output (``documents``).
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


_JSON = f"{__name__}.json"
"""Key of the notes of a command with --json, in the dictionary that its contexts share."""


class _OutputError(RoughmdrError):
    """The standard output cannot be written."""


class Command(click.Command):
    """A command that reports an error if its help cannot be printed."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments, after noting whether all output, mistakes in them included, is to be JSON."""
        if "--json" in args and any("--json" in parameter.opts for parameter in self.params):
            ctx.meta[_JSON] = {"command": self.name or "", "warnings": []}
        return super().parse_args(ctx, args)

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
        except (click.ClickException, RoughmdrError, MemoryError) as error:
            status = _status_of(error)
            _print_failure(ctx, error, status)
            sys.exit(status)
        except (KeyboardInterrupt, click.Abort) as interrupt:
            _print_failure(ctx, interrupt, _INTERRUPTED)
            # Threads may still be computing; a normal exit would wait for them.
            os._exit(_INTERRUPTED)


def _status_of(error: Exception) -> int:
    """Return the exit status of an error raised on purpose, or of a lack of memory."""
    if isinstance(error, click.ClickException):
        return error.exit_code
    return INCOMPLETE if isinstance(error, Unfinished | MemoryError) else _WRONG_INPUT


def _print_failure(ctx: click.Context, error: BaseException, status: int) -> None:
    """Print why a command ends: to standard error, or as the document that it would have printed."""
    message = str(error)
    if isinstance(error, MemoryError):
        message = f"out of memory{f': {error}' if str(error) else ''}"
    elif isinstance(error, KeyboardInterrupt | click.Abort):
        message = str(error) or "interrupted; nothing was written"
    if _JSON in ctx.meta and not isinstance(error, _OutputError):
        from roughmdr.report.documents import faults_of

        if isinstance(error, click.ClickException):
            message = error.format_message()
        try:
            print_document(ctx, status, faults=faults_of(error, message))
            return
        except _OutputError as unwritable:
            error = unwritable
    if isinstance(error, click.ClickException):
        shown = io.StringIO()
        error.show(shown)
        print_text(shown.getvalue().removesuffix("\n"), err=True)
    elif isinstance(error, RoughmdrError):
        print_error(error)
    else:
        print_text(f"roughmdr: {message}", err=True)


def print_document(ctx: click.Context, exit_status: int = 0, **told: Any) -> None:
    """Print the document of a command with --json: the entries ``told``, and its warnings until now."""
    from roughmdr.report.documents import document, to_json

    notes = ctx.find_root().meta[_JSON]
    _print(to_json(document(notes["command"], exit_status, warnings=notes["warnings"], **told)), err=False)


def print_text(text: str, *, err: bool = False) -> None:
    """Print text that may come from a file, with control characters escaped."""
    _print(escape_controls(text), err=err)


def print_warning(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Print a warning as ``print_note`` does, in place of ``warnings.showwarning``."""
    print_note(f"{category.__name__}: {message}")


def print_note(text: str) -> None:
    """Print a note to standard error, or keep it for the document of a command with --json."""
    ctx = click.get_current_context(silent=True)
    if ctx is not None and _JSON in ctx.meta:
        ctx.meta[_JSON]["warnings"].append(text)
    else:
        print_text(f"roughmdr: {text}", err=True)


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


def _unwritable(stream: TextIO, error: OSError) -> "_OutputError":
    """Return the error of a stream that cannot be written, after redirecting it to nowhere.

    Otherwise Python would try to write it again at exit.
    """
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return _OutputError(f"the standard output cannot be written: {error.strerror}")


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
