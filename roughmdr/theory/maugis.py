"""Maugis: equal summits with adhesion of DMT."""

import math

from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats, check_number
from roughmdr.shapes import Paraboloid
from roughmdr.theory.equal_summits import Summits, Variable
from roughmdr.theory.heights import Distribution, Heights


def dmt_maugis(
    *,
    separation: ArrayLike,
    effective_modulus: float,
    radius: float,
    density: float,
    work: float,
    std: float | None = None,
    heights: Distribution | None = None,
    variable: Variable = "pressure",
) -> Floats:
    """Pressure [Pa] of equal DMT paraboloids at separations [m] from the mean summit plane, or area or number.

    D. Maugis, J. Adhesion Sci. Technol. 10 (1996) 161: every summit with z >= h is in contact, on the area of Hertz,
    and carries Hertz's force less 2 pi w R: p = 4/3 E* R^(1/2) eta F_3/2 - 2 pi w R eta F_0, with the integrals F_n of
    Greenwood and Williamson. It holds for small, hard summits (Tabor number well below 1).

    In it: the pull of the surfaces around each contact. Not in it: the pull of summits that are near but do not touch,
    the area and the stretch that adhesion adds to a contact, and hysteresis: in and out are one curve, and a contact
    goes from -2 pi w R to 0 at h = z. Area ("contact_fraction") and number ("contact_density") at a given separation
    are those of Greenwood and Williamson.
    work [J/m^2]; the others, the variables and the errors as for ``greenwood_williamson``.
    """
    contact = Contact.of(Paraboloid(radius), effective_modulus, Adhesion())
    pull = 2.0 * math.pi * check_number("work", work, "J/m^2") * radius
    return Summits(contact, Heights.of(std, heights), density, pull).over(variable, separation, lambda h: h)
