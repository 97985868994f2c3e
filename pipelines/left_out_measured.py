"""The measurements behind ``left_out.py``, each in a process of its own."""

import ast
import json
import math
import os
import subprocess
import sys
import tempfile
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

from left_out_calls import Calls
from left_out_cases import SIZES, Size, scene_of
from left_out_child import CURVES

import roughmdr

IMPORTS = "imports"
_KERNELS = "calls of kernels, a visit", "kernels"
_COUNTED = {
    "adhesion": ("calls that only adhesion makes, a visit", "adhesive"),
    "range of adhesion": _KERNELS,
    "positions": ("random numbers drawn, an asperity", "drawn"),
    "asperities out of reach": ("visits", "work"),
    "the other default variables": _KERNELS,
    "all other variables": _KERNELS,
    CURVES: ("numbers kept", "work"),
}
"""What is counted of a part, and where that stands: among ``Calls``, or in what the scene did."""
PARTS = *_COUNTED, IMPORTS
COMMANDS = {
    "import roughmdr": [],
    "roughmdr plan": ["plan", "scene.toml"],
    "roughmdr --help": ["--help"],
    "roughmdr run": ["run", "scene.toml", "-o", "result.nc", "--fresh", "--quiet"],
}
"""What imports are left out of; the last two also in the quick form."""
_PLANNED = Size(4_000, 100, unload=False)
REDUCED = 10
"""By how much scenes are smaller in the quick form."""
_EXTRAS = ("distributed", "SurfaceTopography")  # not everyone has them


class Row(NamedTuple):
    """What a scene or a command costs with one part left out, and with it forced on."""

    scene: str
    part: str
    unit: str
    """What is counted."""
    counted: list[float]
    seconds: list[float]
    """Of processor time."""
    bytes: list[float]
    """Of memory at most; of a scene on top of what the process has when all is compiled."""
    difference: float = math.nan
    """Of the forces, over the largest."""
    stated: float = math.nan
    """What they may differ by, by the errors that are stated of both."""


def all_rows(quick: bool) -> list[Row]:
    """Every part, scene by scene; ``quick`` a tenth of each scene, and two processes at a time."""
    scale, patience = (REDUCED, 0.1) if quick else (1, 0.7)
    with ThreadPoolExecutor(2 if quick else 1) as pool:
        calls = pool.submit(_child, "left_out_calls.py", NUMBA_DISABLE_JIT="1")
        scenes = {name: pool.submit(_child, "left_out_child.py", name, str(scale), str(patience)) for name in SIZES}
        commands = _commands(pool, dict(list(COMMANDS.items())[-2:] if quick else COMMANDS))
        own = [(name, *each) for name, future in scenes.items() for each in future.result().items()]
        rows = [_row(*each, calls.result()) for each in own] + commands
    return sorted(rows, key=lambda row: PARTS.index(row.part))


def _child(script: str, *arguments: str, **environment: str) -> dict[str, Any]:
    """What a script says, in JSON."""
    return dict(json.loads(_printed([script, *arguments], environment=environment)))


def _printed(command: list[str], folder: str | None = None, environment: dict[str, str] | None = None) -> str:
    """What a script beside this file prints."""
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name(command[0])), *command[1:]],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env={**os.environ, **(environment or {})},
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return done.stdout


def _row(scene: str, part: str, found: dict[str, Any], calls: dict[str, dict[str, list[list[float]]]]) -> Row:
    """What was found of a part of a scene."""
    unit, name = _COUNTED[part]
    counted = found.pop("work")
    if name in Calls._fields:
        counted = [getattr(Calls(*side), name) for side in calls[scene][part]]
    return Row(scene, part, unit, counted, **found)


def _commands(pool: Executor, commands: dict[str, list[str]]) -> list[Row]:
    """Commands with what they import, and with all that the package ever imports."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.toml").write_text(scene_of(_PLANNED).toml)

        def carried_out(modules: list[str], arguments: list[str]) -> tuple[float, int, int]:
            *_, costs, loaded = _printed(["left_out_command.py", ",".join(modules), *arguments], folder).splitlines()
            seconds, size = costs.split()
            return float(seconds), int(size), len(loaded.split())

        found = [pool.map(carried_out, ([], imports()), (arguments,) * 2) for arguments in commands.values()]
        costs = {name: zip(*both, strict=True) for name, both in zip(commands, found, strict=True)}
        rows = []
        for name, both in costs.items():
            seconds, size, modules = map(list, both)
            rows.append(Row(name, IMPORTS, "modules loaded", modules, seconds, size))
    return rows


def imports() -> list[str]:
    """Every module that the package imports anywhere in its text, but for its own and those of its extras."""
    names = set[str]()
    for path in Path(roughmdr.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                names.add(str(node.module))
    return sorted(name for name in names if name.split(".")[0] not in ("roughmdr", *_EXTRAS))
