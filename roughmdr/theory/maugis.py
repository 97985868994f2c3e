"""Maugis: equal summits with adhesion of DMT."""

from __future__ import annotations

import math
from typing import Unpack

from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number
from roughmdr.theory.equal_summits import SummitMaterial, Summits, Variable


def dmt_maugis(
    *,
    separation: ArrayLike,
    radius: float | str,
    density: float | str,
    work: float | str,
    variable: Variable = "pressure",
    **material: Unpack[SummitMaterial],
) -> Floats:
    """Compute pressure, area or number of contacts of equal paraboloids with adhesion of DMT.

    Every summit with z >= h is in contact, on the area of Hertz, and carries the force of Hertz less 2 pi w R. It holds
    for small, hard summits (Tabor number well below 1). Included is the attraction around each contact. Not included
    are the attraction of summits that do not touch, the area that adhesion adds to a contact, and hysteresis: loading
    and unloading follow one curve, and a contact goes from -2 pi w R to 0 at h = z.

    Parameters
    ----------
    separation, radius, density, variable, **material
        As ``greenwood_williamson``.
    work : float or str
        Work of adhesion w [J/m^2], above 0.

    Returns
    -------
    numpy.ndarray
        The variable, in the shape of separation; area and number are those of ``greenwood_williamson``.

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``greenwood_williamson``.

    References
    ----------
    .. [1] D. Maugis, J. Adhesion Sci. Technol. 10 (1996) 161.

    Examples
    --------
    >>> import roughmdr as rm
    >>> summits = {"radius": "1 um", "density": 2e12, "std": "10 nm", "work": "50 mJ/m^2"}
    >>> p = rm.theory.dmt_maugis(separation="10 nm", modulus="70 GPa", poisson=0.2, **summits)
    >>> f"{float(p):.4g}"
    '1.461e+07'
    """
    summits = Summits.of(dmt_maugis, radius, density, material)
    attraction = 2.0 * math.pi * check_number("work", work, "J/m^2") * check_number("radius", radius, "m")
    return summits._replace(attraction=attraction).over(variable, separation)
