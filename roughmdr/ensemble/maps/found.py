"""The asperities of a height map by either model of them: summits or hills."""

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap, map_statistics
from roughmdr.ensemble.maps.resolution import radius_uncertainty, warning
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.ensemble.maps.words import implausible
from roughmdr.ensemble.source import Source
from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import EntryError

Model = Literal["summits", "hills"]


class MapSource(Source):
    """A source whose asperities are the summits or hills of a map."""

    of_surface: ClassVar[bool] = True
    papers: ClassVar[dict[str, str]] = {"Greenwood2006": "roughness"}

    model: Model
    """"summits": a paraboloid each; "hills", for [interaction]: the profile of each hill."""
    shape: Literal["paraboloid", "mdr_table"] | None = None
    """Shape of the asperities, which decides the other keys."""

    @model_validator(mode="after")
    def _shape_of_the_model(self) -> "MapSource":
        own = "paraboloid" if self.model == "summits" else "mdr_table"
        if self.shape not in (None, own):
            raise EntryError("shape", self.shape, f"is not that of model = {self.model!r}: {own}; leave it out")
        return self


def summits_on(surface: HeightMap, noise: float, detrend: str) -> Ensemble:
    """Return the summits of a map that stand out by more than ``noise`` [m], with the statistics of the map.

    RoughmdrError where there are none, after a trend was removed by ``detrend``, or where no float holds their radii.
    """
    if not np.nanmax(surface.height) - np.nanmin(surface.height) > noise:
        raise RoughmdrError(f"the map has no summit: with detrend {detrend!r} it is flat, but for rounding")
    with np.errstate(over="ignore", under="ignore"):  # refused below
        summits = find_summits(surface, noise)
    radius, area = summits.parameters["radius"], summits.nominal_area or 0.0
    if not (np.isfinite(radius).all() and radius.min() > 0.0 and 0.0 < area < np.inf):
        raise RoughmdrError(f"no float can hold its radii, or its area, {area:g} m2: is its size right?")
    smallest = float(radius.min())  # over which no mean curvature overflows
    mean = smallest / float(np.mean(smallest / radius))
    return replace(summits, attrs={**summits.attrs, **map_statistics(surface), "mean_curvature_radius": mean})


def asperities_on(
    surface: HeightMap, noise: float, model: Model, name: str, attrs: Mapping[str, float | int | str]
) -> Ensemble:
    """Return the summits or hills of a map, with its statistics and further ``attrs``; a warning calls it ``name``."""
    found = summits_on(surface, noise, str(attrs["detrend"]))
    if model == "hills":
        from roughmdr.ensemble.maps.hills.find import find_hills  # it alone needs the compiler

        found = find_hills(surface, found)
    all_attrs = {**found.attrs, **attrs}
    if model == "summits":
        all_attrs["radius_uncertainty"] = radius_uncertainty(all_attrs)
    remarks = [f"{name}: {remark}" for remark in (implausible(all_attrs), attrs.get("doubtful")) if remark]
    return replace(found, attrs=all_attrs, warnings=tuple(filter(None, (*remarks, warning(name, all_attrs)))))
