"""Persson's theory of randomly rough surfaces: real contact area, mean gap, and the pressure at a mean gap."""

from __future__ import annotations

import math
from functools import cache
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import PiecewiseChebyshev
from roughmdr.numerics.quadrature import panel_rule, refine_edges, running_integral
from roughmdr.schema.arguments import check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.schema.quantities import Quantity
from roughmdr.spectrum import MapSpectrum, SelfAffine, Spectrum, spectral_density, wave_number_range
from roughmdr.theory.bush import check_load
from roughmdr.theory.equal_summits import representable

# Fourfold shorter intervals of log(q/q0) down to q0, where few waves are in play and the load flattens them all.
_INTERVALS_TO_LONGEST = 45
_GAMMA = Quantity("1", at_least=0.0, at_most=1.0)
_EXP_ZERO = 30.0  # x beyond which exp(-x^2) is 0
# Logarithms of the pressure over E* h' between which the root lies: floats hold the squares of both well enough.
_LOG_MIN, _LOG_MAX = -350.0, math.log(25.0)


@named_keywords
def persson_contact_fraction(*, pressure: ArrayLike, rms_slope: float, **material: Unpack[MaterialArguments]) -> Floats:
    """Compute the real over nominal area of contact without adhesion: erf(sqrt(2) p/(E* h')).

    The pressure is 0 at the edges of contacts.

    Parameters
    ----------
    pressure : array_like, shape () or (n,)
        Force over nominal area p [Pa], at least 0.
    rms_slope, **material
        h' = ``sqrt(<|grad h|^2>)`` [1] over all waves, above 0; E* as in ``greenwood_williamson``.

    Returns
    -------
    numpy.ndarray
        The area fraction [1], in the shape of pressure.

    Raises
    ------
    OutOfRange, RoughmdrError
        Where an argument is out of its range; RoughmdrError unless E* is given in exactly one way.

    References
    ----------
    .. [1] B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840.

    Examples
    --------
    >>> import roughmdr as rm
    >>> area = rm.theory.persson_contact_fraction(pressure="10 MPa", rms_slope=0.1, effective_modulus="1 GPa")
    >>> round(float(area), 5)
    0.15852
    """
    from scipy.special import erf

    load = check_load(pressure, effective_modulus_of(persson_contact_fraction, material), rms_slope)
    return np.asarray(erf(math.sqrt(2.0) * load))


@named_keywords
def persson_separation(
    *, pressure: ArrayLike, spectrum: Spectrum | MapSpectrum, gamma: float = 0.45, **material: Unpack[MaterialArguments]
) -> Floats:
    """Compute the mean gap between a rigid rough surface and an elastic half-space without adhesion.

    u(p) = sqrt(pi) ∫ dq q^2 C(q) w(q) ∫_p^∞ dp'/p' [gamma + 3 (1 - gamma) P^2] exp(-(w p'/E*)^2) over all waves, with
    w(q) = (pi ∫_q0^q q'^3 C dq')^(-1/2) and P = erf(w p'/E*). It follows from p = -dU/du and the elastic energy
    U = pi/2 E* ∫ dq q^2 C P [gamma + (1 - gamma) P^2] of a unit area. At small pressures u falls by log(p) times
    gamma sqrt(pi) ∫ dq q^2 C w; at full contact it is 0.

    Parameters
    ----------
    pressure : array_like, shape () or (n,)
        Force over nominal area p [Pa], above 0: without pressure there is no finite gap.
    spectrum : Spectrum
        C(q) [m4], with kinks at most between its ends ``long_wave`` and ``short_wave`` [m], such as ``SelfAffine``.
    gamma, **material
        gamma from 0 to 1; 0.4 to 0.5 in the literature [1]_, 1 in [2]_. E* as in ``greenwood_williamson``.

    Returns
    -------
    numpy.ndarray
        The mean gap [m], in the shape of pressure, right to about 1e-12 of itself.

    Raises
    ------
    OutOfRange, RoughmdrError
        Where an argument is out of its range; RoughmdrError where spectrum is none, or E* not given in exactly one way.

    References
    ----------
    .. [1] C. Yang, B. N. J. Persson, J. Phys. Condens. Matter 20 (2008) 215214.
    .. [2] B. N. J. Persson, Phys. Rev. Lett. 99 (2007) 125502.

    Examples
    --------
    >>> import roughmdr as rm
    >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="100 um", short_wave="5 um", rms_slope=0.1)
    >>> gap = rm.theory.persson_separation(pressure="10 MPa", spectrum=surface, effective_modulus="100 GPa")
    >>> f"{float(gap):.4g}"
    '1.462e-06'
    """
    modulus = effective_modulus_of(persson_separation, material)
    given = check_values("pressure", pressure, "Pa")
    if (given <= 0.0).any():
        raise OutOfRange(f"pressure is {np.min(given):g} Pa; it must be above 0")
    gamma = _GAMMA.argument("gamma", gamma)
    with np.errstate(all="ignore"):  # refused below
        q, squared_slope, change = _slopes(spectrum)
        x = given.reshape(-1, 1) / modulus / np.sqrt(squared_slope)
        gaps = _over_pressure(x, gamma) @ (change / q / np.sqrt(math.pi * squared_slope))
    return representable("mean gap", gaps, given)


@named_keywords
def persson_pressure(
    *,
    separation: ArrayLike,
    spectrum: SelfAffine | MapSpectrum,
    gamma: float = 0.45,
    **material: Unpack[MaterialArguments],
) -> Floats:
    """Compute the pressure that leaves a mean gap: the inverse of ``persson_separation``.

    Parameters
    ----------
    separation : array_like, shape () or (n,)
        Mean gaps [m], above 0.
    spectrum, gamma, **material
        As in ``persson_separation``; the spectrum must be a ``SelfAffine``, or that of a height map.

    Returns
    -------
    numpy.ndarray
        Force over nominal area [Pa], in the shape of separation, right to about 1e-12 of itself.

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``persson_separation``; OutOfRange also where a float cannot hold the pressure over the modulus.

    References
    ----------
    .. [1] C. Yang, B. N. J. Persson, J. Phys. Condens. Matter 20 (2008) 215214.

    Examples
    --------
    >>> import roughmdr as rm
    >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="100 um", short_wave="5 um", rms_slope=0.1)
    >>> p = rm.theory.persson_pressure(separation="1 um", spectrum=surface, effective_modulus="100 GPa")
    >>> f"{float(p):.4g}"
    '6.631e+07'
    """
    from scipy.optimize.elementwise import find_root

    modulus = effective_modulus_of(persson_pressure, material)
    given = check_values("separation", separation, "m")
    if not isinstance(spectrum, SelfAffine | MapSpectrum):
        raise RoughmdrError(f"spectrum is {spectrum!r}; it must be a SelfAffine")
    unit = modulus * spectrum.rms_slope

    def gap(logarithm: Floats) -> Floats:
        pressure = unit * np.exp(logarithm)
        return persson_separation(pressure=pressure, spectrum=spectrum, gamma=gamma, effective_modulus=modulus)

    closest, furthest = gap(np.array([_LOG_MAX, _LOG_MIN]))
    if not ((given > closest) & (given < furthest)).all():
        extremes = f"from {np.min(given):g} to {np.max(given):g} m"
        raise OutOfRange(f"separation is {extremes}; it must be above {closest:g} and below {furthest:g} m")

    def excess(logarithm: Floats, h: Floats) -> Floats:
        return gap(logarithm) - h

    root = find_root(excess, (_LOG_MIN, _LOG_MAX), args=(given,))
    return np.asarray(unit * np.exp(root.x))


def _slopes(spectrum: Spectrum | MapSpectrum) -> tuple[Floats, Floats, Floats]:
    """Return wave numbers q, w(q)^-2 = pi ∫_q0^q q'^3 C dq' at each, and its change over the interval of each."""
    if isinstance(spectrum, MapSpectrum):
        change = 0.5 * spectrum.q * spectrum.q * spectrum.variance
        after = np.sqrt(np.cumsum(change))
        before = np.concatenate([[0.0], after[:-1]])
        return spectrum.q, 0.25 * (before + after) ** 2, change  # the mean of w over each change is exact
    q0, q1 = wave_number_range(spectrum)
    octaves = math.log(q1 / q0)
    near = min(octaves, 1.0)
    far = np.linspace(near, octaves, 1 + math.ceil(octaves - near))[1:]
    # In v = sqrt(log(q/q0)) all begins like a power series.
    edges = np.concatenate([[0.0], near**0.5 * 2.0 ** np.arange(-_INTERVALS_TO_LONGEST, 1.0), np.sqrt(far)])

    def wave_number(v: Floats) -> Floats:
        return np.clip(q0 * np.exp(v * v), q0 * (1.0 + 4e-16), q1 * (1.0 - 4e-16))

    def slope(v: Floats) -> Floats:
        q = wave_number(v)
        return np.asarray(2.0 * math.pi * v * q * q * (q * q * spectral_density(spectrum, q)))

    edges = refine_edges(slope, edges)
    v, weights = panel_rule(edges)
    change = slope(v)
    if not change.flat[0] > 0.0:
        raise OutOfRange("spectrum is 0 at its longest wave; it must be above 0")
    return wave_number(v).ravel(), running_integral(change, edges).ravel(), (change * weights).ravel()


def _over_pressure(x: Floats, gamma: float) -> Floats:
    """∫_x^∞ [gamma + 3 (1 - gamma) erf^2(t)] exp(-t^2)/t dt."""
    from scipy.special import exp1

    small = x < _EXP_ZERO
    square = x[small] ** 2
    values = np.zeros_like(x)
    values[small] = 0.5 * (gamma * exp1(square) + 3.0 * (1.0 - gamma) * np.exp(-square) * _square_term()(x[small]))
    return values


@cache
def _square_term() -> PiecewiseChebyshev:
    """2 exp(x^2) ∫_x^∞ erf^2(t) exp(-t^2)/t dt, with t^2 = x^2 + s."""
    from scipy.special import erf

    s, weights = (part.ravel() for part in panel_rule(np.array([0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 40.0])))

    def value(x: Floats) -> Floats:
        square = x[:, None] ** 2 + s
        return np.asarray((erf(np.sqrt(square)) ** 2 / square) @ (np.exp(-s) * weights))

    return PiecewiseChebyshev.of(value, np.array([0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]), 20)
