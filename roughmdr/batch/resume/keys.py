"""The key of a cell, a hash of all that decides its numbers: results are reused only where it is the same."""

import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from typing import Any

from roughmdr.batch.plan import Cell, Plan
from roughmdr.errors import RoughmdrError
from roughmdr.layer.tangential import tangential_of
from roughmdr.numerics.fingerprint import NUMBERS, fingerprint
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.wording import short_repr

_PACKAGES = ("numpy", "numba", "scipy")  # which numbers come from
_MAX_LETTERS = 1000  # of a value in a message, such as a path or a list of numbers
_IGNORED = ("title", "output", "batch", "accuracy", "sweep.mode")
"""Parts of a scene that do not change the numbers of a realisation; its estimator is in the key itself."""
_NOT_IGNORED = ("batch.estimator", "accuracy.method")


@cache
def versions() -> str:
    """Return the versions of all that numbers come from."""
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    return f"roughmdr {version('roughmdr')} ({fingerprint(NUMBERS)}), {packages}"


def check_versions(asked: str) -> None:
    """RoughmdrError unless this process has the versions that were asked for."""
    if asked != versions():
        raise RoughmdrError(f"a worker has other versions, {versions()}; it must have {asked}")


def keys_of(plan: Plan, estimator: str) -> list[str]:
    """Return the key of each cell of a plan under an estimator."""
    sections: dict[int, str] = {}  # cells of a sweep have sections in common
    return [_key(cell, estimator, sections) for cell in plan.cells]


def _key(cell: Cell, estimator: str, sections: dict[int, str]) -> str:
    scene = cell.scene
    section = scene.asperities
    if id(section) not in sections:  # a file counts by its content, not by its name
        section_by_content = section.model_copy(update={"file": section.content_hash}) if section.inputs else section
        sections[id(section)] = repr(section_by_content)
    parts = (
        scene.effective_modulus,
        tuple(scene.adhesion_model),
        scene.interaction_model,
        None if scene.reference is None else scene.reference.error,
        repr(scene.viscoelastic),
        *(() if scene.nominal is None else (repr(scene.nominal),)),
        sections[id(section)],
        hashlib.sha256(cell.values.tobytes()).hexdigest(),
        *(() if cell.machine is None else (cell.machine.control, tuple(cell.machine.machine), cell.machine.preload)),
        *scene.conductance_factors.items(),
        *(() if cell.lateral is None else (cell.lateral.held_value,)),
        *(() if (tangential := tangential_of(scene)) is None else tangential),
        scene.seed,
        estimator,
        versions(),
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


def changes(old: str, new: str) -> Iterator[str]:
    """Yield which decisive values of a scene are others in a new one, old and new; both scenes are TOML."""
    before, after = (_flat(parse_toml(text)) for text in (old, new))
    for key in dict.fromkeys([*before, *after]):
        if key.startswith(_IGNORED) and key not in _NOT_IGNORED:
            continue
        if before.get(key) != after.get(key):
            was, now = (short_repr(side[key], _MAX_LETTERS) if key in side else "not given" for side in (before, after))
            yield f"{key} was {was}, is {now}"


def _flat(table: dict[str, Any], at: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in table.items():
        flat |= _flat(value, f"{at}{name}.") if isinstance(value, dict) else {f"{at}{name}": value}
    return flat
