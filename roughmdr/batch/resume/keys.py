"""The key of a cell, a hash of all that decides its numbers: results are reused only where it is the same."""

import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from typing import Any

from roughmdr.batch.plan import Plan
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.fingerprint import NUMBERS, fingerprint
from roughmdr.scene.identity import LAYOUT, Digests
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.wording import short_repr

_PACKAGES = ("numpy", "numba", "scipy")  # which numbers come from
_MAX_LETTERS = 1000  # most letters of a value in a message, such as a path or a list
_DECISIVE = ("batch.estimator", "accuracy.method")  # the only keys of [batch] and [accuracy] that decide a number


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
    """Return the key of each cell of a plan under an estimator, with its path: "clear" depends on how many realisations
    there may be.
    """
    digests, keys = Digests(), list[str]()
    for cell in plan.cells:
        path = hashlib.sha256(cell.values.tobytes()).hexdigest()
        parts = digests.of(cell.scene), path, estimator, versions()
        keys.append(hashlib.sha256(repr(parts).encode()).hexdigest()[:32])
    return keys


def changes(old: str, new: str) -> Iterator[str]:
    """Yield which decisive values of a scene are others in a new one, old and new; both scenes are TOML."""
    before, after = (_flat(parse_toml(text)) for text in (old, new))
    for key in dict.fromkeys([*before, *after]):
        section, _, inner = key.partition(".")
        undecisive = section in LAYOUT and key not in _DECISIVE and (section != "sweep" or inner == "mode")
        if not undecisive and before.get(key) != after.get(key):
            was, now = (short_repr(side[key], _MAX_LETTERS) if key in side else "not given" for side in (before, after))
            yield f"{key} was {was}, is {now}"


def _flat(table: dict[str, Any], at: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in table.items():
        flat |= _flat(value, f"{at}{name}.") if isinstance(value, dict) else {f"{at}{name}": value}
    return flat
