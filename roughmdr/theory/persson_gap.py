"""Persson's mean gap of randomly rough surfaces."""

import math
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.numerics.chebyshev import PiecewiseChebyshev
from roughmdr.numerics.quadrature import panel_rule, refine_edges, running_integral
from roughmdr.spectrum import Spectrum, spectral_density, wave_number_range
from roughmdr.theory.equal_summits import representable

# Fourfold shorter intervals of log(q/q0) down to q0, where few waves are in play and the load flattens them all.
_TOWARDS_LONGEST = 45
_VANISHED = 30.0  # exp(-x^2) is 0 beyond


def persson_separation(
    *, pressure: ArrayLike, effective_modulus: float, spectrum: Spectrum, gamma: float = 0.45
) -> Floats:
    """Mean gap [m] between a rigid rough surface and an elastic half-space at pressures [Pa], without adhesion.

    u(p) = sqrt(pi) ∫ dq q^2 C(q) w(q) ∫_p^∞ dp'/p' [gamma + 3 (1 - gamma) P^2] exp(-(w p'/E*)^2) over all waves, with
    w(q) = (pi ∫_q0^q q'^3 C dq')^(-1/2) and P = erf(w p'/E*): C. Yang, B. N. J. Persson, J. Phys. Condens. Matter 20
    (2008) 215214; with gamma = 1 B. N. J. Persson, Phys. Rev. Lett. 99 (2007) 125502. It follows from p = -dU/du and
    the elastic energy U = pi/2 E* ∫ dq q^2 C P [gamma + (1 - gamma) P^2] of a unit area.
    At small pressures u falls by log(p) times gamma sqrt(pi) ∫ dq q^2 C w; at full contact it is 0.

    effective_modulus E* [Pa]; spectrum C(q) [m4], with kinks at most between its ends ``long_wave`` and ``short_wave``
    [m]; gamma from 0 to 1, 0.4 to 0.5 in the literature. The shape is that of pressure, a number or one-dimensional.
    OutOfRange where an argument is not above 0 (without pressure there is no finite gap), RoughmdrError where spectrum
    is none. Accurate to about 1e-12 of itself.
    """
    given = check_values("pressure", pressure)
    if (given <= 0.0).any():
        raise OutOfRange(f"pressure is {np.min(given):g} Pa; it must be above 0")
    effective_modulus = check_number("effective_modulus", effective_modulus, "Pa")
    if not (gamma := check_number("gamma", gamma, "1", zero=True)) <= 1.0:
        raise OutOfRange(f"gamma is {gamma:g}; it must be from 0 to 1")
    with np.errstate(all="ignore"):  # refused below
        q, squared_slope, change = _slopes(spectrum)
        x = given.reshape(-1, 1) / effective_modulus / np.sqrt(squared_slope)
        gaps = _over_pressure(x, gamma) @ (change / q / np.sqrt(math.pi * squared_slope))
    return representable("mean gap", gaps, given)


def _slopes(spectrum: Spectrum) -> tuple[Floats, Floats, Floats]:
    """Wave numbers q, w(q)^-2 = pi ∫_q0^q q'^3 C dq', and how it changes over what each q stands for."""
    q0, q1 = wave_number_range(spectrum)
    octaves = math.log(q1 / q0)
    near = min(octaves, 1.0)
    far = np.linspace(near, octaves, 1 + math.ceil(octaves - near))[1:]
    # In v = sqrt(log(q/q0)) all begins like a power series.
    edges = np.concatenate([[0.0], near**0.5 * 2.0 ** np.arange(-_TOWARDS_LONGEST, 1.0), np.sqrt(far)])

    def wave_number(v: Floats) -> Floats:
        return np.clip(q0 * np.exp(v * v), q0 * (1.0 + 4e-16), q1 * (1.0 - 4e-16))

    def slope(v: Floats) -> Floats:
        q = wave_number(v)
        return np.asarray(2.0 * math.pi * v * q * q * (q * q * spectral_density(spectrum, q)))

    edges = refine_edges(slope, edges)
    v, share = panel_rule(edges)
    change = slope(v)
    if not change.flat[0] > 0.0:
        raise OutOfRange("spectrum is 0 at its longest wave; it must be above 0")
    return wave_number(v).ravel(), running_integral(change, edges).ravel(), (change * share).ravel()


def _over_pressure(x: Floats, gamma: float) -> Floats:
    """∫_x^∞ [gamma + 3 (1 - gamma) erf^2(t)] exp(-t^2)/t dt."""
    from scipy.special import exp1

    felt = x < _VANISHED
    square = x[felt] ** 2
    values = np.zeros_like(x)
    values[felt] = 0.5 * (gamma * exp1(square) + 3.0 * (1.0 - gamma) * np.exp(-square) * _second()(x[felt]))
    return values


@cache
def _second() -> PiecewiseChebyshev:
    """2 exp(x^2) ∫_x^∞ erf^2(t) exp(-t^2)/t dt, with t^2 = x^2 + s."""
    from scipy.special import erf

    s, share = (part.ravel() for part in panel_rule(np.array([0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 40.0])))

    def value(x: Floats) -> Floats:
        square = x[:, None] ** 2 + s
        return np.asarray((erf(np.sqrt(square)) ** 2 / square) @ (np.exp(-s) * share))

    return PiecewiseChebyshev.of(value, np.array([0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]), 20)
