"""Fuller and Tabor: equal summits with adhesion of JKR."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number, check_scalar, check_values
from roughmdr.theory.equal_summits import SummitMaterial, Summits, Variable


def fuller_tabor(
    *,
    separation: ArrayLike,
    radius: float | str,
    density: float | str,
    work: float | str,
    turning: float | str | None = None,
    variable: Variable = "pressure",
    **material: Unpack[SummitMaterial],
) -> Floats:
    """Compute pressure, area or number of contacts of equal paraboloids with adhesion of JKR.

    On loading the summits with z >= h are in contact. On unloading from the closest separation ``turning`` those are
    that were reached and have not detached, z >= max(turning, h + delta_c). Each carries the JKR force.

    Parameters
    ----------
    separation, radius, density, variable, **material
        As ``greenwood_williamson``.
    work : float or str
        Work of adhesion [J/m^2], above 0.
    turning : float or str, optional
        Closest separation [m], from which the flat is unloaded; on loading unless given.

    Returns
    -------
    numpy.ndarray
        The variable, in the shape of separation.

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``greenwood_williamson``; OutOfRange also where a separation lies below ``turning``.

    References
    ----------
    .. [1] K. N. G. Fuller, D. Tabor, Proc. R. Soc. A 345 (1975) 327.

    Examples
    --------
    >>> import roughmdr as rm
    >>> summits = {"radius": "50 um", "density": 2e9, "std": "1 um", "work": "50 mJ/m^2"}
    >>> p = rm.theory.fuller_tabor(separation="3 um", turning="0 um", effective_modulus="4 MPa", **summits)
    >>> f"{float(p):.4g}"
    '-56.17'
    """
    summits = Summits.of(fuller_tabor, radius, density, material, check_number("work", work, "J/m^2"))
    if turning is None:
        return summits.over(variable, separation)
    lowest = check_scalar("turning", turning, "m")
    closest = float(np.min(check_values("separation", separation, "m"), initial=np.inf))
    if closest < lowest:
        raise OutOfRange(f"separation goes down to {closest:g} m; it must not lie below turning, {lowest:g} m")
    return summits.over(variable, separation, lambda h: np.maximum(lowest, h + summits.onset))
