"""Equal paraboloids of given heights under a flat: their force, area and number together."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.quadrature import Rows
from roughmdr.schema.arguments import check_number, check_values
from roughmdr.schema.material import Material, effective_modulus_of
from roughmdr.shapes import Paraboloid
from roughmdr.theory.heights import Distribution, Heights

Variable = Literal["pressure", "contact_fraction", "contact_density"]
"""Force over nominal area [Pa], real over nominal area of contact [1], contacts per nominal area [1/m2]."""


class SummitMaterial(Material, total=False):
    """The elastic constants, and the heights of the summits by one of two arguments."""

    std: float | str | None
    heights: Distribution | None


def check_variable(variable: Variable) -> Variable:
    """Return ``variable``; RoughmdrError where it is unknown."""
    if variable not in get_args(Variable):
        raise RoughmdrError(f"variable is {variable!r}; it must be one of {', '.join(map(repr, get_args(Variable)))}")
    return variable


def representable(variable: str, values: Floats, given: Floats) -> Floats:
    """Return ``values`` in the shape of the separations or pressures ``given``; OutOfRange where one is not finite."""
    if not np.isfinite(values).all():
        raise OutOfRange(f"the {variable} for values from {np.min(given):g} on is not representable")
    return values.reshape(given.shape)


class Summits(NamedTuple):
    """Equal summits: the contact of one, the density of their heights, and how many there are [1/m2]."""

    contact: Contact
    heights: Heights
    density: float
    attraction: float = 0.0
    """Force [N] that is taken from that of every contact."""

    @classmethod
    def of(
        cls,
        function: Callable[..., Any],
        radius: float | str,
        density: float | str,
        material: SummitMaterial,
        work: float = 0.0,
    ) -> Summits:
        """Read the arguments of a public ``function``; the work of adhesion [J/m^2] is that of JKR."""
        heights = Heights.of(function.__name__, material.pop("std", None), material.pop("heights", None))
        contact = Contact.of(
            Paraboloid(check_number("radius", radius, "m")), effective_modulus_of(function, material), Adhesion(work)
        )
        return cls(contact, heights, check_number("density", density, "m-2"))

    @property
    def onset(self) -> float:
        """The indentation [m] at which a contact detaches."""
        return -self.contact.depth[0] if self.contact.law.adhesive else 0.0

    def over(
        self, variable: Variable, separation: ArrayLike, lowest_in_contact: Callable[[Floats], Floats] | None = None
    ) -> Floats:
        """Return ``variable`` at each separation h [m], of the summits with z >= lowest_in_contact(h) or z >= h."""
        of_one: dict[str, Callable[[Floats], Floats]] = {
            "pressure": self._force,
            "contact_fraction": self._area,
            "contact_density": np.ones_like,
        }
        value = of_one[check_variable(variable)]
        given = check_values("separation", separation, "m")
        h = given.ravel()
        start = np.maximum(h if lowest_in_contact is None else lowest_in_contact(h), self.heights.edges[0])
        # Exactly 0 for summits that are about to detach.
        from_onset = start - (h + self.onset)

        def integrand(rows: Rows, beyond: Floats) -> Floats:
            return value(from_onset[rows, None] + beyond)

        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            values = self.density * self.heights.mean(start, integrand)
        return representable(variable, values, given)

    def _state(self, from_onset: Floats) -> Floats:
        """The state at each indentation less that of the onset [m]."""
        contact = self.contact
        return apply(contact.law.state, np.maximum(from_onset.ravel() / contact.depth[0], 0.0), contact.params)

    def _force(self, from_onset: Floats) -> Floats:
        contact = self.contact
        force = contact.force * apply(contact.law.force, self._state(from_onset), contact.params)
        return np.asarray(force.reshape(from_onset.shape) - self.attraction)

    def _area(self, from_onset: Floats) -> Floats:
        contact = self.contact
        radius = contact.radius * apply(contact.law.radius, self._state(from_onset), contact.params)
        return np.asarray(math.pi * radius.reshape(from_onset.shape) ** 2)
