"""What decides the numbers of a cell, as a key: results are used again only where it is the same."""

import hashlib
from collections.abc import Iterator
from functools import cache, lru_cache
from importlib.metadata import version
from typing import Any

from roughmdr.batch.plan import Cell, Plan
from roughmdr.ensemble import Source
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.fingerprint import NUMBERS, fingerprint
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.wording import short_repr

_PACKAGES = ("numpy", "numba", "scipy")  # which numbers come from
_LONG = 1000  # letters of a value, as of a path or a list of numbers, in a message
_NO_MATTER = ("title", "output", "batch", "accuracy", "sweep.mode")
"""Keys of a scene that do not change what a realisation comes to; what estimates it stands in the key itself."""
_MATTER = ("batch.estimator", "accuracy.method")


@cache
def versions() -> str:
    """The versions of all that numbers come from."""
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    return f"roughmdr {version('roughmdr')} ({fingerprint(NUMBERS)}), {packages}"


def check_versions(asked: str) -> None:
    """RoughmdrError unless this process has the versions that were asked for."""
    if asked != versions():
        raise RoughmdrError(f"a worker has other versions, {versions()}; it must have {asked}")


def keys_of(plan: Plan, estimator: str) -> list[str]:
    """The key of each cell of a plan under an estimator."""
    known: dict[int, str] = {}  # cells of a sweep have sections in common
    return [_key(cell, estimator, known) for cell in plan.cells]


def _key(cell: Cell, estimator: str, known: dict[int, str]) -> str:
    scene, path = cell
    if id(scene.asperities) not in known:
        known[id(scene.asperities)] = _asperities(scene.asperities)
    parts = (
        scene.effective_modulus,
        tuple(scene.adhesion_model),
        known[id(scene.asperities)],
        _path(path.separation.tobytes()),
        scene.seed,
        estimator,
        versions(),
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


def _asperities(section: Source) -> str:
    """A section in words, with what is in its file in place of its name."""
    return repr(section.model_copy(update={"file": section.content_hash}) if section.inputs else section)


@lru_cache(maxsize=16)
def _path(separation: bytes) -> str:
    return hashlib.sha256(separation).hexdigest()


def changes(old: str, new: str) -> Iterator[str]:
    """What of a scene that matters is another in a new one; both in TOML."""
    before, after = (_flat(parse_toml(text)) for text in (old, new))
    for key in dict.fromkeys([*before, *after]):
        if key.startswith(_NO_MATTER) and key not in _MATTER:
            continue
        if before.get(key) != after.get(key):
            was, now = (short_repr(side[key], _LONG) if key in side else "not given" for side in (before, after))
            yield f"{key} was {was}, is {now}"


def _flat(table: dict[str, Any], at: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in table.items():
        flat |= _flat(value, f"{at}{name}.") if isinstance(value, dict) else {f"{at}{name}": value}
    return flat
