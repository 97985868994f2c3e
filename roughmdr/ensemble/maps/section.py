"""source = "surface": the summits of a measured height map, as paraboloids, or its hills, with a profile each."""

from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import StrictBool, field_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.from_file import FromFile
from roughmdr.ensemble.maps.detrend import Trend, remove_short_waves, remove_trend
from roughmdr.ensemble.maps.found import MapSource, Model, asperities_on, summits_on
from roughmdr.ensemble.maps.height_map import HeightMap, MapWaves, mean_and_rms
from roughmdr.ensemble.maps.outliers import Treatment
from roughmdr.ensemble.maps.raw_map import Size, SizeReader
from roughmdr.ensemble.maps.read_map import read_map
from roughmdr.ensemble.maps.words import describe_map
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.schema.section import Length
from roughmdr.schema.units import unit_factor

_ROUNDING = 64 * np.finfo(float).eps  # rounding error of heights after a trend was removed, over the largest height
_UNCUT = ("rms_height", "rms_slope", "mean_curvature_radius")
"""Attributes of an ensemble that are given for the map before the cutoff too."""


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
