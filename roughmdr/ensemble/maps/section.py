"""source = "surface": the summits of a measured height map, as paraboloids."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, StrictBool, field_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.from_file import FromFile
from roughmdr.ensemble.maps.detrend import Trend, remove_short_waves, remove_trend
from roughmdr.ensemble.maps.height_map import map_statistics
from roughmdr.ensemble.maps.read_map import Size, SizeReader, read_map
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.schema.quantities import Length
from roughmdr.schema.units import unit_factor

_ROUNDING = 64 * np.finfo(float).eps  # of the largest height: rounding errors of a trend that is removed

# Points per summit below which there is a warning. On maps without noise, the fit finds the mean curvature of the
# summits 2 % low at 290 points per summit, 9 % at 74, 15 % at 42 and 29 % at 19 where all waves are equally long; 3 %
# at 260, 14 % at 68 and 23 % at 42 where they are self-affine. A map of white noise has 9.5 points per summit. With
# weak noise on long waves there are many, and only the misfit of the fit shows it: up to a misfit of 0.15 the mean
# curvature is within 15 %, whatever the cause.
FEW_POINTS = 40.0


class SurfaceAsperities(FromFile):
    """[asperities] with source = "surface": the summits of the map in ``file`` (``find_summits``).

    ``size`` and ``unit`` (of the heights) describe a map whose file does not; ``channel`` chooses among the maps of a
    file; ``periodic`` overrides the file. ``detrend`` is removed, by default "quadratic", or "mean" of a periodic map;
    so are waves shorter than ``cutoff``.
    """

    source: Literal["surface"]
    shape: Literal["paraboloid"] = "paraboloid"
    size: Annotated[Size | None, BeforeValidator(SizeReader())] = None
    unit: str | None = None
    channel: str | None = None
    detrend: Trend | None = None
    periodic: StrictBool | None = None
    cutoff: Length | None = None

    @field_validator("unit")
    @classmethod
    def _is_a_length(cls, value: str | None) -> str | None:
        unit_factor(value or "", "m")
        return value

    def read(self) -> Ensemble:
        path = Path(self.file)
        try:
            surface = read_map(path, size=self.size, unit=self.unit, channel=self.channel, periodic=self.periodic)
            noise = surface.rounding + _ROUNDING * surface.highest
            trend = self.detrend or ("mean" if surface.periodic else "quadratic")
            if surface.periodic and trend in ("plane", "quadratic"):
                raise RoughmdrError(
                    f'a periodic map has no trend to remove: detrend is {trend!r}; it must be "mean" or "none"'
                )
            remove_trend(surface.height, trend)
            if self.cutoff is not None:
                remove_short_waves(surface, self.cutoff)
            if not np.nanmax(surface.height) - np.nanmin(surface.height) > noise:
                raise RoughmdrError(f"the map has no summit: with detrend {trend!r} it is flat, but for rounding")
            with np.errstate(over="ignore", under="ignore"):  # refused below
                summits = find_summits(surface, noise)
            radius, area = summits.parameters["radius"], summits.nominal_area or 0.0
            if not (np.isfinite(radius).all() and radius.min() > 0.0 and 0.0 < area < np.inf):
                raise RoughmdrError(f"no float can hold its radii, or its area, {area:g} m2: is its size right?")
        except RoughmdrError as error:
            raise SceneError(f"{self.file}: {error}") from error
        options = {"detrend": trend} | ({} if self.cutoff is None else {"cutoff": self.cutoff})
        attrs = {**summits.attrs, **map_statistics(surface), **options}
        points = float(summits.attrs["points_per_summit"])
        warning = (
            f"{path.name}: {points:.3g} points a summit (warned of below {FEW_POINTS:g}): noise, or the spacing, may "
            "set the radii of the summits; a finer map or a cutoff shows whether it does"
        )
        return replace(summits, attrs=attrs, warnings=(warning,) if points < FEW_POINTS else ())
