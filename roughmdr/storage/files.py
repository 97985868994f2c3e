"""Files that are read: only ordinary ones, which are there and end."""

import os
import stat
from pathlib import Path

from roughmdr.errors import RoughmdrError


def check_ordinary(path: Path) -> None:
    """RoughmdrError, saying what is there instead, unless ``path`` is an ordinary file or a link to one."""
    mode = _mode(path)
    if stat.S_ISDIR(mode):
        raise RoughmdrError("is a folder; expected a file")
    if not stat.S_ISREG(mode):
        raise RoughmdrError("is no ordinary file; expected one")


def is_open_pipe(path: Path) -> bool:
    """Whether ``path`` stands for a pipe that this process was given, as /dev/stdin and /dev/fd/63 do.

    A pipe with a name of its own is none: to open it may wait for ever. RoughmdrError where nothing is there.
    """
    if not stat.S_ISFIFO(_mode(path)):
        return False
    itself = Path(os.path.realpath(path))
    return not itself.exists() or itself.parent == Path("/dev/fd")


def _mode(path: Path) -> int:
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        raise RoughmdrError("no such file") from None
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None
    except ValueError as error:  # a name that no file can have
        raise RoughmdrError(f"cannot be read: {error}") from None
