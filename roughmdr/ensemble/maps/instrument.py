"""Read height maps in the formats of instruments, by SurfaceTopography."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from roughmdr.ensemble.maps.raw_map import RawMap
from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import unit_factor


def read_instrument(path: Path, channel: str | None) -> RawMap:
    """Read the channel of that name, or the default one if it holds heights, or else the first that does.

    NaN is undefined. RoughmdrError where SurfaceTopography is missing, or reads no such map.
    """
    kind = path.suffix or "a format without a suffix"
    with warnings.catch_warnings(action="ignore"):  # these are about other contents, or packages not installed
        try:
            from SurfaceTopography.IO import open_topography
        except ImportError:
            raise RoughmdrError(
                f"{kind} is left to SurfaceTopography, which is not installed: "
                "pip install -e '.[surface]' in the clone of roughmdr; without it there are .nc, .npy, .npz, .txt, "
                ".csv, .tsv, .dat and .xyz"
            ) from None
        try:
            with open_topography(str(path)) as reader:
                return _read_channel(reader, channel)
        except RoughmdrError:
            raise
        except Exception as error:
            name = type(error).__name__
            if name == "IndexError":
                raise RoughmdrError("holds no channel of heights that SurfaceTopography can read") from error
            if name == "CorruptFile" and str(error):
                said = str(error).splitlines()[0].rstrip(".")
                raise RoughmdrError(f"holds no heights that SurfaceTopography can read: {said}") from error
            raise RoughmdrError(
                f"in no format that SurfaceTopography can read ({name}); text is .txt, .csv, .tsv, .dat, .xyz"
            ) from error


def _read_channel(reader: Any, name: str | None) -> RawMap:
    channels = reader.channels
    names = list(dict.fromkeys(each.name for each in channels))
    if name is not None and name not in names:
        raise RoughmdrError(f"has no channel {name!r}, but {names}")
    maps = [each for each in channels if _kind(each) == "heights" and name in (None, each.name)]
    if not maps:
        kinds = ", ".join(f"{each.name!r} with {_kind(each)}" for each in channels if name in (None, each.name))
        raise RoughmdrError(f"holds no map of heights, but {f'channel {kinds}' if kinds else 'no channel at all'}")
    channel = next((each for each in maps if name is None and each is reader.default_channel), maps[0])
    sizes = channel.physical_sizes
    topography = channel.topography(**({} if sizes else {"physical_sizes": (1.0, 1.0)}))
    height = np.ma.filled(topography.heights(), np.nan)
    unit = "Å" if topography.unit == "A" else topography.unit
    if sizes is None:
        return RawMap(height, unit, rows_along="x")
    if len(sizes) != 2:
        raise RoughmdrError(f"says only one side of the map, {sizes[0]:g} {unit or ''}".rstrip())
    lateral = unit or _lateral_unit(channel)
    factor = float(unit_factor(lateral, "m"))
    dx, dy = (float(side) * factor / points for side, points in zip(sizes, height.shape, strict=True))
    return RawMap(height, unit, (dx, dy), topography.is_periodic, rows_along="x")


def _lateral_unit(channel: Any) -> str:
    """Return the unit of the sides where that of the heights is not known."""
    said = getattr(channel, "info", {}).get("raw_metadata", {})
    lateral = said.get("xunit") if isinstance(said, dict) else None
    if not lateral:
        raise RoughmdrError("does not say in which unit it is; export it as text, where size and unit can be given")
    return str(lateral)


def _kind(channel: Any) -> str:
    """Return the content of a channel in words."""
    if channel.dim != 2:
        return "a line"
    if 0 in (getattr(channel, "nb_grid_pts", None) or ()):
        return "no points"
    return "heights" if channel.data_kind.value == "height" else str(channel.data_kind.value)
