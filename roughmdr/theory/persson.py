"""Persson's contact area of randomly rough surfaces."""

import math

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.theory.bush import check_load


def persson_contact_fraction(*, pressure: ArrayLike, effective_modulus: float, rms_slope: float) -> Floats:
    """Real over nominal area of contact [1] at pressures [Pa]: erf(sqrt(2) p/(E* h')).

    B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840, with the pressure 0 at the edges of contacts; without adhesion.
    effective_modulus E* [Pa], rms_slope h' = sqrt(<|grad h|^2>) [1] over all waves. The shape is that of pressure, a
    number or one-dimensional. OutOfRange where a pressure is below 0 or another argument not above 0.
    """
    from scipy.special import erf

    return np.asarray(erf(math.sqrt(2.0) * check_load(pressure, effective_modulus, rms_slope)))
