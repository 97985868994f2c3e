"""path.lateral: the lateral displacements of a flat on which a separation or a load is held."""

from typing import Annotated, Any

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity, WholeNumber
from roughmdr.schema.section import Section

_MAX_STEPS = 10_000_000
_LENGTH, _AMPLITUDE = Quantity("m"), Quantity("m", above=0.0)
HELD = ("separation", "force", "pressure")
"""Keys of [path] that can be held."""


class LateralRange(Section):
    """``steps`` displacements from ``start`` to ``stop``, or to ``amplitude`` and then whole ``cycles`` about 0.

    A cycle goes from the amplitude to its negative and back. Then ``steps`` are the steps of a quarter of it, as of the
    way from 0 to the amplitude: 1 + (1 + 4 cycles) steps in all, the first at 0.
    """

    start: Annotated[float, _LENGTH] = 0.0
    """First lateral displacement."""
    stop: Annotated[float, _LENGTH] | None = None
    """Last lateral displacement."""
    amplitude: Annotated[float, _AMPLITUDE] | None = None
    """Lateral displacement at which cycles about 0 turn, in place of stop."""
    cycles: Annotated[int, WholeNumber(1, 1_000_000)] = 1
    """Number of cycles after the first loading: to minus the amplitude and back."""
    steps: Annotated[int, WholeNumber(2, _MAX_STEPS, example="50")]
    """Number of steps, both ends included; with amplitude those of a quarter of a cycle."""

    @model_validator(mode="after")
    def _range_or_cycles(self) -> "LateralRange":
        if (self.stop is None) == (self.amplitude is None):
            raise RoughmdrError("takes either stop or amplitude")
        other = {"cycles"} if self.amplitude is None else {"start"}
        for key in other & self.model_fields_set:
            goes_with = "amplitude" if key == "cycles" else "stop"
            raise EntryError(key, getattr(self, key), f"goes with {goes_with} only")
        count = 1 + (1 + 4 * self.cycles) * self.steps
        if self.amplitude is not None and count > _MAX_STEPS:
            raise EntryError("cycles", self.cycles, f"make {count} steps in all; at most {_MAX_STEPS} are allowed")
        return self

    def displacements(self) -> Floats:
        """Return the displacement at each step [m]."""
        if self.amplitude is None:
            return np.linspace(self.start, self.stop or 0.0, self.steps)
        up = np.linspace(0.0, self.amplitude, self.steps + 1)
        down = up[-2::-1]
        return np.concatenate([up, *[down, -up[1:], -down, up[1:]] * self.cycles])


def kind_of(value: object) -> str | None:
    """Return whether an entry of [path] is a "range" or a "list"; None where it is neither."""
    return "list" if isinstance(value, list) else ("range" if isinstance(value, dict | Section) else None)


Lateral = Annotated[
    Annotated[LateralRange, Tag("range")]
    | Annotated[list[Annotated[float, _LENGTH]], Field(min_length=1), Tag("list")],
    Discriminator(
        kind_of,
        custom_error_type="neither",
        custom_error_message="must be a table with stop or amplitude and steps, or a list",
    ),
]


def displacements(lateral: LateralRange | list[float]) -> Floats:
    """Return the displacement at each step [m]; SceneError where two are farther apart than a float holds."""
    path = np.array(lateral, dtype=np.float64) if isinstance(lateral, list) else lateral.displacements()
    with np.errstate(over="ignore"):
        if not np.isfinite([path.max() - path.min(), *path[[0, -1]]]).all():
            raise SceneError("path.lateral: reaches beyond the largest float")
    return path


def check_single_values(table: dict[str, Any], otherwise: str) -> None:
    """Raise EntryError for a single value that [path] has in place of several, and no lateral."""
    for key in HELD:
        if "lateral" not in table and isinstance(table.get(key), float | int | str):
            raise EntryError(key, table[key], f"{otherwise}; a single value is held, with path.lateral")


def check_held(key: str, given: Any) -> None:
    """Raise a mismatch unless path.``key``, as ``given`` with path.lateral, can be held."""
    if key not in HELD:
        raise mismatch(f"path.{key}", "does not go with path.lateral, where separation, force or pressure is held")
    if isinstance(given, list | Section):
        raise mismatch(f"path.{key}", "must be a single value with path.lateral: it is held")
    if key != "separation" and not given > 0.0:
        raise mismatch(f"path.{key}", "must be above 0 with path.lateral: without a load there is no friction")
