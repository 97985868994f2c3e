"""Height maps that are plain numbers: rows along x, columns along y, as text or as NumPy writes them."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.maps.raw_map import RawMap
from roughmdr.errors import RoughmdrError

_DELIMITERS = (";", ",", "\t")


def read_npy(path: Path, channel: str | None) -> RawMap:
    """Read the array of a .npy file; RoughmdrError where it is none, or would run code to be read."""
    _refuse_channel(channel)
    return RawMap(_array(_load(path)))


def read_npz(path: Path, channel: str | None) -> RawMap:
    """Read the array ``channel`` of a .npz file, or height, or the only one; RoughmdrError where there is none."""
    arrays = _load(path)
    if not isinstance(arrays, np.lib.npyio.NpzFile):
        raise RoughmdrError("not an .npz file; it may be an .npy file under another name")
    with arrays:
        names = list(arrays.files)
        name = channel or ("height" if "height" in names or len(names) != 1 else names[0])
        if name not in names:
            raise RoughmdrError(f"has no array {name!r}, but {names}; name one as channel")
        try:
            return RawMap(_array(arrays[name]))
        except Exception as error:
            raise RoughmdrError(f"its array {name!r} cannot be read: {error}") from error


def read_text(path: Path, channel: str | None) -> RawMap:
    """Read rows of numbers separated by blanks, tabs, commas or semicolons; # begins a comment, "nan" is undefined.

    RoughmdrError where the file is not such a text.
    """
    _refuse_channel(channel)
    try:
        with path.open(encoding="utf-8-sig") as file:
            first = next((line for line in file if line.partition("#")[0].strip()), "").partition("#")[0]
        if not first:
            raise RoughmdrError("holds no numbers")
        delimiter = next((mark for mark in _DELIMITERS if mark in first.strip()), None)
        return RawMap(np.loadtxt(path, delimiter=delimiter, encoding="utf-8-sig", ndmin=2))
    except UnicodeDecodeError:
        raise RoughmdrError("not a text file in UTF-8") from None
    except RoughmdrError:
        raise
    except ValueError as error:
        raise RoughmdrError(f"not a table of numbers: {str(error).partition(';')[0]}") from None


def _refuse_channel(channel: str | None) -> None:
    if channel is not None:
        raise RoughmdrError(f"holds one map only; leave out channel = {channel!r}")


def _load(path: Path) -> Any:
    try:
        return np.load(path, allow_pickle=False)
    except Exception as error:
        raise RoughmdrError(f"cannot be read by NumPy: {str(error).partition('. ')[0]}") from error


def _array(value: Any) -> NDArray[Any]:
    if not isinstance(value, np.ndarray):
        raise RoughmdrError("not an .npy file; it may be an .npz file under another name")
    return value
