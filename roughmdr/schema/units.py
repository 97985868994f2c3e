"""SI units, read and written: "50 mJ/m^2" is 0.05 J/m^2."""

import math
import re
from contextlib import suppress
from decimal import Decimal
from functools import cache
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.schema.wording import short_repr

_PREFIX = {"f": -15, "p": -12, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "c": -2, "k": 3, "M": 6, "G": 9, "T": 12}
_LENGTHS = {"nano": -9, "micro": -6, "milli": -3, "centi": -2, "": 0}
_ENDINGS = ("er", "re", "ers", "res")
_METRES = {f"{prefix}met{end}": Decimal(10) ** power for prefix, power in _LENGTHS.items() for end in _ENDINGS}
_MICRON, _ANGSTROM = Decimal("1e-6"), Decimal("1e-10")
_ALONE = {
    "1": {"%": Decimal("0.01")},
    "m": {**_METRES, "micron": _MICRON, "microns": _MICRON, "angstrom": _ANGSTROM, "Å": _ANGSTROM},
    "J/m^2": {"erg/cm^2": Decimal("1e-3")},
    "N/m": {
        f"{of}N/{over}m": Decimal(10) ** (power - _PREFIX[over])
        for over in ("n", "u", "µ", "μ", "m")
        for of, power in {"": 0, **_PREFIX}.items()
    },
}

# For each SI unit, as in ``variables``, its spellings and the power to which a prefix is raised there (mm^2: 2).
_BASES: dict[str, tuple[tuple[str, int], ...]] = {
    "m": (("m", 1),),
    "m2": (("m^2", 2), ("m2", 2)),
    "m-2": (("/m^2", -2), ("m^-2", -2)),
    "Pa": (("Pa", 1), ("N/m^2", 1)),
    "J/m^2": (("J/m^2", 1), ("N/m", 1)),
    "N": (("N", 1),),
    "N/m": (("N/m", 1),),
    "Pa/m": (("Pa/m", 1),),
    "s": (("s", 1),),
    "m/s": (("m/s", 1),),
    "W/m/K": (("W/m/K", 1), ("W/(m K)", 1)),
    "W/K": (("W/K", 1),),
    "ohm m": (("ohm m", 1), ("ohm*m", 1), ("Ω m", 1)),
    "S": (("S", 1),),
}
DIMENSIONLESS = "1"


@cache
def _table(dimension: str) -> dict[str, Decimal]:
    """Units of a dimension in SI, as decimals, so that "10 um" is the float 1e-5 and not its neighbour."""
    table = dict(_ALONE.get(dimension, {}))
    for base, power in _BASES[dimension]:
        table[base] = Decimal(1)
        slash = "/" if base.startswith("/") else ""
        for prefix, exponent in _PREFIX.items():
            table[slash + prefix + base.removeprefix("/")] = Decimal(10) ** (exponent * power)
    return table


_EXAMPLES = {
    "m": '"10 um", "5 nm"', "Pa": '"3 MPa", "70 GPa"', "J/m^2": '"50 mJ/m^2"', "m2": '"1 mm^2"',
    "m-2": '"1e9 /m^2"', "N": '"3 mN"',
    "N/m": '"0.1 N/m", "1 nN/um"', "Pa/m": '"1 MPa/m"',
    "s": '"10 ms"', "m/s": '"1 um/s"', "W/m/K": '"50 W/m/K"', "ohm m": '"20 nohm m"',
    "W/K": '"3 mW/K"', "S": '"2 kS"',
}  # fmt: skip
_SHOWN = {-15: "f", -12: "p", -9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_DIGITS, _ERROR_DIGITS = 4, 2
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*")


def quantity(value: object, dimension: str) -> float:
    """A number in SI, a string with a unit of the dimension or a quantity of pint as a float in SI; RoughmdrError where
    it is none of these.
    """
    value = as_text(value)
    wanted = f"expected a number in {dimension} or a string like {_EXAMPLES.get(dimension, 'a plain number')}"
    wanted = "expected a plain number" if dimension == DIMENSIONLESS else wanted
    match = _QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if match is None and (isinstance(value, bool) or not isinstance(value, Real)):
        raise RoughmdrError(wanted)
    try:
        exact: Any = Decimal(match[1]) * unit_factor(match[2], dimension) if match else value
        number = float(exact)
    except ArithmeticError:
        reason = "expected a number that a float can hold" if match else f"{wanted}; this is too large for a float"
        raise RoughmdrError(reason) from None
    if number == 0.0 and exact != 0:
        raise RoughmdrError("expected a number that a float can hold; this is too near to 0")
    if not math.isfinite(number):
        raise RoughmdrError("expected a finite number")
    return number


def as_text(value: Any) -> Any:
    """Return a quantity of pint as a string with a unit, one of several numbers as a list of them, each in a list too.

    Other values are returned as they are. RoughmdrError where no quantity of a scene has its dimension.
    """
    if isinstance(value, list | tuple):
        return [as_text(each) for each in value]
    if not (hasattr(value, "magnitude") and hasattr(value, "is_compatible_with")):
        return value
    unit = f"{value.units:~C}"
    if unit and not _is_known(unit):
        spelled = [f"1{base}" if base[0] == "/" else base for ((base, _), *_) in _BASES.values()]
        fitting = [base for base in spelled if value.is_compatible_with(base)]
        if not fitting:
            raise RoughmdrError(f"no quantity of a scene has the unit {value.units}")
        unit = fitting[-1]  # N/m rather than J/m^2, since it is read for both
        value = value.to(unit)
    return _with_unit(value.magnitude.tolist() if hasattr(value.magnitude, "tolist") else value.magnitude, unit)


def to_plain(value: Any) -> Any:
    """Convert arrays, tuples and sets to lists, numpy's numbers to Python's, and quantities of pint to strings."""
    if isinstance(value, dict):
        return {key: to_plain(entry) for key, entry in value.items()}
    if isinstance(value, set | frozenset):
        return sorted(map(to_plain, value), key=repr)
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, list | tuple):
        return [to_plain(entry) for entry in value]
    if not hasattr(value, "magnitude"):
        return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    with suppress(RoughmdrError):  # the reader of the key will refuse it
        return as_text(value)
    return value


def _with_unit(numbers: Any, unit: str) -> Any:
    """Return a number, or each of several, as a string with a unit; as it is where the unit is empty."""
    if isinstance(numbers, list):
        return [_with_unit(each, unit) for each in numbers]
    return f"{numbers!r} {unit}" if unit else numbers


def _is_known(unit: str) -> bool:
    """Return whether strings may have a unit, whatever its dimension."""
    for dimension in (*_BASES, DIMENSIONLESS):
        with suppress(RoughmdrError):
            unit_factor(unit, dimension)
            return True
    return False


def millipascals(value: object) -> str:
    """Return a doubt about a string in millipascals, which are seldom meant; empty for any other value."""
    if isinstance(value, str) and value.rstrip().endswith("mPa"):
        return "mPa are millipascals, 1e-3 Pa; if megapascals are meant, write MPa"
    return ""


def unit_factor(unit: str, dimension: str) -> Decimal:
    """Return the value of one ``unit`` in SI; no unit means SI. RoughmdrError where it is no unit of the dimension."""
    unit = unit.strip()
    if unit in ("", dimension):
        return Decimal(1)
    if dimension == DIMENSIONLESS:
        if unit in _ALONE[DIMENSIONLESS]:
            return _ALONE[DIMENSIONLESS][unit]
        raise RoughmdrError(f"has the unit {short_repr(unit)}, but is a plain number")
    spelled = unit.removeprefix("1").lstrip() if unit.startswith("1/") else unit
    spelled = spelled.replace("**", "^").replace("²", "^2").replace(" m-2", "/m^2").replace(" m^-2", "/m^2")
    table = _table(dimension) if dimension in _BASES else {}
    if spelled in table:
        return table[spelled]
    others = [f"{unit!r} is a unit of {other}" for other in _BASES if spelled in _table(other)]
    found = others[0] if others else f"unknown unit {short_repr(unit)}"
    raise RoughmdrError(f"{found}; expected a unit of {dimension}, like {_EXAMPLES.get(dimension, 'a plain number')}")


def spelled_in_results(unit: str) -> str:
    """Return a unit of a scene as results spell it: "J/m^2" as "J m-2"."""
    above, *below = unit.split("/")
    powers = [f"{name}-{power or 1}" for name, _, power in (part.partition("^") for part in below)]
    return " ".join(filter(None, [above, *powers]))


def dimension_of(unit: str) -> str:
    """Return a unit of a result as readers of quantities have it: "J m-2" as "J/m^2"."""
    return {spelled_in_results(base): base for base in _BASES}.get(unit, unit)


def quantity_pattern(dimension: str) -> str:
    """Return a regular expression of the strings that ``quantity`` reads, but for numbers beyond those of a float."""
    prefix = f"[{''.join(_PREFIX)}]?"
    units = [dimension, *_ALONE.get(dimension, {})]
    for base, _ in _BASES.get(dimension, ()):
        units.append(f"1?/{prefix}{base[1:]}" if base.startswith("/") else f"{prefix}{base}")
    spelled = "|".join(map(_any_spelling, dict.fromkeys(units)))
    return rf"^\s*{NUMBER}\s*(?:{spelled})?\s*$"


def _any_spelling(unit: str) -> str:
    """Return a regular expression of all spellings of a unit, as ``unit_factor`` takes them for one."""
    unit = re.sub(r"([*()])", r"\\\1", unit)
    power = r"(?:\^|\*\*)"
    square = rf"m(?:{power}2|²)"
    for spelled, pattern in (("/m^2", f"(?:/{square}| m{power}?-2)"), ("m^2", square), ("m^-2", f"m{power}-2")):
        unit = unit.replace(spelled, pattern)
    return unit


def example_of_unit(dimension: str) -> str:
    """Return an example of a quantity with a unit, in quotes; empty for plain numbers."""
    return _EXAMPLES.get(dimension, "").partition(",")[0]


def format_quantity(
    value: float, unit: str, *, to: float | None = None, error: float | None = None, digits: int = _DIGITS
) -> str:
    """Format a quantity in SI with a prefix: "1.234 uN", with its error "1.23 ± 0.05 uN", as a range "0.2 to 1.5 um".

    ``unit`` is that of ``value``, as in a scene or in a result; ``to`` is the other end of the range, told where it is
    another number; ``digits`` are those of both. A single quantity is read again by ``quantity``.
    """
    given = [abs(number) for number in (value, to, error) if number is not None and math.isfinite(number)]
    power, name = _shown(max(given, default=0.0), unit)
    text = _plain(value, power, digits)
    if to is not None and to != value:
        text += f" to {_plain(to, power, digits)}"
    if error is not None and math.isfinite(error):
        text += f" ± {_plain(error, power, _ERROR_DIGITS)}"
    return text if unit == DIMENSIONLESS else f"{text} {name}"


def axis_unit(largest: float, unit: str) -> tuple[float, str]:
    """Return the unit of an axis for numbers up to ``largest`` in ``unit``: its size in SI, and its name."""
    power, name = _shown(abs(largest), unit)
    return 10.0**power, name


def _shown(largest: float, unit: str) -> tuple[int, str]:
    """Return the unit for showing numbers up to ``largest`` in ``unit``: its power of ten in SI, and its name."""
    if unit == DIMENSIONLESS:
        return 0, ""
    spelled, power = _BASES.get(dimension_of(unit), ((unit, 1),))[0]
    exponent = _exponent(largest, power)
    slash = "/" if spelled.startswith("/") else ""
    return exponent * power, f"{slash}{_SHOWN[exponent]}{spelled.removeprefix('/')}"


def _exponent(value: float, power: int) -> int:
    """Return the exponent of the prefix, raised to ``power``, by which a value is from 1 to 1000, or to 1000^power."""
    if not 0.0 < value < math.inf:
        return 0
    decade = Decimal(f"{value:.{_DIGITS - 1}e}").adjusted()  # of the value as it is shown
    whole = decade // (3 * power) if power > 0 else -(decade // (-3 * power))
    return min(max(3 * whole, min(_SHOWN)), max(_SHOWN))


def _plain(value: float, power: int, digits: int) -> str:
    """Format a value over 10^power, without an exponent where it is near 1."""
    if not math.isfinite(value):
        return f"{value:g}"
    scaled = Decimal(f"{value:.{digits - 1}e}").scaleb(-power).normalize()
    return f"{scaled:f}" if -_DIGITS <= scaled.adjusted() < 2 * _DIGITS or not scaled else f"{scaled:g}".lower()
