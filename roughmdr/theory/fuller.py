"""Fuller and Tabor: equal summits with adhesion of JKR."""

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.shapes import Paraboloid
from roughmdr.theory.equal_summits import Summits, Variable
from roughmdr.theory.heights import Distribution, Heights


def fuller_tabor(
    *,
    separation: ArrayLike,
    effective_modulus: float,
    radius: float,
    density: float,
    work: float,
    std: float | None = None,
    heights: Distribution | None = None,
    turning: float | None = None,
    variable: Variable = "pressure",
) -> Floats:
    """Pressure [Pa] of equal JKR paraboloids at separations [m] from the mean summit plane, or area or number.

    K. N. G. Fuller, D. Tabor, Proc. R. Soc. A 345 (1975) 327, with the JKR force of every contact. On the way in the
    summits with z >= h are in contact. On the way back from the closest separation ``turning`` [m] those are that were
    reached and have not let go, z >= max(turning, h + delta_c). work [J/m^2]; the others, the variables and the errors
    as for ``greenwood_williamson``. OutOfRange as well where a separation lies below ``turning``.
    """
    contact = Contact.of(Paraboloid(radius), effective_modulus, Adhesion(check_number("work", work, "J/m^2")))
    summits = Summits(contact, Heights.of(std, heights), density)
    if turning is None:
        return summits.over(variable, separation, lambda h: h)
    lowest = float(check_values("turning", turning))
    closest = float(np.min(check_values("separation", separation), initial=np.inf))
    if closest < lowest:
        raise OutOfRange(f"separation goes down to {closest:g} m; it must not lie below turning, {lowest:g} m")
    return summits.over(variable, separation, lambda h: np.maximum(lowest, h + summits.onset))
