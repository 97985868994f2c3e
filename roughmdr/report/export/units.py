"""Consistent systems of units: length, force and stress of which the stress is the force over the squared length."""

from decimal import Decimal
from typing import NamedTuple

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.schema.units import unit_factor
from roughmdr.schema.wording import short_repr

_PREFIXES = ("f", "p", "n", "u", "m", "", "k", "M", "G", "T")
_DIMENSIONS = {
    "length": ("m", ""),
    "force": ("N", ""),
    "stress": ("Pa", ""),
    "power": ("W/K", "/K"),
    "siemens": ("S", ""),
}
"""Units that can be named, by what they measure: the dimension that reads them, and what it has beside the name."""


class Unit(NamedTuple):
    """A unit by its name, and its size in SI."""

    name: str
    size: float


class UnitSystem(NamedTuple):
    """The units of an exported table; temperatures are in K, times in s."""

    length: Unit
    force: Unit
    stress: Unit
    power: Unit
    siemens: Unit

    @classmethod
    def read(cls, text: str) -> "UnitSystem":
        """Return the system in which units such as "mm,N,MPa" are named, in any order; SI where none is.

        What is not named follows: the stress from force and length, the force from stress and length, the power from
        force times length in a second. StoreError for a name that is no such unit, and for units that do not agree.
        """
        given: dict[str, tuple[str, Decimal]] = {}
        for name in filter(None, (part.strip() for part in text.split(","))):
            if name in ("K", "s"):
                continue
            kind, size = _read(name)
            if kind in given:
                raise StoreError(f"units: {name!r} and {given[kind][0]!r} are both units of {kind}; give one of them")
            given[kind] = name, size
        length = given.get("length", ("m", Decimal(1)))
        area = length[1] * length[1]
        if "stress" in given and "force" not in given:
            name, size = given["stress"]
            force = _named("N", size * area, f"{name} {length[0]}^2")
        else:
            force = given.get("force", ("N", Decimal(1)))
        fitting = _named("Pa", force[1] / area, f"{force[0]}/{length[0]}^2")
        stress = given.get("stress", fitting)
        if stress[1] * area != force[1]:
            said = f"{force[0]} over {length[0]} squared is {fitting[0]}, not {stress[0]}"
            raise StoreError(f"units: {text!r} are not consistent: {said}")
        power = given.get("power", _named("W", force[1] * length[1], f"{force[0]} {length[0]}/s"))
        siemens = given.get("siemens", ("S", Decimal(1)))
        return cls(*(Unit(name, float(size)) for name, size in (length, force, stress, power, siemens)))

    def of(self, dimension: str) -> Unit:
        """Return the unit of a dimension, one of those that tables have, as "W/m2/K"."""
        length, stress = self.length, self.stress
        area = length.size * length.size
        return {
            "1": Unit("1", 1.0),
            "m": length,
            "Pa": stress,
            "N": self.force,
            "1/m2": Unit(f"1/{length.name}^2", 1.0 / area),
            "Pa/m": Unit(f"{stress.name}/{length.name}", stress.size / length.size),
            "N/m": Unit(f"{self.force.name}/{length.name}", self.force.size / length.size),
            "W/m2/K": Unit(f"{self.power.name}/{length.name}^2/K", self.power.size / area),
            "S/m2": Unit(f"{self.siemens.name}/{length.name}^2", self.siemens.size / area),
        }[dimension]

    @property
    def names(self) -> str:
        """The names of length, force and stress."""
        return ", ".join(unit.name for unit in (self.length, self.force, self.stress))


def _read(name: str) -> tuple[str, Decimal]:
    """Return what a unit measures, and its size in SI."""
    for kind, (dimension, beside) in _DIMENSIONS.items():
        try:
            return kind, unit_factor(f"{name}{beside}", dimension)
        except RoughmdrError:
            continue
    raise StoreError(
        f"units: {short_repr(name)} is no unit of length, force or stress (of a conductance also W, S and K); expected "
        'names as in "mm,N,MPa"'
    )


def _named(base: str, size: Decimal, otherwise: str) -> tuple[str, Decimal]:
    """Return a unit of this size in SI: with a prefix where one fits, else named ``otherwise``."""
    dimension, beside = _DIMENSIONS["power"] if base == "W" else (base, "")
    for prefix in _PREFIXES:
        if unit_factor(f"{prefix}{base}{beside}", dimension) == size:
            return f"{prefix}{base}", size
    return otherwise, size
