"""[conduction]: how the bodies conduct heat and electricity."""

import math
from typing import Annotated

from pydantic import BeforeValidator, model_validator

from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import EntryError, Quantity, Section
from roughmdr.variables import CONDUCTANCES

_Conductivity = Annotated[float, BeforeValidator(Quantity("W/m/K", above=0.0))]
_Resistivity = Annotated[float, BeforeValidator(Quantity("ohm m", above=0.0))]
NEEDED = dict(zip(CONDUCTANCES, ("conductivity", "resistivity"), strict=True))


class ConductionSection(Section):
    """[conduction]: thermal conductivity, electrical resistivity, or both; the other body's where it has another.

    A rigid body conducts too.
    """

    conductivity: _Conductivity | None = None
    counter_conductivity: _Conductivity | None = None
    resistivity: _Resistivity | None = None
    counter_resistivity: _Resistivity | None = None

    @model_validator(mode="after")
    def _of_both_bodies(self) -> "ConductionSection":
        for key in NEEDED.values():
            other = getattr(self, f"counter_{key}")
            if other is not None and getattr(self, key) is None:
                raise EntryError(f"counter_{key}", other, f"goes with {key} only, that of the other body")
        if not self.factors:
            raise mismatch("conduction", "needs conductivity, resistivity, or both")
        for name, factor in self.factors.items():
            if not 0.0 < factor < math.inf:
                raise EntryError(NEEDED[name], getattr(self, NEEDED[name]), "is beyond the range of floats")
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
