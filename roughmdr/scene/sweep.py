"""[sweep]: the values of swept keys, and the cells, dimensions and coordinates that they make."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.scene.lateral import HELD
from roughmdr.scene.separation import CLEAR, Separation
from roughmdr.schema.quantities import EntryError, Reader, WholeNumber
from roughmdr.schema.units import DIMENSIONLESS, spelled_in_results
from roughmdr.schema.wording import printable, short_repr, suggestion
from roughmdr.stages import STAGES
from roughmdr.storage.labelled import Array
from roughmdr.variables import CONTROLS, PRELOADS, swept_name

SECTIONS = {"material", "counter", "adhesion", "asperities", "interaction"} | {
    stage.key for stage in STAGES if stage.swept
}
_STOP = "path.separation.stop"
_PATH_KEYS = (
    *(f"path.{control}.{end}" for control in CONTROLS for end in ("start", "stop")),
    f"{_STOP}.contact_fraction",
    f"{_STOP}.pressure",
    *(f"path.{held}" for held in HELD),
    *(f"path.lateral.{end}" for end in ("start", "stop", "amplitude")),
    "path.machine_stiffness",
    *(f"path.{preload}" for preload in PRELOADS),
)
_ALLOWED_FORMS = "must be a list, { linspace = [first, last], num = ... } or { logspace = [first, last], num = ... }"
NUM = WholeNumber(2, 100_000)
ENDS = ("linspace", "logspace")
"""Tables with two ends, which ``num`` values are between."""
_MAX_CELLS = 100_000
_DIGITS = 15  # digits of values between two ends, so that 0.3 is 0.3 and can be selected


class Axis(NamedTuple):
    """One swept key."""

    key: str
    entries: tuple[object, ...]  # as they would stand in the scene
    values: NDArray[Any]  # in SI; names as they are
    unit: str  # of the values; empty for names
    long_name: str

    @property
    def name(self) -> str:
        """Name of the coordinate."""
        return swept_name(self.key)


@dataclass(frozen=True)
class Sweep:
    """Cells of a sweep: all combinations of the axes' values ("product"), or one value of each at a time ("zip").

    Without axes it has one cell and no dimension.
    """

    mode: Literal["product", "zip"] = "product"
    axes: tuple[Axis, ...] = ()

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension, in order."""
        if self.mode == "zip":
            return {"cell": len(self.axes[0].entries)}
        return {axis.name: len(axis.entries) for axis in self.axes}

    def cells(self) -> Iterator[dict[str, object]]:
        """Yield the entry of each swept key for every cell, the last dimension fastest."""
        entries = [axis.entries for axis in self.axes]
        combinations = zip(*entries, strict=True) if self.mode == "zip" else product(*entries)
        for combination in combinations:
            yield dict(zip((axis.key for axis in self.axes), combination, strict=True))

    def coordinates(self) -> dict[str, Array]:
        """Return the swept values over their dimensions."""
        coordinates = {}
        for axis in self.axes:
            unit = {"units": spelled_in_results(axis.unit)} if axis.values.dtype.kind != "U" else {}
            dimension = "cell" if self.mode == "zip" else axis.name
            coordinates[axis.name] = Array((dimension,), axis.values, {**unit, "long_name": axis.long_name})
        return coordinates


def may_be_swept(key: str) -> bool:
    """Return whether a key of a scene that takes a number or a name can be swept."""
    return key.split(".", maxsplit=1)[0] in SECTIONS or key in _PATH_KEYS


def describe_cell(cell: dict[str, object]) -> str:
    """Return the swept keys of a cell with their entries, in words."""
    return ", ".join(f"{key} = {value}" for key, value in cell.items())


def flatten(table: object) -> object:
    """Return [sweep] with dotted keys in place of tables within tables; SceneError if a key is given twice."""
    if not isinstance(table, dict):
        return table
    flat: dict[str, object] = {}

    def walk(inner: dict[str, Any], prefix: str) -> None:
        for name, value in inner.items():
            key = f"{prefix}{name}"
            if isinstance(value, dict) and value and value.keys().isdisjoint({*ENDS, "num"}):
                walk(value, f"{key}.")
            elif key in flat:
                raise SceneError.of([Fault(f"sweep.{printable(key)}", "", "is given twice")])
            else:
                flat[key] = value

    walk(table, "")
    return flat


def read_sweep(table: object, allowed_keys: dict[str, Reader]) -> tuple[Sweep | None, list[Fault]]:
    """Return the sweep of a flattened table, or its faults; ``allowed_keys`` are those that the scene can have."""
    if not isinstance(table, dict):
        return None, [Fault("sweep", short_repr(table), "must be a table")]
    mode = table.get("mode", "product")
    faults = []
    if mode not in ("product", "zip"):
        hint = suggestion(str(mode), ["product", "zip"])
        faults.append(Fault("sweep.mode", short_repr(mode), f"not available{hint}"))
    readers = {key: reader for key, reader in allowed_keys.items() if may_be_swept(key)}
    axes = []
    for key, value in table.items():
        if key == "mode":
            continue
        try:
            axes.append(_axis(key, value, readers, ordered=mode == "product"))
        except EntryError as error:
            entry = "" if error.value is None else short_repr(error.value)
            faults.append(Fault(f"sweep.{printable(error.key)}", entry, str(error)))
    faults += _conflicts(mode, axes)
    if not axes and not faults:
        faults.append(Fault("sweep", "", 'names no key to sweep, like "adhesion.work" = ["10 mJ/m^2", "50 mJ/m^2"]'))
    return (None, faults) if faults else (Sweep(mode, tuple(axes)), [])


def _axis(key: str, value: object, readers: dict[str, Reader], *, ordered: bool) -> Axis:
    reader = readers.get(key)
    if reader is None:
        hint = suggestion(key, sorted(readers))
        raise EntryError(key, None, f"is no number or name of the scene that can be swept{hint}")
    entries = _spaced_entries(key, value, reader) if isinstance(value, dict) else value
    if not isinstance(entries, list) or not entries:
        raise EntryError(key, value, _ALLOWED_FORMS)
    numbers, in_sigma = _read_entries(key, entries, reader)
    unit, long_name = reader.dimension, f"swept {key}"
    if in_sigma:
        unit, long_name = DIMENSIONLESS, f"swept {key}, in standard deviations of the heights"
    order = list(range(len(numbers)))
    if ordered:
        if len(set(numbers)) < len(numbers):
            raise EntryError(key, value, "holds a value twice; a dimension needs each once")
        if not isinstance(numbers[0], str) and numbers != sorted(numbers, reverse=True):
            order.sort(key=numbers.__getitem__)  # a coordinate rises or falls (CF-1.11, section 1.3)
    return Axis(key, tuple(entries[i] for i in order), np.array([numbers[i] for i in order]), unit, long_name)


def _read_entries(key: str, entries: list[object], reader: Reader) -> tuple[list[Any], bool]:
    """Return each entry in SI, or its name, and whether they are multiples of sigma."""
    numbers, in_sigma = [], set()
    for i, entry in enumerate(entries):
        try:
            if isinstance(entry, dict | list):
                raise RoughmdrError("expected a number or a name")
            if entry == CLEAR and key in _PATH_KEYS:
                raise RoughmdrError("is no number to be swept; without start, every cell starts clear")
            number = reader(entry)
        except RoughmdrError as error:
            raise EntryError(f"{key}[{i}]", entry, str(error)) from None
        in_sigma.add(isinstance(number, Separation) and number.in_sigma)
        numbers.append(number.value if isinstance(number, Separation) else getattr(number, "constant", number))
    if len(in_sigma) > 1:
        raise EntryError(key, entries, "must be all in metres or all in sigma")
    return numbers, in_sigma.pop()


def _spaced_entries(key: str, table: dict[str, Any], reader: Reader) -> list[object]:
    """Return the entries of a linspace or logspace; both ends as they were given."""
    kind = next((kind for kind in ENDS if kind in table), None)
    if kind is None:
        raise EntryError(key, table, _ALLOWED_FORMS)
    for other in table.keys() - {kind, "num"}:
        raise EntryError(f"{key}.{other}", None, f"unknown key{suggestion(other, ['num'])}")
    ends = table[kind]
    if not isinstance(ends, list) or len(ends) != 2 or not reader.dimension:
        raise EntryError(f"{key}.{kind}", ends, "must be two numbers, [first, last]")
    if "num" not in table:
        raise EntryError(f"{key}.num", None, "is missing")
    try:
        num = NUM(table["num"])
    except RoughmdrError as error:
        raise EntryError(f"{key}.num", table["num"], str(error)) from None
    (first, last), in_sigma = _read_entries(f"{key}.{kind}", ends, reader)
    if kind == "logspace" and not (first > 0.0 and last > 0.0):
        raise EntryError(f"{key}.{kind}", ends, "must be above 0")
    if not math.isfinite(last - first):
        raise EntryError(f"{key}.{kind}", ends, "are too far apart")
    spaced = np.linspace(first, last, num) if kind == "linspace" else np.geomspace(first, last, num)
    inner: list[Any] = [float(f"{value:.{_DIGITS}g}") for value in spaced[1:-1]]
    if isinstance(reader, WholeNumber):
        if any(not value.is_integer() for value in inner):
            raise EntryError(key, table, "must give whole numbers")
        inner = [int(value) for value in inner]
    if in_sigma:
        inner = [f"{value!r} sigma" for value in inner]
    return [ends[0], *inner, ends[1]]


def _conflicts(mode: str, axes: list[Axis]) -> Iterator[Fault]:
    counts = [len(axis.entries) for axis in axes]
    for axis, count in zip(axes, counts, strict=True):
        for other in axes:
            if axis.key.startswith(f"{other.key}."):
                yield Fault(f"sweep.{axis.key}", "", f"is a part of {other.key}, which is swept too")
        if mode == "zip" and count != counts[0]:
            message = f"has {count} values, {axes[0].key} has {counts[0]}; mode = 'zip' takes equally many"
            yield Fault(f"sweep.{axis.key}", "", message)
    if mode == "product" and math.prod(counts) > _MAX_CELLS:
        yield Fault("sweep", "", f"has {math.prod(counts)} cells; at most {_MAX_CELLS} are allowed")
