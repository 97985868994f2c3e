"""[accuracy] of: one quantity, where another one is given, and the error within which it is asked for."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import model_validator

from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.separation import Separation, SeparationReader, end_in_words
from roughmdr.schema.quantities import EntryError, Quantity, Reader
from roughmdr.schema.section import Section
from roughmdr.schema.units import DIMENSIONLESS, format_quantity
from roughmdr.variables import CONTROLS, SEPARATION, WITH_MODEL_ERROR

_AT = "at_"
_STEPS = 20  # steps of a path to a separation, between which slopes are found
_H = SEPARATION.name
_FORCES = {"force", "pressure"}
_READERS: dict[str, Reader] = {
    "at_force": Quantity("N", above=0.0),
    "at_pressure": Quantity("Pa", above=0.0),
    "at_separation": SeparationReader(),
}
"""Readers of the keys that give a quantity."""
_SAME = 1e-9
"""Difference of two equal places, over the extent of the path."""
_Relative = Annotated[float, Quantity(DIMENSIONLESS, above=0.0, at_most=1.0, example='"2 %"')] | None


class Asked(Section):
    """[accuracy] of: a quantity with its whole error, where a force, a pressure or a separation is given."""

    examples: ClassVar[Mapping[str, str]] = {"contact_area": '"2 %"', "at_pressure": '"10 MPa"'}

    contact_area: _Relative = None
    """Relative error of the contact area."""
    contact_fraction: _Relative = None
    """Relative error of the contact area over nominal area."""
    stiffness: _Relative = None
    """Relative error of the stiffness."""
    thermal_conductance: _Relative = None
    """Relative error of the thermal conductance."""
    electrical_conductance: _Relative = None
    """Relative error of the electrical conductance."""
    conductance_radius: _Relative = None
    """Relative error of the radius of one contact that conducts as well."""
    contact_radius_sum: _Relative = None
    """Relative error of the sum of the contact radii."""
    force: _Relative = None
    """Relative error of the force."""
    pressure: _Relative = None
    """Relative error of the force over nominal area."""
    separation: Annotated[float, Quantity("m", above=0.0, example='"5 nm"')] | None = None
    """Error of the separation."""
    at_force: Annotated[float, _READERS["at_force"]] | None = None
    """Load at which the quantity is asked for."""
    at_pressure: Annotated[float, _READERS["at_pressure"]] | None = None
    """Load over nominal area at which the quantity is asked for."""
    at_separation: Annotated[Separation, _READERS["at_separation"]] | None = None
    """Separation at which the quantity is asked for."""

    @model_validator(mode="after")
    def _one_of_each(self) -> "Asked":
        for names in (WITH_MODEL_ERROR, tuple(_READERS)):
            count = sum(getattr(self, name) is not None for name in names)
            if count != 1:
                raise RoughmdrError(f"takes one of {', '.join(names)}, not {count}")
        if self.quantity == self.given or {self.quantity, self.given} == _FORCES:
            raise EntryError(self.quantity, self.tolerance, f"has no error at a given {self.given}: it follows from it")
        return self

    @property
    def quantity(self) -> str:
        """The variable that is asked for."""
        return next(name for name in WITH_MODEL_ERROR if getattr(self, name) is not None)

    @property
    def tolerance(self) -> float:
        """Error that is asked for: relative [1], of a separation [m]."""
        return float(getattr(self, self.quantity))

    @property
    def absolute(self) -> bool:
        """Whether the error is in metres, since a separation has no natural zero."""
        return self.quantity == _H

    @property
    def given(self) -> str:
        """The quantity that is given: force, pressure or separation."""
        return next(key for key in _READERS if getattr(self, key) is not None).removeprefix(_AT)

    @property
    def in_sigma(self) -> bool:
        """Whether the separation that is given is in standard deviations of the heights."""
        return self.at_separation is not None and self.at_separation.in_sigma

    @property
    def in_words(self) -> str:
        """The quantity and where it is asked for."""
        where = end_in_words(getattr(self, f"{_AT}{self.given}"), CONTROLS[self.given])
        return f"{self.quantity.replace('_', ' ')} at a {self.given} of {where}"

    def error_in_words(self, error: float) -> str:
        """Return an error of the quantity with its unit."""
        if self.absolute:
            return format_quantity(error, "m")
        return f"{100.0 * error:.2g} %" if error < 0.1 else f"{100.0 * error:.0f} %"

    def step(self, values: Floats) -> int:
        """Return the step of a path, with these values of what is given, at which the surfaces are closest first."""
        return int(np.argmin(values) if self.given == _H else np.argmax(values))

    def reason_against(self, given: list[float], sigma: float) -> str:
        """Return why a path with these ends or steps [SI] does not lead to the place; empty where it does.

        ``sigma`` [m] is the standard deviation of the heights.
        """
        at = getattr(self, f"{_AT}{self.given}")
        sought = at.metres(sigma) if isinstance(at, Separation) else at
        closest = given[self.step(np.array(given))]
        scale = max(np.ptp(given), abs(sought)) * _SAME
        return (
            "" if abs(closest - sought) <= scale else f"must come closest at a {self.in_words.partition(' at a ')[2]}"
        )


def path_to(of: Mapping[str, Any]) -> dict[str, Any]:
    """Return the [path], as a scene has it, to what a table gives; some path where that is wrong."""
    for key, reader in _READERS.items():
        with suppress(RoughmdrError):
            if key in of and reader(of[key]) is not None:
                path = {"stop": of[key], "steps": _STEPS} if key == f"{_AT}{_H}" else [of[key]]
                return {key.removeprefix(_AT): path}
    return {_H: [0.0]}
