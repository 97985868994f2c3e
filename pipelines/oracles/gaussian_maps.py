"""Periodic Gaussian height maps of a given spectrum, by the discrete Fourier transform."""

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine

_EDGE = 1e-9  # waves as long as a limit of the spectrum count as within it, whatever their rounding


def gaussian_map(spectrum: SelfAffine, points: int, size: float, seed: int) -> Floats:
    """Heights [m] on a periodic square grid of points x points over ``size`` [m], Gaussian, with this spectrum.

    Each wave of the grid has the amplitude that the spectrum gives it on average over maps; one map has more or less.
    OutOfRange where the grid cannot hold the waves: 2 spacings <= short_wave < long_wave <= size.
    """
    if not 2.0 * size / points <= spectrum.short_wave < spectrum.long_wave <= size:
        raise OutOfRange(
            f"short_wave {spectrum.short_wave:g} m and long_wave {spectrum.long_wave:g} m must lie between "
            f"two spacings, {2.0 * size / points:g} m, and the size, {size:g} m"
        )
    noise = np.random.Generator(np.random.Philox(seed)).standard_normal((points, points))
    amplitude = points * np.sqrt(wave_variances(spectrum, points, size))
    return np.asarray(np.fft.ifft2(np.fft.fft2(noise) * amplitude).real)


def wave_variances(spectrum: SelfAffine, points: int, size: float) -> Floats:
    """C(q) (2 pi/size)^2 [m2] of each wave of the grid, in the order of the discrete Fourier transform."""
    wider = spectrum._replace(
        long_wave=spectrum.long_wave * (1.0 + _EDGE), short_wave=spectrum.short_wave * (1.0 - _EDGE)
    )
    return np.asarray(wider(wave_numbers(points, size)) * (2.0 * np.pi / size) ** 2)


def wave_numbers(points: int, size: float) -> Floats:
    """q [1/m] of each wave of the grid, in the order of the discrete Fourier transform."""
    along = 2.0 * np.pi * np.fft.fftfreq(points, size / points)
    return np.asarray(np.hypot(along[:, None], along[None, :]))


def rms_slope(height: Floats, size: float) -> float:
    """sqrt(<|grad h|^2>) [1] of a periodic map without waves at the limit of its grid, over ``size`` [m]."""
    points = height.shape[0]
    return float(np.sqrt(np.sum(np.abs(np.fft.fft2(height)) ** 2 * wave_numbers(points, size) ** 2)) / points**2)
