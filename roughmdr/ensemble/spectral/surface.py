"""Periodic Gaussian surfaces: the waves that fit on a patch, and maps of them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import Moments, SelfAffine


class Waves(NamedTuple):
    """The waves of a spectrum on a square patch: one of each two opposite wave vectors 2 pi (i, j)/patch.

    They are in the order of ``q``, so that a spectrum with shorter waves begins with those of a spectrum without.
    """

    patch: float  # [m]
    i: NDArray[np.int64]
    j: NDArray[np.int64]
    q: Floats  # wave number of the isotropic surface that is stretched [1/m]
    variance: Floats  # <h^2> of a wave and its opposite [m2]

    @classmethod
    def of(cls, spectrum: SelfAffine, patch: float, anisotropy: float, *, rms_slope: float | None) -> "Waves":
        """Return the waves of a spectrum, lengths along x stretched by the root of ``anisotropy``, along y compressed.

        The mean of h^2 over realisations is that of the spectrum, or the mean square slope that of ``rms_slope``.
        """
        unit, stretch = 2.0 * math.pi / patch, math.sqrt(anisotropy)
        most = math.floor(patch / spectrum.short_wave * stretch) + 1
        i, j = np.meshgrid(np.arange(-most, most + 1), np.arange(most + 1), indexing="ij")
        half = (j > 0) | (i > 0)
        i, j = i[half], j[half]
        q = unit * np.hypot(i * stretch, j / stretch)
        density = spectrum(q)
        there = density > 0.0
        i, j, q, density = i[there], j[there], q[there], density[there]
        order = np.lexsort((j, i, q))
        i, j, q, variance = i[order], j[order], q[order], 2.0 * unit * unit * density[order]
        if rms_slope is None:
            variance *= spectrum.moments.m0 / math.fsum(variance)
        else:
            variance *= rms_slope**2 / math.fsum(variance * unit * unit * (i * i + j * j))
        return cls(patch, i, j, q, variance)

    @property
    def moments(self) -> Moments:
        """Moments of a profile of the isotropic surface; stretched, its summits keep heights, density and radii."""
        squared = self.q * self.q
        m0, m2, m4 = (math.fsum(self.variance * squared**k) for k in range(3))
        return Moments(m0, 0.5 * m2, 0.375 * m4)

    def map(self, scores: Floats, points: int) -> HeightMap:
        """Return a map with so many points along a side from two normal scores of each wave [2, wave].

        Points are in the middle of cells: on every grid the surface is the same.
        """
        from scipy import fft

        if points <= 2 * max(int(np.abs(self.i).max()), int(self.j.max())):
            raise AssertionError(f"{points} points do not hold the waves")
        middle = np.exp(1j * math.pi * (self.i + self.j) / points)
        amplitude = np.sqrt(0.25 * self.variance) * (scores[0] + 1j * scores[1]) * middle
        waves = np.zeros((points, points // 2 + 1), dtype=np.complex128)
        waves[self.i, self.j] = amplitude
        along_x = self.j == 0
        waves[-self.i[along_x], 0] = np.conj(amplitude[along_x])
        height = fft.irfft2(waves, s=(points, points), norm="forward", overwrite_x=True)
        spacing = self.patch / points
        return HeightMap(np.asarray(height), spacing, spacing, True)
