"""Mistakes in scenes: units off by factors of 1000, signs, reversed paths, a missing counter body.

Each scene is planned and run by the command line. None may end well (exit status 0) with more contact area than patch,
and none without a line that says how far its force can be trusted.
"""

import copy
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w
import xarray as xr
from click.testing import CliRunner, Result

from roughmdr.cli import main
from studies.comparison import of_rows
from studies.study import Study

COUNT, QUICK_COUNT = 300, 40
KINDS = ("unit", "sign", "reversed path", "missing counter body")
OUTCOMES = ("done", "done, with a warning", "some runs failed", "refused")
_FACTORS = (1e-6, 1e-3, 1e3, 1e6)
_WORDS = {
    "exit_status": ("exit status of the run", "1"),
    "trusted": ("1 where the run, if it ended well, and its plan said how far the force can be trusted", "1"),
    "contact_fraction": ("largest contact fraction", "1"),
    "model_error": ("largest model error", "1"),
}
_BASES: tuple[dict[str, Any], ...] = (
    {
        "material": {"modulus": 3e6, "poisson": 0.49},
        "adhesion": {"model": "jkr", "work": 0.05},
        "asperities": {
            "source": "random", "shape": "paraboloid", "count": 400, "patch": 1e-3, "radius": 50e-6,
            "height": {"distribution": "normal", "std": 1e-6},
        },
        "path": {"separation": {"start": 4e-6, "stop": 1e-6, "steps": 40}, "unload": True},
    },
    {
        "material": {"modulus": 210e9, "poisson": 0.3},
        "counter": {"modulus": 70e9, "poisson": 0.33},
        "asperities": {
            "source": "nayak", "patch": 1e-4, "hurst": 0.8, "long_wave": 2e-5, "short_wave": 2e-6, "rms_slope": 0.1,
        },
        "path": {"separation": {"start": 5e-7, "stop": 2.5e-7, "steps": 30}},
    },
    {
        "material": {"modulus": 2e9, "poisson": 0.3},
        "counter": {"modulus": 70e9, "poisson": 0.2},
        "adhesion": {"model": "dugdale", "work": 0.06, "strength": 20e6},
        "asperities": {
            "source": "random", "shape": "paraboloid", "count": 200, "patch": 5e-6, "radius": 120e-9,
            "height": {"distribution": "normal", "std": 5e-9},
        },
        "path": {"separation": {"start": 30e-9, "stop": 10e-9, "steps": 30}, "unload": True},
    },
    {
        "material": {"effective_modulus": 1e9},
        "asperities": {
            "source": "random", "shape": "cone", "count": 15, "patch": 1e-4, "slope": 0.1,
            "height": {"distribution": "expon", "scale": 1e-6, "loc": 0.0},
        },
        "path": {"separation": {"start": 8e-6, "stop": 2e-6, "steps": 30}},
    },
)  # fmt: skip


class Trap(NamedTuple):
    """A scene with a mistake."""

    kind: str
    scene: dict[str, Any]


def traps(count: int, seed: int = 0) -> Iterator[Trap]:
    """Yield so many scenes, each with one mistake or two, the kinds in turn."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        kind = KINDS[(0, 0, 1, 2, 0, 3)[number % 6]]
        table = copy.deepcopy(_BASES[int(rng.integers(len(_BASES)))])
        if kind == "reversed path":
            path = table["path"]["separation"]
            path["start"], path["stop"] = path["stop"], path["start"]
        if kind == "missing counter body":
            table.pop("counter", None)
            table["material"] |= {} if "effective_modulus" in table["material"] else {"modulus": 3.0}
        if kind in ("unit", "sign"):
            numbers = list(_numbers(table))
            for _ in range(int(rng.integers(1, 3))):
                section, key = numbers[int(rng.integers(len(numbers)))]
                section[key] *= -1.0 if kind == "sign" else float(rng.choice(_FACTORS))
        yield Trap(kind, {"title": f"Trap {number}", **table, "batch": {"realizations": 2}})


def _numbers(table: dict[str, Any]) -> Iterator[tuple[dict[str, Any], str]]:
    """Yield where the numbers of a scene stand that have a unit or a sign."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _numbers(value)
        elif isinstance(value, float):
            yield table, key


def said_and_found(scene: dict[str, Any], folder: Path) -> tuple[Result, xr.Dataset | None]:
    """Run a scene by the command line in a folder; return what it said, and its result if it ended well."""
    file, out = folder / "scene.toml", folder / "out.nc"
    file.write_text(tomli_w.dumps(scene))
    done = CliRunner().invoke(main, ["run", str(file), "-o", str(out), "--fresh"])
    if done.exit_code:
        return done, None
    with xr.open_dataset(out) as stored:
        return done, stored.load()


def spring(trap: Trap, folder: Path) -> dict[str, Any]:
    """Run and plan the scene of a trap in a folder: return how it ended, and the numbers of ``_WORDS``."""
    run, result = said_and_found(trap.scene, folder)
    if run.exit_code not in (0, 1, 2):
        raise AssertionError(f"exit status {run.exit_code}: {trap.scene}")
    plan = CliRunner().invoke(main, ["plan", str(folder / "scene.toml")])
    texts = [text.stdout for text in (plan, run) if text.exit_code == 0]
    warned = bool(re.search(r"^warning ", run.stdout, re.MULTILINE))
    return {
        "kind": trap.kind,
        "outcome": {0: OUTCOMES[int(warned)], 1: OUTCOMES[2], 2: OUTCOMES[3]}[run.exit_code],
        "exit_status": run.exit_code,
        "trusted": all(re.search(r"^trust ", text, re.MULTILINE) for text in texts),
        "contact_fraction": np.nan if result is None else result["largest_contact_fraction"].max(),
        "model_error": np.nan if result is None else result["model_error"].max(),
    }


def measure(quick: bool) -> xr.Dataset:
    """Plan and run all traps."""
    count = QUICK_COUNT if quick else COUNT
    with tempfile.TemporaryDirectory() as name, chdir(name):
        return of_rows(_WORDS, [spring(trap, Path(os.curdir).resolve()) for trap in traps(count)], "trap")


def violations(found: xr.Dataset) -> tuple[int, int]:
    """Return how many ended well with more contact than patch, and how many said nothing of trust."""
    full = (found.exit_status == 0) & ~(found.contact_fraction <= 1.0)
    return int(full.sum()), int((found.trusted == 0).sum())


def report(found: xr.Dataset) -> str:
    """Return how the traps end, in words."""
    full, silent = violations(found)
    counts = ", ".join(f"{int((found.outcome == outcome).sum())} {outcome}" for outcome in OUTCOMES)
    done = found.where(found.exit_status == 0, drop=True)
    return (
        f"{found.sizes['trap']} scenes with a mistake: {counts}. {full} ended well with more contact area than patch, "
        f"{silent} without a line on trust. The model errors of those that ended well have a median of "
        f"{float(done.model_error.median()):.2g}; the largest contact fraction is "
        f"{float(done.contact_fraction.max()):.2g}."
    )


STUDY = Study("traps", "Mistakes in scenes", measure, {}, report, f"{QUICK_COUNT} of {COUNT} scenes")
