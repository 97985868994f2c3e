"""Checks of files before they are opened: an input must be a regular file, or a pipe that was handed over."""

import os
import stat
from pathlib import Path

from roughmdr.errors import RoughmdrError


def check_regular_file(path: Path) -> None:
    """Raise RoughmdrError, naming what is there instead, unless ``path`` is a regular file or a link to one."""
    mode = _mode(path)
    if stat.S_ISDIR(mode):
        raise RoughmdrError("is a folder; expected a file")
    if not stat.S_ISREG(mode):
        raise RoughmdrError("is not a regular file; expected one")


def is_open_pipe(path: Path) -> bool:
    """Return whether ``path`` is a pipe that this process was given, such as /dev/stdin or /dev/fd/63.

    A named pipe does not count: opening it may block for ever. RoughmdrError if nothing is there.
    """
    if not stat.S_ISFIFO(_mode(path)):
        return False
    target = Path(os.path.realpath(path))
    return not target.exists() or target.parent == Path("/dev/fd")


def _mode(path: Path) -> int:
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        raise RoughmdrError("no such file") from None
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None
    except ValueError as error:  # no file can have such a name
        raise RoughmdrError(f"cannot be read: {error}") from None
