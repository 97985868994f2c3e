"""Gaussian self-affine maps without waves below a shortest one, the same on grids of any fineness."""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

SIDE = 1e-4
"""Of the patch [m]."""
SLOPE = 1e-2
"""r.m.s., small: nothing depends on it."""
_ROLL_OFF = 2.0  # wave number over that of the side, below which the spectrum is level


class MapCase(NamedTuple):
    """A map: Hurst exponent, side over the shortest wave, seed, and length of the waves along over across."""

    hurst: float
    bandwidth: int
    seed: int
    anisotropy: float = 1.0

    def height(self, points: float) -> Floats:
        """Return the map [m] on a grid with so many points a shortest wave."""
        stretch = np.sqrt(self.anisotropy)
        count = 2 * round(0.5 * points * self.bandwidth * stretch)
        number = np.fft.fftfreq(count, 1.0 / count)
        along, across = np.meshgrid(number, number, indexing="ij")
        wave = np.hypot(along * stretch, across / stretch)
        inside = (wave > 0.0) & (wave <= self.bandwidth)
        amplitude = np.where(inside, np.maximum(wave, _ROLL_OFF) ** -(1.0 + self.hurst), 0.0)
        most = int(np.ceil(self.bandwidth * stretch)) + 1
        noise = np.random.default_rng([self.seed, round(10 * self.hurst), self.bandwidth]).standard_normal(
            (2, 2 * most + 1, 2 * most + 1)
        )
        place = np.clip(along, -most, most).astype(int) + most, np.clip(across, -most, most).astype(int) + most
        spectrum = amplitude * (noise[0] + 1j * noise[1])[place]
        height = np.fft.ifft2(spectrum).real
        power = np.abs(np.fft.fft2(height)) ** 2 / count**4
        slope = 2.0 * np.pi / SIDE * np.sqrt(np.sum(power * (along**2 + across**2)))
        return np.asarray(height * (SLOPE / slope))


ISOTROPIC = [
    MapCase(hurst, bandwidth, seed)
    for hurst in (0.3, 0.5, 0.8)
    for bandwidth, seeds in ((8, (11, 12, 13)), (16, (11, 12)), (32, (11, 12)), (64, (11,)))
    for seed in seeds
]
ANISOTROPIC = [MapCase(hurst, bandwidth, 11, 4.0) for hurst in (0.3, 0.5, 0.8) for bandwidth in (8, 16, 32)]
QUICK = [MapCase(0.8, 8, 11), MapCase(0.5, 16, 11), MapCase(0.5, 8, 11, 4.0)]
