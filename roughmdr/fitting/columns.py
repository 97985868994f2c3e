"""The columns of a measurement, as a file, a DataFrame or a Dataset has them: names, units, entries row by row."""

import csv
import os
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.fitting.formats import Columns, Rows, read_instrument, read_text
from roughmdr.schema.wording import short_repr
from roughmdr.storage.files import check_regular_file, is_open_pipe
from roughmdr.storage.result_file import FIT
from roughmdr.variables import MEASURED

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_UNIT = r"\[[^\]]*\]|\([^)]*\)|/\s*\S+"
_HEADER = re.compile(rf"\s*([^\[\](/]*?)\s*({_UNIT})?\s*")
_SPACED_HEADER = re.compile(rf"[^\s\[(/]+(?:\s*(?:{_UNIT}))?")
_DECIMAL_COMMA = re.compile(r"([-+]?\d*),(\d+(?:e[-+]?\d+)?)", re.IGNORECASE)
_CONTROL = re.compile("separation|remote|piezo", re.IGNORECASE)
_MAX_BYTES = 2**28


def read_columns(measured: "str | Path | pd.DataFrame | xr.Dataset") -> Columns:
    """Return the columns of a measurement; StoreError where it is none or cannot be read."""
    if isinstance(measured, str | os.PathLike):
        try:
            return _of_text(Path(measured))
        except RoughmdrError as error:
            raise StoreError(f"{Path(measured)}: {error}") from None
    if hasattr(measured, "data_vars"):
        return _of_dataset(measured)
    if hasattr(measured, "columns") and hasattr(measured, "itertuples"):
        rows = [(f"row {label}", list(row)) for label, *row in measured.itertuples(name=None)]
        return _titled("measured", list(map(str, measured.columns)), rows)
    raise StoreError(f"measured is {short_repr(measured)}; it must be the path of a CSV file, a DataFrame or a Dataset")


def _of_text(path: Path) -> Columns:
    text = _decoded(_content(path))
    is_text = "\0" not in text
    lines = list(_lines(text)) if is_text else []
    curve = read_text(text) if is_text else read_instrument(path)
    if curve is None and lines and not _CONTROL.search(lines[0][1]):
        with suppress(RoughmdrError):  # text of an instrument that afmformats alone knows, where it is installed
            curve = read_instrument(path)
    if curve is not None:
        return curve._replace(origin=str(path))
    if not lines:
        raise RoughmdrError("is empty; expected a line with the names of the columns, and rows")
    _, header = lines[0]
    separator = next((each for each in ";\t," if each in header), "")
    if separator:
        (titles,) = csv.reader([header], delimiter=separator)
        entries = list(csv.reader((line for _, line in lines[1:]), delimiter=separator))
    else:
        titles = _SPACED_HEADER.findall(header)
        entries = [line.split() for _, line in lines[1:]]
    if separator and not titles[-1].strip() and all(row and not row[-1].strip() for row in entries):
        titles, entries = titles[:-1], [row[:-1] for row in entries]  # a delimiter ends each line
    rows = Rows()
    for (place, _), row in zip(lines[1:], entries, strict=True):
        if len(row) != len(titles):
            hint = "; write decimal points" if separator == "," and len(row) == 2 * len(titles) else ""
            raise RoughmdrError(f"{place}: has {len(row)} entries; the first line names {len(titles)} columns{hint}")
        rows.append((place, [_with_point(entry.strip()) for entry in row]))
    return _titled(str(path), titles, rows)


def _decoded(content: bytes) -> str:
    """Return text in UTF-8, in UTF-16 as spreadsheets write it, or in Western European letters."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _with_point(entry: str) -> str:
    """Return a number with a decimal point in place of a comma; any other entry stays as it is."""
    match = _DECIMAL_COMMA.fullmatch(entry)
    return f"{match[1]}.{match[2]}" if match else entry


def _content(path: Path) -> bytes:
    try:
        if not is_open_pipe(path):
            check_regular_file(path)
        with path.open("rb") as file:
            content = file.read(_MAX_BYTES + 1)
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None
    if len(content) > _MAX_BYTES:
        raise RoughmdrError(f"is longer than {_MAX_BYTES} bytes, the most that a measured curve can have")
    return content


def _lines(text: str) -> Iterator[tuple[str, str]]:
    """Yield the lines that are neither empty nor comments, each after its position in words."""
    for number, line in enumerate(text.splitlines(), start=1):
        kept = line.partition("#")[0]
        if kept.strip():
            yield f"line {number}", kept


def _of_dataset(dataset: Any) -> Columns:
    """Return those arrays of a Dataset that a measurement can have."""
    found = {str(name): dataset[name] for name in dataset.variables if name in MEASURED}
    for name, array in found.items():
        if array.ndim != 1 or array.dims != next(iter(found.values())).dims:
            raise StoreError(f"measured: {name} has the dimensions {array.dims}; all must have the same one alone")
    values = zip(*(array.to_numpy().tolist() for array in found.values()), strict=True)
    rows = [(f"row {number}", list(row)) for number, row in enumerate(values)]
    units = [str(each.attrs.get("units", "")) for each in found.values()]
    stiffness = dataset.get("spring_constant") if dataset.attrs.get("kind") == FIT else None
    return Columns("measured", list(found), units, rows, None if stiffness is None else float(stiffness))


def _titled(origin: str, titles: list[str], rows: Rows) -> Columns:
    """Return the columns of these titles, each a name and perhaps a unit: "force [mN]", "force (mN)" or "force/mN"."""
    names, units = [], []
    for title in titles:
        match = _HEADER.fullmatch(title)
        name, unit = (match[1], match[2] or "") if match else (title, "")
        names.append("_".join(name.split()).lower())
        units.append(unit.strip("/").strip() if unit.startswith("/") else unit[1:-1].strip())
    return Columns(origin, names, units, rows)
