"""The command line in the test's own process, and how to start one of its own where a test is of processes."""

import gc
import subprocess
import sys
from contextlib import chdir
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

from click.testing import CliRunner

from roughmdr.cli import main

PATIENCE = 300.0
"""After so long [s] a command hangs."""
ROUGHMDR = [sys.executable, "-c", "from roughmdr.cli import main; main()"]
"""Starts the command line in a process of its own."""


class Done(NamedTuple):
    """A command that has ended, named as ``subprocess.CompletedProcess`` names it."""

    returncode: int
    stdout: str
    stderr: str


def roughmdr(*arguments: object, cwd: Path | str = ".") -> Done:
    """Call the command line in this process; what no command should raise is raised."""
    words = list(map(str, arguments))
    with chdir(cwd), patch.object(sys, "argv", ["roughmdr", *words]):
        done = CliRunner().invoke(main, words)
    gc.unfreeze()  # a command freezes what it imports, as if the process were its own
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return Done(done.exit_code, done.stdout, done.stderr)


def in_a_process(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Call the command line in a process of its own."""
    command = [*ROUGHMDR, *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=PATIENCE, check=False)


def said(*arguments: object, cwd: Path | str = ".") -> str:
    """Call the command line in this process, which must succeed: what it says on both streams."""
    done = roughmdr(*arguments, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr
