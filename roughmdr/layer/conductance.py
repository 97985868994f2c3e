"""The conductances of a rough layer, from the conductance radius of its contacts: proportional to conductivities."""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from roughmdr.aggregate import LoadSeparation
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import CONDUCTANCES

RADIUS = "conductance_radius"


def of_contacts(variables: Iterable[str]) -> list[str]:
    """Return the variables with the conductance radius in place of conductances."""
    return list(dict.fromkeys(RADIUS if name in CONDUCTANCES else name for name in variables))


def with_conductances(law: LoadSeparation, factors: Mapping[str, float]) -> LoadSeparation:
    """Return a law, if it has the conductance radius, with each conductance that ``factors`` [SI] has the factor of.

    OutOfRange where one is not representable.
    """
    if RADIUS not in law.variables:
        return law
    radius = law.variables[RADIUS]
    return law._replace(variables=law.variables | conductances(radius, factors))


def conductances(radius: Floats, factors: Mapping[str, float]) -> dict[str, Floats]:
    """Return each conductance of contacts with a conductance radius [m], by the factors [SI] of ``with_conductances``.

    OutOfRange where one is not representable.
    """
    conducting = radius[np.isfinite(radius) & (radius > 0.0)]
    with np.errstate(over="ignore"):  # refused below
        found = {name: factor * radius for name, factor in factors.items()}
    for name, factor in factors.items():
        largest = factor * float(conducting.max(initial=0.0))
        if not largest < math.inf or (conducting.size and largest == 0.0):
            raise OutOfRange(f"{name} is not representable: {factor:g} {CONDUCTANCES[name].units} m-1 of conductivity")
    return found
