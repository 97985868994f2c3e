"""All summits of a Gaussian surface: Bush, Gibson and Thomas with elliptic contacts, Greenwood with circular ones."""

from __future__ import annotations

import math
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_number, check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.spectrum import Moments
from roughmdr.theory.equal_summits import Variable, representable
from roughmdr.theory.gaussian import mean_over_summits


@named_keywords
def bush_gibson_thomas(
    *,
    separation: ArrayLike,
    m0: float | str,
    m2: float,
    m4: float | str,
    variable: Variable = "pressure",
    **material: Unpack[MaterialArguments],
) -> Floats:
    """Compute pressure, area or number of contacts of the summits of an isotropic Gaussian surface.

    The joint density of the height and both principal curvatures of the summits, each an elliptic contact of Hertz, is
    integrated without approximation.

    Parameters
    ----------
    separation : array_like, shape () or (n,)
        Separations [m] from the MEAN PLANE of the surface, not from the mean plane of the summits, which lies
        4 sqrt(m0/(pi alpha)) above it.
    m0, m2, m4 : float
        Moments of the spectrum of a profile [m2], [1], [1/m2]: see ``roughmdr.spectrum.Moments``.
    variable, **material
        "pressure" [Pa], "contact_fraction" [1] or "contact_density" [1/m2], and E*, as in ``greenwood_williamson``.

    Returns
    -------
    numpy.ndarray
        The variable in the shape of separation, right to about 1e-12 of itself up to six standard deviations of height.

    Raises
    ------
    OutOfRange, RoughmdrError
        Where an argument is not above 0, or m0 m4/m2^2 not above 3/2; RoughmdrError as ``greenwood_williamson``.

    References
    ----------
    .. [1] A. W. Bush, R. D. Gibson, T. R. Thomas, Wear 35 (1975) 87.

    Examples
    --------
    >>> import roughmdr as rm
    >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="100 um", short_wave="5 um", rms_slope=0.1)
    >>> p = rm.theory.bush_gibson_thomas(separation="2 um", effective_modulus="100 GPa", **surface.moments._asdict())
    >>> f"{float(p):.4g}"
    '1.158e+05'
    """
    modulus = effective_modulus_of(bush_gibson_thomas, material)
    return mean_over_summits(True, separation, modulus, Moments.checked(m0, m2, m4), variable)


@named_keywords
def greenwood_elliptic(
    *,
    separation: ArrayLike,
    m0: float | str,
    m2: float,
    m4: float | str,
    variable: Variable = "pressure",
    **material: Unpack[MaterialArguments],
) -> Floats:
    """Compute pressure, area or number of contacts of a Gaussian surface, with circular contacts for elliptic ones.

    Each contact is a circular one of Hertz whose curvature is the geometric mean sqrt(k1 k2) of the principal
    curvatures of the summit. At a given separation it has up to 3 % less force and 2 % more area than
    ``bush_gibson_thomas``, at a given force up to 5 % more area.

    Parameters
    ----------
    separation, m0, m2, m4, variable, **material
        As ``bush_gibson_thomas``.

    Returns
    -------
    numpy.ndarray
        The variable, in the shape of separation.

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``bush_gibson_thomas``.

    References
    ----------
    .. [1] J. A. Greenwood, A simplified elliptic model of rough surface contact, Wear 261 (2006) 191.

    Examples
    --------
    >>> import roughmdr as rm
    >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="100 um", short_wave="5 um", rms_slope=0.1)
    >>> p = rm.theory.greenwood_elliptic(separation="2 um", effective_modulus="100 GPa", **surface.moments._asdict())
    >>> f"{float(p):.4g}"
    '1.136e+05'
    """
    modulus = effective_modulus_of(greenwood_elliptic, material)
    return mean_over_summits(False, separation, modulus, Moments.checked(m0, m2, m4), variable)


@named_keywords
def bush_gibson_thomas_asymptote(
    *, pressure: ArrayLike, rms_slope: float, **material: Unpack[MaterialArguments]
) -> Floats:
    """Compute the real over nominal area of contact at small pressures: sqrt(2 pi) p/(E* h').

    It is the limit of ``bush_gibson_thomas`` at large separations; nothing keeps it below 1.

    Parameters
    ----------
    pressure : array_like, shape () or (n,)
        Force over nominal area p [Pa], at least 0.
    rms_slope, **material
        h' = ``sqrt(<|grad h|^2>)`` = sqrt(2 m2) [1], above 0; E* as in ``greenwood_williamson``.

    Returns
    -------
    numpy.ndarray
        The area fraction [1], in the shape of pressure.

    Raises
    ------
    OutOfRange, RoughmdrError
        Where an argument is out of its range; unless E* is given in exactly one way.

    References
    ----------
    .. [1] A. W. Bush, R. D. Gibson, T. R. Thomas, Wear 35 (1975) 87.

    Examples
    --------
    >>> import roughmdr as rm
    >>> area = rm.theory.bush_gibson_thomas_asymptote(pressure="1 MPa", rms_slope=0.1, effective_modulus="1 GPa")
    >>> round(float(area), 5)
    0.02507
    """
    load = check_load(pressure, effective_modulus_of(bush_gibson_thomas_asymptote, material), rms_slope)
    return representable("contact fraction", math.sqrt(2.0 * math.pi) * load, check_values("pressure", pressure, "Pa"))


def check_load(pressure: ArrayLike, effective_modulus: float, rms_slope: float) -> Floats:
    """Return p/(E* h') of checked arguments."""
    pressures = check_values("pressure", pressure, "Pa")
    if (pressures < 0.0).any():
        raise OutOfRange(f"pressure is {np.min(pressures):g} Pa; it must be at least 0")
    with np.errstate(over="ignore"):  # a ratio beyond every float is full contact too
        return np.asarray(pressures / effective_modulus / check_number("rms_slope", rms_slope, "1"))
