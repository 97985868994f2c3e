"""Contact fractions beyond which the sum of contacts is no contact area, and the likely cause of one above 1."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.errors import TooMuchContact
from roughmdr.model_error.interaction import interaction_error
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import format_quantity

LARGE_FRACTION = 0.05
"""Contact fraction above which there is a warning: the error of the force is typically 19 %, at most some 36 %."""
OVERLAPPED_FRACTION = 0.3
"""Contact fraction above which most contacts overlap, so that the sum of their areas is no contact area any more."""

_CROWDED = 0.36
"""Error of the force by the distances of asperities above which there is a warning: that of evenly spread ones at
``LARGE_FRACTION``."""

_SOFT = 1e3  # Pa: softer than gels, so that a prefix of the unit may be missing
_STICKY = 5.0  # J/m^2: stronger than clean metals
_SIDES = 0.1  # contact radius, over the side of the patch, above which one contact is not one of many


class Givens(NamedTuple):
    """Numbers of a scene, in SI, among which the cause of too large a contact fraction is sought."""

    effective_modulus: float
    work: float
    height_std: float
    nominal_area: float
    """Nominal area [m2]; NaN where it is not known."""
    contact_radius: float
    """The largest contact radius [m]."""


def check_contact_fraction(fraction: Floats, separation: Floats, givens: Givens) -> None:
    """Raise TooMuchContact, with the likely cause, where the contact area is larger than the nominal area."""
    if not (fraction > 1.0).any():
        return
    step = int(np.nanargmax(fraction))
    h = float(separation[step])
    raise TooMuchContact(
        f"the summed contact area is {fraction[step]:.3g} times the nominal area at a separation of "
        f"{format_quantity(h, 'm')}; it must be below 1, and for independent asperities below some "
        f"{LARGE_FRACTION:g}: {likely_cause(h, givens)}"
    )


def likely_cause(separation: float, givens: Givens) -> str:
    """Return the likely mistake in a scene whose contacts are impossible at a separation [m]."""
    modulus, work = format_quantity(givens.effective_modulus, "Pa"), format_quantity(givens.work, "J/m^2")
    causes = []
    if givens.work > 0.0 and givens.effective_modulus < _SOFT:
        causes.append(f"the effective modulus is {modulus}: is kPa, MPa or GPa meant?")
    if givens.work > _STICKY:
        causes.append(f"the work of adhesion is {work}: is mJ/m^2 meant?")
    if not causes and givens.contact_radius > _SIDES * math.sqrt(givens.nominal_area):
        causes.append(
            f"contacts have radii of up to {format_quantity(givens.contact_radius, 'm')}, which is much for the patch: "
            "are the units of the lengths right?"
        )
    if separation < -givens.height_std < 0.0:
        causes.append(f"the flat goes down to {separation / givens.height_std:.3g} sigma: end the path higher")
    fallback = "there are too many asperities on the patch, or too large or too sticky ones, or the path ends too low"
    return " ".join(causes) or fallback


def fraction_warnings(largest: float) -> list[str]:
    """Return the warning of the largest contact fraction of a path; none where it is small or not known (NaN)."""
    if not largest > LARGE_FRACTION:
        return []
    why = "asperities are taken to be independent, which they are not there"
    if largest > OVERLAPPED_FRACTION:
        why = "contacts overlap, so that the sum is no contact area any more, and the force is far off"
    area = f"a summed contact area of up to {largest:.2g} of the nominal area"
    return [f"{area}: {why} (warned of above {LARGE_FRACTION:g})"]


def crowd_warnings(error: Floats | None, contact_fraction: Floats) -> list[str]:
    """Return the warning of independent asperities that are near to each other; none where that changes little.

    ``error`` [1] is that by their distances at each step, None where it is not known. The text is the same for all
    realisations.
    """
    if error is None or not (error > np.maximum(interaction_error(contact_fraction), _CROWDED)).any():
        return []
    return [
        "independent asperities are so near to each other that the force is too high, by more than "
        f"{_CROWDED:g} of the true one, and contacts that overlap count more than once (interaction_error and "
        'overlap_fraction tell): [interaction] model = "pairwise" counts it, for sampled realisations'
    ]
