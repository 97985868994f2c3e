"""Geike and Popov: a rough surface as one rough line on springs."""

from __future__ import annotations

import math
from operator import index
from typing import NamedTuple, Unpack

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss
from roughmdr.schema.arguments import check_number, check_values
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import MaterialArguments, effective_modulus_of
from roughmdr.spectrum import Spectrum, spectral_density, wave_number_range
from roughmdr.theory.equal_summits import representable


class RoughLine(NamedTuple):
    """Normal force [N] of a rough line and its growth on approach [N/m], in the shape of the separation."""

    force: Floats
    stiffness: Floats


@named_keywords
def rough_line(
    *,
    separation: ArrayLike,
    spectrum: Spectrum,
    length: float | str,
    points: int,
    seed: int,
    **material: Unpack[MaterialArguments],
) -> RoughLine:
    """Compute force and stiffness of a rough line on springs under a rigid flat.

    The surface with the spectrum C(q) becomes a line of ``line_heights``, each of its points on a spring of stiffness
    E* dx that does not feel its neighbours: F = E* dx sum of (z - h) over all z > h, and k = E* dx times their number.

    It gives how stiffness grows with force: as F^(1/(1 + H)) while the longest of self-affine waves is as long
    as the line, the power law that boundary elements find in surfaces of that size [2]_, and only there [3]_. Its
    separation and its contact area are NOT those of the surface: at a given gap it carries about a fifth of the force
    that boundary elements find, and the length in contact is no area [4]_.

    Parameters
    ----------
    separation : array_like, shape () or (n,)
        Separations h [m] of the flat from the mean of the line.
    spectrum, length, points, seed, **material
        As in ``line_heights``; E* as in ``greenwood_williamson``.

    Returns
    -------
    RoughLine
        force [N] and stiffness [N/m], in the shape of separation.

    Raises
    ------
    OutOfRange, RoughmdrError
        Where an argument is out of its range; RoughmdrError where spectrum is none, or E* not given in exactly one way.

    References
    ----------
    .. [1] T. Geike, V. L. Popov, Phys. Rev. E 76 (2007) 036710.
    .. [2] R. Pohrt, V. L. Popov, Phys. Rev. Lett. 108 (2012) 104301, exponents 0.51 to 0.77.
    .. [3] L. Pastewka and others, Phys. Rev. E 87 (2013) 062809.
    .. [4] I. A. Lyashenko, L. Pastewka, B. N. J. Persson, Tribol. Lett. 52 (2013) 223.

    Examples
    --------
    >>> import roughmdr as rm
    >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="1 mm", short_wave="10 um", rms_slope=0.1)
    >>> grid = {"spectrum": surface, "length": "1 mm", "points": 4096, "seed": 1}
    >>> line = rm.theory.rough_line(separation="2 um", effective_modulus="1 GPa", **grid)
    >>> f"{float(line.force):.4g} N, {float(line.stiffness):.4g} N/m"
    '0.7842 N, 2.524e+05 N/m'
    """
    z = line_heights(spectrum=spectrum, length=length, points=points, seed=seed)
    spring = effective_modulus_of(rough_line, material) * (check_number("length", length, "m") / len(z))
    given = check_values("separation", separation, "m")
    # Depths below the highest point, whose sums do not cancel near first touch.
    top = float(z.max())
    depth = np.sort(top - z)
    below = np.append(0.0, np.cumsum(depth))
    flat = top - given.ravel()
    count = np.searchsorted(depth, flat)
    with np.errstate(over="ignore", invalid="ignore"):  # refused by ``representable``
        force = np.asarray(spring * np.maximum(count * flat - below[count], 0.0))
        stiffness = np.asarray(spring * count, dtype=np.float64)
        return RoughLine(representable("force", force, given), representable("stiffness", stiffness, given))


@named_keywords
def line_heights(*, spectrum: Spectrum, length: float | str, points: int, seed: int) -> Floats:
    """Generate a periodic line of heights with random phases, at evenly spaced points.

    Its spectrum is C1(q) = pi q C(q), so that <h^2> = 2 ∫ C1 dq is that of the surface, whatever the phases. Its
    <(dh/dx)^2> is ``<|grad h|^2>``, twice that of a profile. Each wave of the line represents the waves nearest to it.

    Parameters
    ----------
    spectrum : Spectrum
        C(q) [m4] between ``long_wave`` and ``short_wave``, such as ``SelfAffine``.
    length : float or str
        Period of the line [m], at least the longest wave.
    points, seed : int
        Number of points, more than two in the shortest wave, and seed of the phases, at least 0.

    Returns
    -------
    numpy.ndarray, shape (points,)
        Heights [m].

    Raises
    ------
    OutOfRange, RoughmdrError
        As ``rough_line``.

    References
    ----------
    .. [1] T. Geike, V. L. Popov, Phys. Rev. E 76 (2007) 036710.

    Examples
    --------
    >>> import roughmdr as rm
    >>> surface = rm.spectrum.SelfAffine.of(hurst=0.8, long_wave="1 mm", short_wave="10 um", rms_height="2 um")
    >>> z = rm.theory.line_heights(spectrum=surface, length="1 mm", points=4096, seed=1)
    >>> f"{z.std():.3g} m"
    '2e-06 m'
    """
    q0, q1 = wave_number_range(spectrum)
    length = check_number("length", length, "m")
    points, seed = _check_whole("points", points), _check_whole("seed", seed)
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
    weight = half[:, 0] * ((math.pi * q * spectral_density(spectrum, q)) @ weights)
    phase = 2.0 * math.pi * 2.0**-64 * np.random.Philox(np.random.SeedSequence(seed)).random_raw(len(waves))
    coefficients = np.zeros(points // 2 + 1, dtype=np.complex128)
    coefficients[1 : len(waves) + 1] = np.sqrt(weight) * points * np.exp(1j * phase)
    return np.asarray(np.fft.irfft(coefficients, points))


def _check_whole(name: str, value: int) -> int:
    try:
        if (number := index(value)) >= 0:
            return number
    except TypeError:
        pass
    raise OutOfRange(f"{name} is {value!r}; it must be a whole number of at least 0")
