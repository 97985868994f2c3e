"""Persson's law the other way round: the pressure under which a mean gap is left."""

import math

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.spectrum import SelfAffine
from roughmdr.theory.persson_gap import persson_separation

# Logarithms of the pressure over E* h' between which the root lies: of the squares of both a float holds what it must.
_LEAST, _MOST = -350.0, math.log(25.0)


def persson_pressure(*, separation: ArrayLike, effective_modulus: float, spectrum: SelfAffine) -> Floats:
    """Pressure [Pa] at mean gaps separation [m], to about 1e-12 of itself: the inverse of ``persson_separation``.

    effective_modulus E* [Pa]. The shape is that of separation. OutOfRange where a separation is not above 0, or is one
    whose pressure over the modulus no float holds, and where another argument is.
    """
    from scipy.optimize.elementwise import find_root

    given = check_values("separation", separation)
    if not isinstance(spectrum, SelfAffine):
        raise RoughmdrError(f"spectrum is {spectrum!r}; it must be a SelfAffine")
    unit = check_number("effective_modulus", effective_modulus, "Pa") * spectrum.rms_slope

    def gap(logarithm: Floats) -> Floats:
        pressure = unit * np.exp(logarithm)
        return persson_separation(pressure=pressure, effective_modulus=effective_modulus, spectrum=spectrum)

    def too_wide(logarithm: Floats, h: Floats) -> Floats:
        return gap(logarithm) - h

    closest, furthest = gap(np.array([_MOST, _LEAST]))
    if not ((given > closest) & (given < furthest)).all():
        raise OutOfRange(
            f"separation is from {np.min(given):g} to {np.max(given):g} m; "
            f"it must be above {closest:g} and below {furthest:g} m"
        )
    found = find_root(too_wide, (_LEAST, _MOST), args=(given,))
    return np.asarray(unit * np.exp(found.x))
