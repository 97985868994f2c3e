"""Bush, Gibson and Thomas: all summits of a Gaussian surface, with elliptic contacts."""

import math

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.spectrum import Moments
from roughmdr.theory.equal_summits import Variable, representable
from roughmdr.theory.gaussian import mean_over_summits


def bush_gibson_thomas(
    *, separation: ArrayLike, effective_modulus: float, m0: float, m2: float, m4: float, variable: Variable = "pressure"
) -> Floats:
    """Pressure [Pa] of the summits of an isotropic Gaussian surface at separations [m], or area or number of contacts.

    A. W. Bush, R. D. Gibson, T. R. Thomas, Wear 35 (1975) 87: the joint law of the height and both principal
    curvatures of the summits, each an elliptic contact of Hertz, integrated without approximation.
    The separation is from the MEAN PLANE of the surface, not from the mean plane of the summits, which lies
    4 sqrt(m0/(pi alpha)) above it. effective_modulus E* [Pa]; m0 [m2], m2 [1], m4 [1/m2] are the moments of a profile
    (``roughmdr.spectrum.Moments``). variable: "pressure" [Pa], "contact_fraction" (real over nominal area) [1] or
    "contact_density" [1/m2]. The shape is that of separation, a number or one-dimensional.
    OutOfRange where an argument is not above 0 or m0 m4/m2^2 not above 3/2. Accurate to about 1e-12 of itself to six
    standard deviations of the surface.
    """
    return mean_over_summits("elliptic", separation, effective_modulus, Moments.checked(m0, m2, m4), variable)


def bush_gibson_thomas_asymptote(*, pressure: ArrayLike, effective_modulus: float, rms_slope: float) -> Floats:
    """Real over nominal area of contact [1] at small pressures [Pa]: sqrt(2 pi) p/(E* h').

    What the law of A. W. Bush, R. D. Gibson, T. R. Thomas, Wear 35 (1975) 87, tends to at large separations.
    effective_modulus E* [Pa], rms_slope h' = sqrt(<|grad h|^2>) = sqrt(2 m2) [1]. The shape is that of pressure, a
    number or one-dimensional. OutOfRange where a pressure is below 0 or another argument not above 0. It is a limit:
    nothing keeps it below 1.
    """
    load = check_load(pressure, effective_modulus, rms_slope)
    return representable("contact fraction", math.sqrt(2.0 * math.pi) * load, np.asarray(pressure))


def check_load(pressure: ArrayLike, effective_modulus: float, rms_slope: float) -> Floats:
    """p/(E* h'), each checked."""
    pressures = check_values("pressure", pressure)
    if (pressures < 0.0).any():
        raise OutOfRange(f"pressure is {np.min(pressures):g} Pa; it must be at least 0")
    effective_modulus, rms_slope = (
        check_number("effective_modulus", effective_modulus, "Pa"),
        check_number("rms_slope", rms_slope, "1"),
    )
    with np.errstate(over="ignore"):  # beyond every float, full contact is as sure
        return np.asarray(pressures / effective_modulus / rms_slope)
