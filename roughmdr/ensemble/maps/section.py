"""source = "surface": the summits of a measured height map, as paraboloids, or its hills, with a profile each."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import StrictBool, field_validator, model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.from_file import FromFile
from roughmdr.ensemble.maps.detrend import Trend, remove_short_waves, remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap, MapWaves, map_statistics, mean_and_rms
from roughmdr.ensemble.maps.outliers import Treatment
from roughmdr.ensemble.maps.raw_map import Size, SizeReader
from roughmdr.ensemble.maps.read_map import read_map
from roughmdr.ensemble.maps.resolution import radius_uncertainty, warning
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.ensemble.maps.words import describe_map, implausible
from roughmdr.ensemble.source import Source
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.schema.quantities import EntryError
from roughmdr.schema.section import Length
from roughmdr.schema.units import unit_factor

Model = Literal["summits", "hills"]
_ROUNDING = 64 * np.finfo(float).eps  # rounding error of heights after a trend was removed, over the largest height
_UNCUT = ("rms_height", "rms_slope", "mean_curvature_radius")
"""Attributes of an ensemble that are given for the map before the cutoff too."""


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
    smallest = float(radius.min())  # no mean curvature over it overflows
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


class SurfaceAsperities(MapSource, FromFile):
    """[asperities] with source = "surface": the summits of the map in ``file`` (``find_summits``), or its hills.

    Attributes of the ensemble beside those of ``find_summits`` and ``map_statistics``: ``rms_height_raw`` [m], before
    the trend is removed; ``mean_curvature_radius`` [m], 1/<sqrt(k1 k2)>; with a cutoff ``uncut_...``, without it; and
    ``radius_uncertainty`` [1] (``resolution``). Those of hills are told by ``find_hills``.
    """

    source: Literal["surface"]
    model: Model = "summits"
    size: Annotated[Size | None, SizeReader()] = None
    """Side of the map, or both along x and y, or { across, down } the rows of its file, which does not say."""
    unit: str | None = None
    """Unit of the heights of the map, where its file does not say."""
    channel: str | None = None
    """Name of the map, where its file has several."""
    detrend: Trend | None = None
    """Trend that is removed. Default: "quadratic", of periodic maps "mean"."""
    periodic: StrictBool | None = None
    """Whether the map repeats. Default: as its file says, else false."""
    cutoff: Length | None = None
    """Shorter waves are removed."""
    outliers: Treatment | None = None
    """Marks of undefined points and spikes become "undefined", or are "kept". Default: they are refused."""

    @field_validator("unit")
    @classmethod
    def _is_a_length(cls, value: str | None) -> str | None:
        unit_factor(value or "", "m")
        return value

    def read(self) -> Ensemble:
        surface = self._read_map()
        noise, raw = surface.rounding + _ROUNDING * surface.highest, mean_and_rms(surface)[1]
        trend = self._remove_trend(surface)
        attrs: dict[str, float | int | str] = {"detrend": trend, **surface.attrs, "rms_height_raw": raw}
        if self.cutoff is not None:
            uncut = summits_on(surface, noise, trend).attrs
            attrs |= {"cutoff": self.cutoff, **{f"uncut_{name}": uncut[name] for name in _UNCUT}}
            remove_short_waves(surface, self.cutoff)
        return asperities_on(surface, noise, self.model, Path(self.file).name, attrs)

    @property
    def description(self) -> tuple[str, ...]:
        return describe_map(self.asperities.attrs)

    @property
    def repeats(self) -> bool:
        return bool(self.asperities.attrs["periodic"])

    def height_map(self, seed: int, realization: int) -> HeightMap:
        """Return the map without trend and short waves; SceneError where it cannot be read."""
        try:
            surface = self._read_map()
            self._remove_trend(surface)
            if self.cutoff is not None:
                remove_short_waves(surface, self.cutoff)
        except RoughmdrError as error:
            raise SceneError(f"{self.file}: {error}") from error
        return surface

    @cached_property
    def waves(self) -> MapWaves:
        """The waves of the map of the summits; SceneError where it cannot be read."""
        return MapWaves.of(self.height_map(0, 0), self.cutoff)

    def _read_map(self) -> HeightMap:
        given = {name: getattr(self, name) for name in ("size", "unit", "channel", "periodic", "outliers")}
        return read_map(Path(self.file), **given)

    def _remove_trend(self, surface: HeightMap) -> Trend:
        """Remove the trend of a map, and return which."""
        trend = self.detrend or ("mean" if surface.periodic else "quadratic")
        if surface.periodic and trend in ("plane", "quadratic"):
            raise RoughmdrError(
                f'a periodic map has no trend to remove: detrend is {trend!r}; it must be "mean" or "none"'
            )
        remove_trend(surface.height, trend)
        return trend
