"""[sweep]: the scene over and over, each time with other values of some of its keys."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.scene.path import Separation
from roughmdr.schema.quantities import EntryError, Reader, WholeNumber
from roughmdr.schema.units import DIMENSIONLESS, udunits
from roughmdr.schema.wording import printable, shown, suggestion
from roughmdr.storage.labelled import Array

_SECTIONS = ("material", "counter", "adhesion", "asperities")
_PATH = ("path.separation.start", "path.separation.stop")
_FORMS = "must be a list, { linspace = [first, last], num = ... } or { logspace = [first, last], num = ... }"
_NUM = WholeNumber(2, 100_000)
_MOST_CELLS = 100_000
_DIGITS = 15  # of the values between two ends, so that 0.3 is 0.3 and can be selected


class Axis(NamedTuple):
    """One swept key."""

    key: str
    entries: tuple[object, ...]
    """As they would stand in the scene."""
    values: NDArray[Any]
    """In SI; names as they are."""
    unit: str
    """Of the values; empty for names."""
    long_name: str

    @property
    def name(self) -> str:
        """Of its coordinate."""
        return self.key.replace(".", "_")

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers, and not names."""
        return self.values.dtype.kind != "U"


@dataclass(frozen=True)
class Sweep:
    """The cells of a sweep: all combinations of the axes' values, or the first of each, the second of each, ...

    Without axes it has one cell and no dimension.
    """

    mode: Literal["product", "zip"] = "product"
    axes: tuple[Axis, ...] = ()

    @property
    def sizes(self) -> dict[str, int]:
        """The dimensions, in their order."""
        if self.mode == "zip":
            return {"cell": len(self.axes[0].entries)}
        return {axis.name: len(axis.entries) for axis in self.axes}

    def cells(self) -> Iterator[dict[str, object]]:
        """For each cell, the last dimension fastest, what stands under each swept key."""
        entries = [axis.entries for axis in self.axes]
        combinations = zip(*entries, strict=True) if self.mode == "zip" else product(*entries)
        for combination in combinations:
            yield dict(zip((axis.key for axis in self.axes), combination, strict=True))

    def coordinates(self) -> dict[str, Array]:
        """The swept values over their dimensions."""
        coordinates = {}
        for axis in self.axes:
            unit = {"units": udunits(axis.unit)} if axis.numeric else {}
            dimension = "cell" if self.mode == "zip" else axis.name
            coordinates[axis.name] = Array((dimension,), axis.values, {**unit, "long_name": axis.long_name})
        return coordinates


def in_words(cell: dict[str, object]) -> str:
    """What stands under the swept keys of a cell."""
    return ", ".join(f"{key} = {value}" for key, value in cell.items())


def flatten(table: object) -> object:
    """[sweep] with its keys dotted, whether they came so or as tables within tables; SceneError if one came twice."""
    if not isinstance(table, dict):
        return table
    flat: dict[str, object] = {}

    def walk(inner: dict[str, Any], at: str) -> None:
        for name, value in inner.items():
            if isinstance(value, dict) and value and value.keys().isdisjoint({"linspace", "logspace", "num"}):
                walk(value, f"{at}{name}.")
            elif f"{at}{name}" in flat:
                raise SceneError.of([Fault(f"sweep.{printable(at + name)}", "", "is given twice")])
            else:
                flat[f"{at}{name}"] = value

    walk(table, "")
    return flat


def read_sweep(table: object, known: dict[str, Reader]) -> tuple[Sweep | None, list[Fault]]:
    """The sweep of a flattened table, and all that is wrong with it; ``known`` are the keys that the scene can have."""
    if not isinstance(table, dict):
        return None, [Fault("sweep", shown(table), "must be a table")]
    mode = table.get("mode", "product")
    faults = []
    if mode not in ("product", "zip"):
        faults.append(Fault("sweep.mode", shown(mode), f"not available{suggestion(str(mode), ['product', 'zip'])}"))
    allowed = {key: reader for key, reader in known.items() if key.split(".")[0] in _SECTIONS or key in _PATH}
    axes = []
    for key, value in table.items():
        if key == "mode":
            continue
        try:
            axes.append(_axis(key, value, allowed, ordered=mode == "product"))
        except EntryError as error:
            value_shown = "" if error.value is None else shown(error.value)
            faults.append(Fault(f"sweep.{printable(error.key)}", value_shown, str(error)))
    faults += _misfits(mode, axes) if axes else []
    if not axes and not faults:
        faults.append(Fault("sweep", "", 'names no key to sweep, like "adhesion.work" = ["10 mJ/m^2", "50 mJ/m^2"]'))
    return (None, faults) if faults else (Sweep(mode, tuple(axes)), [])


def _axis(key: str, value: object, allowed: dict[str, Reader], *, ordered: bool) -> Axis:
    reader = allowed.get(key)
    if reader is None:
        hint = suggestion(key, sorted(allowed))
        raise EntryError(key, None, f"is no number or name of the scene that can be swept{hint}")
    entries = _between(key, value, reader) if isinstance(value, dict) else value
    if not isinstance(entries, list) or not entries:
        raise EntryError(key, value, _FORMS)
    numbers, in_sigma = _numbers(key, entries, reader)
    unit, long_name = reader.dimension, f"swept {key}"
    if in_sigma:
        unit, long_name = DIMENSIONLESS, f"swept {key}, in standard deviations of the heights"
    if not ordered:
        return Axis(key, tuple(entries), np.array(numbers), unit, long_name)
    if len(set(numbers)) < len(numbers):
        raise EntryError(key, value, "holds a value twice; a dimension needs each once")
    order = list(range(len(numbers)))
    if not isinstance(numbers[0], str) and numbers != sorted(numbers, reverse=True):
        order.sort(key=numbers.__getitem__)  # a coordinate rises or falls (CF-1.11, section 1.3)
    return Axis(key, tuple(entries[i] for i in order), np.array([numbers[i] for i in order]), unit, long_name)


def _numbers(key: str, entries: list[object], reader: Reader) -> tuple[list[Any], bool]:
    """Each entry in SI, or a name; and whether they are multiples of sigma."""
    numbers, in_sigma = [], set()
    for i, entry in enumerate(entries):
        try:
            if isinstance(entry, dict | list):
                raise RoughmdrError("expected a number or a name")
            number = reader(entry)
        except RoughmdrError as error:
            raise EntryError(f"{key}[{i}]", entry, str(error)) from None
        in_sigma.add(isinstance(number, Separation) and number.in_sigma)
        numbers.append(number.value if isinstance(number, Separation) else getattr(number, "constant", number))
    if len(in_sigma) > 1:
        raise EntryError(key, entries, "must be all in metres or all in sigma")
    return numbers, in_sigma.pop()


def _between(key: str, table: dict[str, Any], reader: Reader) -> list[object]:
    """The entries that linspace or logspace stand for; both ends as they were given."""
    kind = next((kind for kind in ("linspace", "logspace") if kind in table), None)
    for other in table.keys() - {kind, "num"} if kind else ():
        raise EntryError(f"{key}.{other}", None, f"unknown key{suggestion(other, ['num'])}")
    if kind is None:
        raise EntryError(key, table, _FORMS)
    ends = table[kind]
    if not isinstance(ends, list) or len(ends) != 2 or not reader.dimension:
        raise EntryError(f"{key}.{kind}", ends, "must be two numbers, [first, last]")
    if "num" not in table:
        raise EntryError(f"{key}.num", None, "is missing")
    try:
        num = _NUM(table["num"])
    except RoughmdrError as error:
        raise EntryError(f"{key}.num", table["num"], str(error)) from None
    (first, last), in_sigma = _numbers(f"{key}.{kind}", ends, reader)
    if kind == "logspace" and not (first > 0.0 and last > 0.0):
        raise EntryError(f"{key}.{kind}", ends, "must be above 0")
    if not math.isfinite(last - first):
        raise EntryError(f"{key}.{kind}", ends, "are too far apart")
    space = np.linspace(first, last, num) if kind == "linspace" else np.geomspace(first, last, num)
    inner: list[Any] = [float(f"{value:.{_DIGITS}g}") for value in space[1:-1]]
    if isinstance(reader, WholeNumber):
        if any(not value.is_integer() for value in inner):
            raise EntryError(key, table, "must give whole numbers")
        inner = [int(value) for value in inner]
    if in_sigma:
        inner = [f"{value!r} sigma" for value in inner]
    return [ends[0], *inner, ends[1]]


def _misfits(mode: str, axes: list[Axis]) -> list[Fault]:
    faults = []
    for axis in axes:
        for other in axes:
            if axis.key.startswith(f"{other.key}."):
                faults.append(Fault(f"sweep.{axis.key}", "", f"is a part of {other.key}, which is swept too"))
        if mode == "zip" and len(axis.entries) != len(axes[0].entries):
            count, first = len(axis.entries), len(axes[0].entries)
            message = f"has {count} values, {axes[0].key} has {first}; mode = 'zip' takes equally many"
            faults.append(Fault(f"sweep.{axis.key}", "", message))
    cells = math.prod(len(axis.entries) for axis in axes)
    if mode == "product" and cells > _MOST_CELLS:
        faults.append(Fault("sweep", "", f"has {cells} cells; at most {_MOST_CELLS} are allowed"))
    return faults
