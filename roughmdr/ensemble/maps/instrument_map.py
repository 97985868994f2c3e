"""Height maps in the formats of instruments, read by SurfaceTopography where that is installed."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from roughmdr.ensemble.maps.raw_map import RawMap
from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import unit_factor


def read_instrument(path: Path, channel: str | None) -> RawMap:
    """Read the first channel of that name, or the file's default one; undefined points become NaN.

    RoughmdrError where the file cannot be read or is not a map of heights.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of other contents of the file, or packages that are not installed
        try:
            from SurfaceTopography.IO import open_topography
        except ImportError:
            raise RoughmdrError(
                f"{path.suffix or 'a format without a suffix'} is left to SurfaceTopography, which is not installed: "
                "pip install 'roughmdr[surface]'; without it there are .nc, .npy, .npz, .txt, .csv, .tsv and .dat"
            ) from None
        try:
            with open_topography(str(path)) as reader:
                return _read_channel(reader, channel)
        except RoughmdrError:
            raise
        except Exception as error:
            raise RoughmdrError(
                f"in no format that SurfaceTopography can read ({type(error).__name__}); text is .txt, .csv, .tsv, .dat"
            ) from error


def _read_channel(reader: Any, name: str | None) -> RawMap:
    channel = reader.default_channel
    if name is not None:
        names = [each.name for each in reader.channels]
        if name not in names:
            raise RoughmdrError(f"has no channel {name!r}, but {list(dict.fromkeys(names))}")
        channel = reader.channels[names.index(name)]
    if channel.dim != 2 or channel.data_kind.value != "height":
        kind = "a line" if channel.dim != 2 else channel.data_kind.value
        raise RoughmdrError(f"channel {channel.name!r} holds {kind}, not a map of heights")
    sizes = channel.physical_sizes
    topography = channel.topography(**({} if sizes else {"physical_sizes": (1.0, 1.0)}))
    height = np.ma.filled(topography.heights(), np.nan)
    unit = "Å" if topography.unit == "A" else topography.unit
    if sizes is None:
        return RawMap(height, unit)
    if unit is None:
        raise RoughmdrError("does not say in which unit it is; export it as text, where size and unit can be given")
    factor = float(unit_factor(unit, "m"))
    dx, dy = (float(side) * factor / points for side, points in zip(sizes, height.shape, strict=True))
    return RawMap(height, unit, (dx, dy), topography.is_periodic)
