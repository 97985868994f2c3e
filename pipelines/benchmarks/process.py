"""A function called in a process of its own, so that its memory, its modules and its start-up are its own."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

_CODE = "import json, sys; from {0} import {1}; print(); print(json.dumps({1}(*json.loads(sys.argv[1]))))"


def in_new_process(function: Callable[..., Any], *arguments: Any, **environment: str) -> Any:
    """Call a function of a module in a process that loads nothing else; arguments and result pass as JSON."""
    code = _CODE.format(function.__module__, function.__name__)
    done = subprocess.run(
        [sys.executable, "-c", code, json.dumps(arguments)],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(__file__).parents[1],
        env={**os.environ, **environment},
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])
