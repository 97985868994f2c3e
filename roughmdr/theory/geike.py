"""Geike and Popov: a rough surface as one rough line on springs."""

import math
from operator import index
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats, check_number, check_values
from roughmdr.numerics.gauss import gauss
from roughmdr.spectrum import Spectrum, spectral_density, wave_number_range
from roughmdr.theory.equal_summits import representable


class RoughLine(NamedTuple):
    """What the line answers at each separation."""

    force: Floats
    """[N]."""
    stiffness: Floats
    """How fast the force grows on approach [N/m]."""


def rough_line(
    *, separation: ArrayLike, effective_modulus: float, spectrum: Spectrum, length: float, points: int, seed: int
) -> RoughLine:
    """Force [N] and stiffness [N/m] of a rough line on springs, under a rigid flat at separations [m] from its mean.

    T. Geike, V. L. Popov, Phys. Rev. E 76 (2007) 036710: the surface with the spectrum C(q) becomes a line of
    ``line_heights``, each of its points on a spring of stiffness E* dx. F = E* dx sum of (z - h) over all z > h, and
    k = E* dx times their number. No spring knows of its neighbours.

    What it gives is how stiffness grows with force: as F^(1/(1 + H)) while the longest of self-affine waves is as long
    as the line, the power law that boundary elements find (exponents 0.51 to 0.77: R. Pohrt, V. L. Popov, Phys. Rev.
    Lett. 108 (2012) 104301) in surfaces of that size, and only there (L. Pastewka and others, Phys. Rev. E 87 (2013)
    062809).
    Its separation and its area of contact are NOT those of the surface: at a given gap it carries about a fifth of the
    force that boundary elements find, and the length that touches is no area (I. A. Lyashenko, L. Pastewka, B. N. J.
    Persson, Tribol. Lett. 52 (2013) 223).

    effective_modulus E* [Pa]; the others and the errors as for ``line_heights``. The shapes are that of separation, a
    number or one-dimensional. OutOfRange where an argument is.
    """
    z = line_heights(spectrum=spectrum, length=length, points=points, seed=seed)
    spring = check_number("effective_modulus", effective_modulus, "Pa") * (length / len(z))
    given = check_values("separation", separation)
    # Depths below the highest point: their sums do not cancel at the first touches.
    top = float(z.max())
    depth = np.sort(top - z)
    below = np.append(0.0, np.cumsum(depth))
    flat = top - given.ravel()
    count = np.searchsorted(depth, flat)
    with np.errstate(over="ignore", invalid="ignore"):  # refused by ``representable``
        force = np.asarray(spring * np.maximum(count * flat - below[count], 0.0))
        stiffness = np.asarray(spring * count, dtype=np.float64)
        return RoughLine(representable("force", force, given), representable("stiffness", stiffness, given))


def line_heights(*, spectrum: Spectrum, length: float, points: int, seed: int) -> Floats:
    """Heights [m] of a periodic line of ``length`` [m] with random phases, at evenly spaced points.

    Its spectrum is C1(q) = pi q C(q), with <h^2> = 2 ∫ C1 dq the same as that of the surface (Geike and Popov, as
    above): every line has it, whatever its phases. Its <(dh/dx)^2> is <|grad h|^2>, twice that of a profile. Each wave
    of the line stands for the waves nearest to it.
    spectrum C(q) [m4] between ``long_wave`` and ``short_wave``. OutOfRange where the length is below the longest wave,
    or the points are not more than two in the shortest; where seed is not a whole number of at least 0.
    """
    q0, q1 = wave_number_range(spectrum)
    length = check_number("length", length, "m")
    points, seed = _whole("points", points), _whole("seed", seed)
    step = 2.0 * math.pi / length
    if length < spectrum.long_wave:
        raise OutOfRange(f"length is {length:g} m; it must be at least the longest wave, {spectrum.long_wave:g} m")
    if not points > (fewest := 2.0 * q1 / step + 1.0):
        raise OutOfRange(f"points is {points}; it must be above {fewest:g}, two in the shortest wave")
    waves = np.arange(1, math.floor(q1 / step + 0.5) + 1)
    nodes, weights = gauss(16)
    low, high = np.maximum(q0, (waves - 0.5) * step), np.minimum(q1, (waves + 0.5) * step)
    half = 0.5 * np.maximum(high - low, 0.0)[:, None]
    q = np.clip(low[:, None] + half * (1.0 + nodes), q0, q1)
    share = half[:, 0] * ((math.pi * q * spectral_density(spectrum, q)) @ weights)
    phase = 2.0 * math.pi * 2.0**-64 * np.random.Philox(np.random.SeedSequence(seed)).random_raw(len(waves))
    coefficients = np.zeros(points // 2 + 1, dtype=np.complex128)
    coefficients[1 : len(waves) + 1] = np.sqrt(share) * points * np.exp(1j * phase)
    return np.asarray(np.fft.irfft(coefficients, points))


def _whole(name: str, value: int) -> int:
    try:
        number = index(value)
    except TypeError:
        raise OutOfRange(f"{name} is {value!r}; it must be a whole number of at least 0") from None
    if number < 0:
        raise OutOfRange(f"{name} is {number}; it must be a whole number of at least 0")
    return number
