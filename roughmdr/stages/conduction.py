"""[conduction]: how the bodies conduct heat and electricity, and the conductances of their contacts."""

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import model_validator

from roughmdr.errors import OutOfRange
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.stages.stage import Contacts, Given, Law, Stage
from roughmdr.variables import CONDUCTANCES

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.loading.lateral import Path
    from roughmdr.numerics.arguments import Floats

_Conductivity = Annotated[float, Quantity("W/m/K", above=0.0)]
_Resistivity = Annotated[float, Quantity("ohm m", above=0.0)]
_NEEDED = dict(zip(CONDUCTANCES, ("conductivity", "resistivity"), strict=True))
RADIUS = "conductance_radius"
"""Variable that conductances are proportional to."""


class Conduction(Stage):
    """[conduction]: thermal conductivity, electrical resistivity, or both; the other body's where it has another.

    A rigid body conducts too.
    """

    key = "conduction"
    about = "How the bodies conduct, for thermal_conductance and electrical_conductance"
    about_absent = "conductances"
    examples: ClassVar[Mapping[str, str]] = {"conductivity": '"400 W/m/K"', "resistivity": '"17e-9 ohm m"'}
    small_scene: ClassVar[Mapping[str, Any]] = {
        "conduction": {"conductivity": "400 W/m/K"},
        "output": {"variables": ["force", "thermal_conductance"]},
    }
    own_variables = tuple(CONDUCTANCES)
    papers: ClassVar[Mapping[str, str]] = {"Holm1967": "conductance", "Barber2003": "conductance"}

    conductivity: _Conductivity | None = None
    """Thermal conductivity, of both bodies unless counter_conductivity is given."""
    counter_conductivity: _Conductivity | None = None
    """Thermal conductivity of the other body."""
    resistivity: _Resistivity | None = None
    """Electrical resistivity, of both bodies unless counter_resistivity is given."""
    counter_resistivity: _Resistivity | None = None
    """Electrical resistivity of the other body."""

    @model_validator(mode="after")
    def _of_both_bodies(self) -> "Conduction":
        for key in _NEEDED.values():
            other = getattr(self, f"counter_{key}")
            if other is not None and getattr(self, key) is None:
                raise EntryError(f"counter_{key}", other, f"goes with {key} only, that of the other body")
        if not self.factors:
            raise mismatch("conduction", "needs conductivity, resistivity, or both")
        for name, factor in self.factors.items():
            if not 0.0 < factor < math.inf:
                raise EntryError(_NEEDED[name], getattr(self, _NEEDED[name]), "is beyond the range of floats")
        return self

    @property
    def factors(self) -> dict[str, float]:
        """Each conductance over the conductance radius, where it is known: 2 k [W/(m K)] and 4/(rho1 + rho2) [S/m].

        k is the harmonic mean of both conductivities: the resistance of one contact of radius a is 1/(4 k1 a) +
        1/(4 k2 a), or (rho1 + rho2)/(4 a) (R. Holm, Electric Contacts, 1967).
        """
        found = {}
        if self.conductivity is not None:
            counter = self.conductivity if self.counter_conductivity is None else self.counter_conductivity
            less, more = sorted((self.conductivity, counter))
            found["thermal_conductance"] = 4.0 * less / (1.0 + less / more)
        if self.resistivity is not None:
            counter = self.resistivity if self.counter_resistivity is None else self.counter_resistivity
            found["electrical_conductance"] = 4.0 / (self.resistivity + counter)
        return found

    @classmethod
    def check_without(cls, scene: Given) -> None:
        _check_asked(scene, {})

    def check(self, scene: Given) -> None:
        """Raise a mismatch where a conductance is asked for without the conductivities that it needs."""
        _check_asked(scene, self.factors)

    def inner_variables(self, names: list[str]) -> list[str]:
        return of_contacts(names)

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return the law with all conductances; OutOfRange where one is not representable."""

        def law(path: "Path", names: list[str]) -> "LoadSeparation":
            found = contacts.law(path, self.inner_variables(names))
            if RADIUS not in found.variables:
                return found
            return found._replace(variables=found.variables | self.conductances(found.variables[RADIUS]))

        return law

    def conductances(self, radius: "Floats") -> "dict[str, Floats]":
        """Return each conductance of contacts with a conductance radius [m]; OutOfRange if one is not representable."""
        conducting = radius[np.isfinite(radius) & (radius > 0.0)]
        with np.errstate(over="ignore"):  # refused below
            found = {name: factor * radius for name, factor in self.factors.items()}
        for name, factor in self.factors.items():
            largest = factor * float(conducting.max(initial=0.0))
            if not largest < math.inf or (conducting.size and largest == 0.0):
                given = f"{factor:g} {CONDUCTANCES[name].units} m-1 of conductivity"
                raise OutOfRange(f"{name} is not representable: {given}")
        return found

    @classmethod
    def cites(cls, table: Mapping[str, Any], variables: list[str]) -> Mapping[str, str]:
        return {} if {RADIUS, *CONDUCTANCES}.isdisjoint(variables) else cls.papers


def of_contacts(variables: Iterable[str]) -> list[str]:
    """Return the variables with the conductance radius in place of conductances."""
    return list(dict.fromkeys(RADIUS if name in CONDUCTANCES else name for name in variables))


def _check_asked(scene: Given, factors: Mapping[str, float]) -> None:
    for name in scene.output.variables:
        if name in CONDUCTANCES and name not in factors:
            raise mismatch("output.variables", f"{name} needs conduction.{_NEEDED[name]}")
