"""Attributes of the files of results and fits."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Attribute:
    """An attribute of a file."""

    name: str
    dtype: type = str
    required: bool = False
    """Whether commands need it."""
    free: bool = False
    """Whether users and their tools may change it: the checksum does not cover it."""
    names: tuple[str, ...] = ()
    """Allowed values; empty where any is."""


def _declare(*rows: Attribute) -> dict[str, Attribute]:
    return {row.name: row for row in rows}


_PROVENANCE = _declare(
    Attribute("Conventions", free=True),
    Attribute("title", required=True, free=True),
    Attribute("source", required=True),
    Attribute("history", required=True, free=True),
    Attribute("packages", required=True),
    Attribute("references", free=True),
    Attribute("scene", required=True),
    Attribute("warnings"),
    Attribute("checksum", free=True),
)
RESULT_ATTRIBUTES = _PROVENANCE | _declare(
    Attribute("seed", int, required=True),
    Attribute("left_out", required=True),
    Attribute("versions"),
    Attribute("interaction", names=("pairwise", "mean_field")),
    Attribute("nominal"),
    Attribute("path"),
    Attribute("slip"),
    Attribute("lattice"),
    Attribute("map"),
    Attribute("accuracy"),
)
"""Attributes of a result by their names."""
FIT_ATTRIBUTES = _PROVENANCE | _declare(
    Attribute("kind", required=True, names=("fit",)),
    Attribute("measured"),
    Attribute("intervals"),
    Attribute("posterior"),
    Attribute("trust", required=True),
)
"""Attributes of a fit by their names."""
STATED = tuple(name for name, each in (RESULT_ATTRIBUTES | FIT_ATTRIBUTES).items() if not each.free)
"""Attributes that a checksum covers."""
