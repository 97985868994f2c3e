"""Force curves as programs of atomic force microscopes (AFM) write them; each format is an entry of FORMATS.

Layouts: JPK Data Processing 4 to 6, NanoScope Analysis from 1.5, afmformats from 0.13 (its module ``fmt_tab``).
"""

import json
import logging
import re
from collections.abc import Callable, Mapping
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import short_repr

Rows = list[tuple[str, list[Any]]]
"""The position of each row in the file, in words for messages, and its entries."""


class Columns(NamedTuple):
    """A measurement as it was given."""

    origin: str
    """File or argument, in messages."""
    names: list[str]
    units: list[str]
    """Units as the file spells them; empty for SI."""
    rows: Rows
    stiffness: float | None = None
    """Spring constant that the file tells [N/m]."""
    about: str = ""
    """The format that was found, and what was taken from it, in words."""


class Segment(NamedTuple):
    """An approach to the surface or a retract from it, with the name and the unit of each channel."""

    approach: bool
    channels: list[tuple[str, str]]
    rows: Rows


class Format(NamedTuple):
    """A format: a line that no other files have, and channels, the best first, with commas between."""

    name: str
    line: str
    read: Callable[[str], tuple[list[Segment], Mapping[str, Any]]]
    tip: str
    base: str
    """Position of the cantilever's base."""
    force: str
    """Force or deflection."""


def read_text(text: str) -> Columns | None:
    """Return the force curve in a text; None where no AFM program wrote it, RoughmdrError where it cannot be used.

    Its columns are "separation" or "remote" [m] and the force [N], compression positive, in approach and then retract.
    """
    form = next((each for each in FORMATS if re.search(each.line, text, re.MULTILINE)), None)
    if form is None:
        return None
    try:
        found = form.read(text)
    except ValueError as error:
        raise RoughmdrError(f"{form.name}: cannot be read: {error}") from None
    return _curve(form, *found)


def read_instrument(path: Path) -> Columns:
    """Return the one force curve in a file that afmformats reads; RoughmdrError where there is none."""
    try:
        from afmformats import errors, load_data
    except ImportError:
        raise RoughmdrError(
            "not a text file; formats of AFM instruments are left to afmformats, which is not installed: "
            "pip install -e '.[afm]' in the clone of roughmdr"
        ) from None
    logging.getLogger("afmformats").addHandler(logging.NullHandler())  # else it prints what it meets
    try:
        curves = load_data(path, modality="force-distance")
    except (Exception, errors.AFMFileFormatError, errors.MissingMetaDataError) as error:
        raise RoughmdrError(f"not a text file, and in no format that afmformats reads: {error}") from None
    if len(curves) != 1:
        raise RoughmdrError(f"holds {len(curves)} force curves; a fit takes one")
    names = [name for name in ",".join([*_TABLE[-3:], "segment"]).split(",") if name in curves[0]]
    values = zip(*(curves[0][name].tolist() for name in names), strict=True)
    segments = _segments(names, [(f"point {number}", list(row)) for number, row in enumerate(values)])
    return _curve(_TABLE._replace(name=curves[0].metadata["format"]), segments, curves[0].metadata)


def _curve(form: Format, segments: list[Segment], about: Mapping[str, Any]) -> Columns:
    """Return the control and the force, with their signs and their order; RoughmdrError where they are not there."""
    if not segments:
        raise RoughmdrError(f"{form.name}: holds no approach and no retract")
    stiffness, sensitivity = (about.get(key) or 0.0 for key in ("spring constant", "sensitivity"))
    at = _pick(segments[0], form.tip, {"m": 1.0}) or _pick(segments[0], form.base, {"m": 1.0})
    force = _pick(segments[0], form.force, {"N": 1.0, "m": stiffness, "V": stiffness * sensitivity})
    if at is None or force is None:
        wanted = form.force if at else f"{form.tip},{form.base}"
        there = ", ".join(f"{name} [{unit}]" for name, unit in segments[0].channels)
        raise RoughmdrError(f"{form.name}: has no channel {wanted.replace(',', ' or ')} with a unit; it has {there}")
    if not force[1]:
        lacks = "sensitivity of the detector" if stiffness else "spring constant"
        raise RoughmdrError(f"{form.name}: has {' in '.join(force[0])} alone, and no {lacks}: export the force")
    parts = [_numbers(each, at, force) for each in segments]
    away = [-1.0 if each.approach else 1.0 for each in segments]
    ways = [sense * (part[-1][1][0] - part[0][1][0]) for sense, part in zip(away, parts, strict=True)]
    sign = -1.0 if sum(ways) < 0.0 else 1.0  # an approach brings the tip nearer, wherever heights count from
    rows: Rows = []
    for way, part in zip(ways, parts, strict=True):
        ordered = part[::-1] if sign * way < 0.0 else part  # a retract may be stored from its end
        rows += [(place, [sign * height, load]) for place, (height, load) in ordered]
    control = "separation" if at[0][0] in form.tip.split(",") else "remote"
    said = f"{form.name}: {control} from {at[0][0]}, force from {force[0][0]}"
    said += f", spring constant {format_quantity(stiffness, 'N/m')}" if stiffness else ""
    return Columns("", [control, "force"], ["", ""], rows, stiffness or None, said)


Picked = tuple[tuple[str, str], float]
"""A channel, and one of its unit in SI."""


def _pick(segment: Segment, names: str, factors: dict[str, float]) -> Picked | None:
    """Return the best of some channels, the first dimension first, with these factors; None where there is none."""
    found = (
        (channel, _UNITS[channel[1]][1] * factor)
        for dimension, factor in factors.items()
        for name in names.split(",")
        for channel in segment.channels
        if channel[0] == name and _UNITS.get(channel[1], ("",))[0] == dimension
    )
    return next(found, None)


def _numbers(segment: Segment, *picked: Picked) -> Rows:
    """Return some channels of a segment in SI, row by row."""
    read: Rows = []
    for place, entries in segment.rows:
        try:
            read.append((place, [size * float(entries[segment.channels.index(each)]) for each, size in picked]))
        except (IndexError, ValueError):
            names, row = (" ".join(map(str, each)) for each in ([name for name, _ in segment.channels], entries))
            raise RoughmdrError(f"{place}: {short_repr(row)}: expected numbers for {names}") from None
    return read


def _jpk(text: str) -> tuple[list[Segment], dict[str, float]]:
    """Read segments, each of them below lines "# key: value"."""
    header, segments, rows = dict[str, str](), list[Segment](), Rows()
    for number, line in enumerate([*text.splitlines(), "# end"], start=1):
        if not line.startswith("#"):
            rows += [(f"line {number}", line.split())] if line.strip() else []
            continue
        if rows and header.get("segment") in ("extend", "retract"):
            channels = list(zip(header.get("columns", "").split(), header.get("units", "").split(), strict=False))
            segments.append(Segment(header["segment"] == "extend", channels, rows))
        key, _, value = line.lstrip("# ").partition(":")
        if segments and key == "index" and value.strip() != header.get("index"):
            raise ValueError("holds several force curves; a fit takes one")
        rows = []
        header[key] = value.strip()
    stiffness, per_volt = (float(header.get(key) or 0.0) for key in ("springConstant", "sensitivity"))
    return segments, {"spring constant": stiffness, "sensitivity": per_volt}


def _table(text: str) -> tuple[list[Segment], dict[str, float]]:
    """Read a table below comments: a block of JSON, and last the names of the columns."""
    lines = [(f"line {number}", line.rstrip()) for number, line in enumerate(text.splitlines(), start=1)]
    comments = [line.lstrip("# ") for _, line in lines if line.startswith("#")]
    block = comments[comments.index("BEGIN METADATA") + 1 : comments.index("END METADATA")]
    names = [re.sub(r"-?\d.*", "", title) for title in comments[-1].split("\t")]  # afmformats writes a row behind them
    rows: Rows = [(place, line.split("\t")) for place, line in lines if line and not line.startswith("#")]
    return _segments(names, rows), json.loads("\n".join(block))


def _segments(names: list[str], rows: Rows) -> list[Segment]:
    """Return the segments of a table, whose column ``segment`` is 0 in an approach and 1 in a retract."""
    channels = [(name, "N" if name == "force" else "m") for name in names]
    parts = groupby(rows, key=lambda row: str(row[1][names.index("segment")]))
    ways = {"0": True, "False": True, "1": False, "True": False}
    return [Segment(ways[sense], channels, list(part)) for sense, part in parts if sense in ways]


def _nanoscope(text: str) -> tuple[list[Segment], dict[str, float]]:
    """Read channels side by side: Ex in approach, Rt in retract, with units in their names, as in Defl_pN_Ex."""
    lines = [(f"line {number}", line) for number, line in enumerate(text.splitlines(), start=1)]
    top = next(i for i, (_, line) in enumerate(lines) if re.match(_NANOSCOPE, line))
    titles = [title.strip('" ').split("_") for title in lines[top][1].split("\t")]
    table = [(place, (line + "\t" * len(titles)).split("\t")) for place, line in lines[top + 1 :]]
    segments = list[Segment]()
    for way in ("Ex", "Rt"):
        kept = [i for i, words in enumerate(titles) if way in words]
        units = [next((word for word in titles[i] if word in _UNITS), "") for i in kept]
        names = ["_".join(word for word in titles[i] if word not in (way, *_UNITS)) for i in kept]
        rows: Rows = [(place, [entries[i] for i in kept]) for place, entries in table]
        rows = [row for row in rows if any(map(str.strip, row[1]))]  # one of the two can be the shorter
        segments += [Segment(way == "Ex", list(zip(names, units, strict=True)), rows)] if rows else []
    found = [re.findall(rf"{word} ([\d.]+)", text) for word in (r"\\Spring Constant:", r"\\@Sens\. DeflSens: V")]
    stiffness, per_volt = (float(each[-1]) if each else 0.0 for each in found)
    return segments, {"spring constant": stiffness, "sensitivity": 1e-9 * per_volt}


_UNITS = {"m": ("m", 1.0), "um": ("m", 1e-6), "nm": ("m", 1e-9), "V": ("V", 1.0), "mV": ("V", 1e-3)}
_UNITS |= {"N": ("N", 1.0), "uN": ("N", 1e-6), "nN": ("N", 1e-9), "pN": ("N", 1e-12)}
_TITLE = r'"?\w+_(?:Ex|Rt)(?:_\w+)?"?'
_NANOSCOPE = rf"^{_TITLE}(?:\t{_TITLE})+\s*$"
_HEIGHTS = "strainGaugeHeight,capacitiveSensorHeight,measuredHeight"
_HEIGHTS += ",smoothedStrainGaugeHeight,smoothedCapacitiveSensorHeight,smoothedMeasuredHeight,height"
_TIP = "verticalTipPosition,tipSampleSeparation"
_BASE = "height (measured),height (piezo)"
_TABLE = Format("table of afmformats", "^# BEGIN METADATA", _table, "tip position", _BASE, "force")
_BRUKER = "Separation", "Height_Sensor,Calc_Ramp", "Defl_corr,Defl"
FORMATS = (
    Format("text export of JPK", "^# segment: (extend|retract|pause)", _jpk, _TIP, _HEIGHTS, "vDeflection"),
    Format("text export of NanoScope Analysis", _NANOSCOPE, _nanoscope, *_BRUKER),
    _TABLE,
)
