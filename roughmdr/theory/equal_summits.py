"""What equal paraboloids of given heights carry together."""

import math
from collections.abc import Callable
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.numerics.quadrature import Rows
from roughmdr.theory.heights import Heights

Variable = Literal["pressure", "contact_fraction", "contact_density"]
"""Force over nominal area [Pa], real over nominal area of contact [1], contacts per nominal area [1/m2]."""


def check_variable(variable: Variable) -> Variable:
    """``variable``; RoughmdrError where it is unknown."""
    if variable not in get_args(Variable):
        raise RoughmdrError(f"variable is {variable!r}; it must be one of {', '.join(map(repr, get_args(Variable)))}")
    return variable


def representable(variable: str, values: Floats, given: Floats) -> Floats:
    """``values`` in the shape of the separations or pressures ``given``; OutOfRange where a float cannot hold them."""
    if not np.isfinite(values).all():
        raise OutOfRange(f"the {variable} for values from {np.min(given):g} on is not representable")
    return values.reshape(given.shape)


class Summits(NamedTuple):
    """Equal summits: the contact of one, the density of their heights, and how many there are [1/m2]."""

    contact: Contact
    heights: Heights
    density: float
    attraction: float = 0.0
    """What every contact carries less [N]."""

    @property
    def onset(self) -> float:
        """The indentation [m] at which a contact lets go."""
        return -self.contact.depth[0] if self.contact.law.adhesive else 0.0

    def over(self, variable: Variable, separation: ArrayLike, first: Callable[[Floats], Floats]) -> Floats:
        """``variable`` at each separation h, of the summits with z >= first(h)."""
        laws: dict[str, Callable[[Floats], Floats]] = {
            "pressure": self._force,
            "contact_fraction": self._area,
            "contact_density": np.ones_like,
        }
        carried = laws[check_variable(variable)]
        density = check_number("density", self.density, "1/m2")
        given = check_values("separation", separation)
        start = np.maximum(first(given.ravel()), self.heights.edges[0])
        # Exactly 0 for summits that are just letting go.
        ahead = start - (given.ravel() + self.onset)

        def each(rows: Rows, beyond: Floats) -> Floats:
            return carried(ahead[rows, None] + beyond)

        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            values = density * self.heights.mean(start, each)
        return representable(variable, values, given)

    def _state(self, distance: Floats) -> Floats:
        """The state at a ``distance`` [m] of the indentation from the onset."""
        contact = self.contact
        return apply(contact.law.state, np.maximum(distance.ravel() / contact.depth[0], 0.0), contact.params)

    def _force(self, distance: Floats) -> Floats:
        contact = self.contact
        force = contact.force * apply(contact.law.force, self._state(distance), contact.params)
        return np.asarray(force.reshape(distance.shape) - self.attraction)

    def _area(self, distance: Floats) -> Floats:
        contact = self.contact
        radius = contact.radius * apply(contact.law.radius, self._state(distance), contact.params)
        return np.asarray(math.pi * radius.reshape(distance.shape) ** 2)
