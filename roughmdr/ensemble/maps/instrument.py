"""Height maps in the formats of instruments, read by SurfaceTopography where that is installed."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from roughmdr.ensemble.maps.raw_map import RawMap
from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import unit_factor


def read_instrument(path: Path, channel: str | None) -> RawMap:
    """The channel of that name, or the file's default one; undefined points become NaN.

    Of several channels of one name, the first. RoughmdrError where the file cannot be read or is no map of heights.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what is in the file, or not installed, beside the map
        try:
            from SurfaceTopography.IO import open_topography
        except ImportError:
            raise RoughmdrError(
                f"{path.suffix or 'a format without a suffix'} is left to SurfaceTopography, which is not installed: "
                "pip install 'roughmdr[surface]'; without it there are .nc, .npy, .npz, .txt, .csv, .tsv and .dat"
            ) from None
        try:
            with open_topography(str(path)) as reader:
                return _content(reader, channel)
        except RoughmdrError:
            raise
        except Exception as error:
            raise RoughmdrError(
                f"in no format that SurfaceTopography can read ({type(error).__name__}); text is .txt, .csv, .tsv, .dat"
            ) from error


def _content(reader: Any, channel: str | None) -> RawMap:
    chosen = reader.default_channel
    if channel is not None:
        names = [each.name for each in reader.channels]
        if channel not in names:
            raise RoughmdrError(f"has no channel {channel!r}, but {list(dict.fromkeys(names))}")
        chosen = reader.channels[names.index(channel)]
    if chosen.dim != 2 or chosen.data_kind.value != "height":
        what = "a line" if chosen.dim != 2 else chosen.data_kind.value
        raise RoughmdrError(f"channel {chosen.name!r} holds {what}, not a map of heights")
    sizes = chosen.physical_sizes
    found = chosen.topography(**({} if sizes else {"physical_sizes": (1.0, 1.0)}))
    height = np.ma.filled(found.heights(), np.nan)
    unit = "Å" if found.unit == "A" else found.unit
    if sizes is None:
        return RawMap(height, unit)
    if unit is None:
        raise RoughmdrError("does not say in which unit it is; export it as text, where size and unit can be given")
    factor = float(unit_factor(unit, "m"))
    dx, dy = (float(side) * factor / points for side, points in zip(sizes, height.shape, strict=True))
    return RawMap(height, unit, (dx, dy), found.is_periodic)
