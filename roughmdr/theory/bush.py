"""All summits of a Gaussian surface: Bush, Gibson and Thomas with elliptic contacts, Greenwood with circular ones.

The joint density of the heights and curvatures of summits is that of P. R. Nayak, J. Lubr. Technol. 93 (1971) 398. With
a = m4/3, mean curvature (k1 + k2)/2 = sqrt(2 a) S and half the difference of the curvatures sqrt(2 a q), the density of
(S, q) over all summits is sqrt(6/pi) (S^2 - q) exp(-q - S^2/2), 0 < q < S^2. The height z = sqrt(m0) zeta is normal
given S, whatever q is: zeta and S correlate by rho = sqrt(3/(2 alpha)), and exp(-S^2/2) is that of a normal S.
k1 k2 = 2 a (S^2 - q).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import PiecewiseChebyshev
from roughmdr.numerics.quadrature import Rows, panel_rule
from roughmdr.schema.arguments import check_number, check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.spectrum import MIN_ALPHA, Moments
from roughmdr.theory.equal_summits import Variable, check_variable, representable
from roughmdr.theory.heights import NORMAL_EDGES, Heights

# n and p of delta^n (k1 k2)^(-p/2), to which force, area and number of a contact are proportional.
_POWERS: dict[Variable, tuple[float, float]] = {
    "pressure": (1.5, 0.5),
    "contact_fraction": (1.0, 1.0),
    "contact_density": (0.0, 0.0),
}
# b/a from contacts so narrow that they are negligible, since their fraction goes as (b/a)^3, to circular ones.
_RATIOS = np.concatenate([[0.0], 2.0 ** np.arange(-20, -1), 1.0 - 2.0 ** np.arange(-1, -7, -1), [1.0]])
_S_MAX = 64.0  # heights up to 39, and 9 deviations beyond


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
    return _mean_over_summits(True, separation, modulus, Moments.checked(m0, m2, m4), variable)


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
    return _mean_over_summits(False, separation, modulus, Moments.checked(m0, m2, m4), variable)


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


def _mean_over_summits(
    elliptic: bool, separation: ArrayLike, effective_modulus: float, moments: Moments, variable: Variable
) -> Floats:
    """Return ``variable`` at separations [m] from the mean plane, with elliptic contacts or with circular ones."""
    given = check_values("separation", separation, "m")
    power, _ = _POWERS[check_variable(variable)]
    deviation, curvature = math.sqrt(moments.m0), math.sqrt(2.0 / 3.0) * math.sqrt(moments.m4)
    unit = {
        "pressure": 4.0 / 3.0 * effective_modulus * deviation * math.sqrt(deviation / curvature),
        "contact_fraction": math.pi * deviation / curvature,
        "contact_density": 1.0,
    }[variable]
    heights = _weighted(elliptic, variable, moments.alpha)
    with np.errstate(over="ignore", invalid="ignore"):  # refused below
        h = given.ravel() / deviation
        above = np.maximum(heights.edges[0] - h, 0.0)

        def value(rows: Rows, beyond: Floats) -> Floats:
            return np.asarray((above[rows, None] + beyond) ** power)

        return representable(variable, moments.summit_density * unit * heights.mean(h, value), given)


def _weighted(elliptic: bool, variable: Variable, alpha: float) -> Heights:
    """Return the density of heights zeta of the summits, weighted with the factor of their curvatures in ``variable``.

    It is phi(zeta) Q(zeta) with Q = ∫ phi(x) G(rho zeta + c x) dx over S = rho zeta + c x > 0, c^2 = 1 - rho^2.
    """
    rho, c = math.sqrt(MIN_ALPHA / alpha), math.sqrt((alpha - MIN_ALPHA) / alpha)
    weight = _weight_of_curvature(elliptic, variable)
    nodes, panel_weights = (part.ravel() for part in panel_rule(np.linspace(0.0, 1.0, 7)))

    def smoothed(zeta: Floats) -> Floats:
        """Q, over the root of the distance to S = 0, where G goes as a half-integer power."""
        zeta = zeta[:, None]
        first = np.maximum(-rho * zeta / c, -9.0)
        root_length = np.sqrt(np.maximum(first, 0.0) + 10.0 - first)
        y = root_length * nodes
        x = first + y * y
        S = np.maximum(rho * zeta + c * x, 0.0)
        return np.asarray(np.sum(2.0 * root_length * panel_weights * y * np.exp(-0.5 * x * x) * weight(S), axis=1))

    # Q bends at heights of about c/rho, where S = 0 comes within its deviation.
    bends = c * 2.0 ** np.arange(-1, math.ceil(math.log2(NORMAL_EDGES[-1] / c)))
    edges = np.concatenate([NORMAL_EDGES[[0, -1]], [0.0], -bends[bends < -NORMAL_EDGES[0]], bends])
    Q = PiecewiseChebyshev.of(smoothed, np.unique(edges), 24)
    return Heights(lambda zeta: np.exp(-0.5 * zeta * zeta) / (2.0 * math.pi) * Q(zeta), NORMAL_EDGES)


def ellipses(ratio: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return Hertz's contacts of paraboloids with principal curvatures k1 >= k2 by the ratio b/a of their axes.

    These are the spread (k1 - k2)/(k1 + k2) and its derivative by b/a, and at a given delta (K. L. Johnson, Contact
    Mechanics, 1985, sec. 4.2) P/[4/3 E* (k1 k2)^(-1/4) delta^(3/2)] and A/[pi (k1 k2)^(-1/2) delta]. With
    e^2 = 1 - (b/a)^2, D = (K - E)/e^2 and B = K - D, which do not cancel for nearly circular contacts:
    k2/k1 = (b/a)^2 D/B, k2 a^2 = 2 delta D/K and P = 2 pi/3 E* delta a/K.
    """
    from scipy.special import ellipkm1, elliprd

    ratio2 = ratio * ratio
    K, D = ellipkm1(ratio2), elliprd(0.0, ratio2, 1.0) / 3.0
    B = K - D
    quotient = ratio2 * D / B
    # d log(D/B)/d log(b/a), from the derivatives of K and E.
    dD, dK = (D * ratio2 - B) / (1.0 - ratio2), -B
    quotient_slope = (2.0 + dD / D - (dK - dD) / B) * quotient / ratio
    spread, spread_slope = (1.0 - quotient) / (1.0 + quotient), -2.0 * quotient_slope / (1.0 + quotient) ** 2
    force = np.pi / 2.0 * np.sqrt(2.0) * (D * B / ratio2) ** 0.25 / K**1.5
    return spread, spread_slope, force, 2.0 * np.sqrt(D * B) / K


def _weight_of_curvature(elliptic: bool, variable: Variable) -> Callable[[Floats], Floats]:
    """Return G(S) = sqrt(12) ∫ (S^2 - q) exp(-q) (S^2 - q)^(-p/2) f dq over 0 < q < S^2, p and f those of ``variable``.

    sqrt(12) = sqrt(6/pi) sqrt(2 pi). With q = (r S)^2 the integral is over the spread r of the curvatures, which is a
    function of the ratio of the axes of the contact.
    """
    ratio, panel_weights = (part.ravel() for part in panel_rule(_RATIOS))
    r, slope, force, area = ellipses(ratio)
    dr = -panel_weights * slope
    _, p = _POWERS[variable]
    shape = {"pressure": force, "contact_fraction": area, "contact_density": np.ones_like(r)}
    factor = shape[variable] if elliptic else np.ones_like(r)
    weights = math.sqrt(12.0) * 2.0 * (1.0 - r * r) ** (1.0 - 0.5 * p) * factor * r * dr

    def over_power(S: Floats) -> Floats:
        return np.asarray(np.exp(-((S[:, None] * r) ** 2)) @ weights)

    table = PiecewiseChebyshev.of(over_power, np.append(0.0, 2.0 ** np.arange(0, math.log2(_S_MAX) + 0.5, 0.5)), 20)
    return lambda S: np.asarray(S ** (4.0 - p) * table(S))
