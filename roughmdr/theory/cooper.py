"""Cooper, Mikic and Yovanovich: how well faces conduct heat whose contacts have all yielded."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number, check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.theory.equal_summits import representable


@named_keywords
def cooper_mikic_yovanovich(
    *,
    pressure: ArrayLike,
    hardness: float | str,
    rms_height: float | str,
    mean_slope: float,
    conductivity: float | str,
) -> Floats:
    """Compute the thermal conductance per area of a rough contact that has yielded: 1.25 k m/sigma (p/H)^0.95.

    The contacts are the plane sections of a Gaussian surface, on which the pressure is the hardness: so p/H is the area
    fraction, and each contact, which fills that share of its flux tube, conducts (1 - sqrt(p/H))^-1.5 times as well.
    The correlation is within 1.6 % of that model [1]_ for p/H from 1e-6 to 0.02.

    Parameters
    ----------
    pressure : array_like, shape () or (n,)
        Force over nominal area p [Pa], from 0 to the hardness.
    hardness : float or str
        Hardness H [Pa] of the softer face, at the size of its contacts.
    rms_height, mean_slope : float
        Of both faces together, sigma [m] and the mean m = ``<|dz/dx|>`` [1] of a profile: sqrt(2 m2/pi) of a Gaussian
        surface with the moments m0 = sigma^2 and m2, which is 1/sqrt(pi) of ``sqrt(<|grad h|^2>)``.
    conductivity : float or str
        Harmonic mean k = 2 k1 k2/(k1 + k2) of the conductivities [W/(m K)].

    Returns
    -------
    numpy.ndarray
        The conductance [W/(m2 K)] in the shape of pressure.

    Raises
    ------
    OutOfRange
        Where an argument is out of its range.

    References
    ----------
    .. [1] M. G. Cooper, B. B. Mikic, M. M. Yovanovich, Int. J. Heat Mass Transfer 12 (1969) 279.
    .. [2] M. M. Yovanovich, AIAA paper 81-1164 (1981): 1.25 and 0.95.

    Examples
    --------
    >>> import roughmdr as rm
    >>> faces = {"hardness": "1 GPa", "rms_height": "1 um", "mean_slope": 0.1, "conductivity": "160 W/m/K"}
    >>> h = rm.theory.cooper_mikic_yovanovich(pressure=["1 MPa", "10 MPa"], **faces)
    >>> [f"{value:.4g}" for value in h]
    ['2.825e+04', '2.518e+05']
    """
    given, limit = check_values("pressure", pressure, "Pa"), check_number("hardness", hardness, "Pa")
    if not ((given >= 0.0) & (given <= limit)).all():
        extremes = f"from {np.min(given):g} to {np.max(given):g} Pa"
        raise OutOfRange(f"pressure is {extremes}; it must be from 0 to the hardness, {limit:g} Pa")
    sigma, slope = check_number("rms_height", rms_height, "m"), check_number("mean_slope", mean_slope, "1")
    with np.errstate(over="ignore"):  # refused by ``representable``
        factor = np.float64(1.25 * check_number("conductivity", conductivity, "W/m/K")) * slope / sigma
        return representable("conductance", np.asarray(factor * (given / limit) ** 0.95), given)
