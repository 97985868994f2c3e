"""Where asperities come from: one file a source, each with the section of the scene that asks for it."""

import operator
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, SupportsIndex

from pydantic import Field, TypeAdapter, ValidationError

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.gaussian.section import NayakAsperities
from roughmdr.ensemble.maps.section import SurfaceAsperities
from roughmdr.ensemble.random.section import RandomAsperities
from roughmdr.ensemble.random.shapes import AnyRandomAsperities
from roughmdr.ensemble.saved import FileAsperities
from roughmdr.ensemble.source import Source
from roughmdr.errors import SceneError, warn_limits
from roughmdr.schema.faults import find_faults

if TYPE_CHECKING:
    import xarray as xr

Asperities = Annotated[
    AnyRandomAsperities | NayakAsperities | SurfaceAsperities | FileAsperities, Field(discriminator="source")
]

__all__ = [
    "Asperities",
    "Ensemble",
    "NayakAsperities",
    "RandomAsperities",
    "Source",
    "SurfaceAsperities",
    "generate",
    "make",
]


def generate(asperities: dict[str, Any] | Source, *, seed: int, realization: int = 0) -> "xr.Dataset":
    """The ensemble that a run with this seed presses on, as a Dataset over ``asperity``, highest summit first.

    asperities is the section of a scene or a dictionary with its keys, quantities as numbers in SI or as strings with
    a unit. The result holds ``height`` [m] and each shape parameter under its argument's name; attrs ``shape``,
    ``nominal_area`` [m2], ``patch`` [m] and ``seed``; ``warnings``, issued as LimitWarning too, where the asperities
    are doubtful. SceneError, with all faults at once, where the section is wrong.
    """
    section = asperities if isinstance(asperities, Source) else _validated(asperities)
    made = make(section, _whole("seed", seed), _whole("realization", realization))
    warn_limits(made.warnings)
    return made.labelled().to_xarray()


def make(section: Source, seed: int, realization: int) -> Ensemble:
    """The ensemble of a section for a user to keep: with positions where it says how to place them."""
    made = section.ensemble(seed, realization, placed="placement" in section.model_fields_set)
    return replace(made, warnings=(*section.doubts, *made.warnings))


def _whole(name: str, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, SupportsIndex) or operator.index(value) < 0:
        raise SceneError(f"{name} is {value!r}; it must be a whole number of at least 0")
    return operator.index(value)


def _validated(table: dict[str, Any]) -> Source:
    try:
        return TypeAdapter[Source](Asperities).validate_python(table)
    except ValidationError as error:
        if not isinstance(table, dict):
            raise SceneError(f"asperities is {table!r}; it must be a table, or the section of a scene") from None
        found = find_faults(error, table, Asperities)
        raise SceneError.of(
            [fault._replace(key=".".join(filter(None, ("asperities", fault.key)))) for fault in found]
        ) from None
