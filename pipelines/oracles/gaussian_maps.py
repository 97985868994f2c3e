"""Periodic Gaussian height maps of a given spectrum, by the discrete Fourier transform, and the summits of such maps.

Summits of a map without waves shorter than its grid resolves are found exactly by its Fourier series.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.gaussian.summit_distribution import Summits
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import SelfAffine

_EDGE = 1e-9  # waves as long as a limit of the spectrum count as within it, whatever their rounding
DERIVATIVES = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
"""Orders along x and y of the derivatives that determine a summit."""
_STEPS = 8  # steps of Newton's method, from a point of a fine grid to the nearest summit
_RESOLUTION = 1e-6  # distance of two summits, over the spacing of the grid, below which they are one


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


@dataclass(frozen=True)
class Series:
    """h(x, y) = sum of amplitudes exp(i (qx x + qy y)) over -order..order waves along each side of a square."""

    amplitudes: NDArray[np.complex128]
    size: float  # [m]

    @classmethod
    def of(cls, height: Floats, size: float, order: int) -> "Series":
        """Return the series of a square map [m] over ``size`` [m], without waves beyond ``order``."""
        waves = np.arange(-order, order + 1)
        return cls((np.fft.fft2(height) / height.size)[np.ix_(waves, waves)], size)

    @property
    def _waves(self) -> tuple[NDArray[np.int64], Floats]:
        """The waves along a side, and their wave numbers [1/m]."""
        order = self.amplitudes.shape[0] // 2
        waves = np.arange(-order, order + 1)
        return waves, 2.0 * np.pi / self.size * waves

    def on_grid(self, points: int, along_x: int = 0, along_y: int = 0) -> Floats:
        """Return heights [m], or derivatives of these orders along x and y, on points x points."""
        (waves, q), whole = self._waves, np.zeros((points, points), dtype=np.complex128)
        whole[np.ix_(waves, waves)] = self.amplitudes * (1j * q[:, None]) ** along_x * (1j * q[None, :]) ** along_y
        return np.asarray(np.fft.ifft2(whole).real * points**2)

    def at(self, x: Floats, y: Floats) -> list[Floats]:
        """Return heights [m] and DERIVATIVES at points [m]."""
        _, q = self._waves
        from_x, from_y = np.exp(1j * np.outer(x, q)), np.exp(1j * np.outer(y, q))
        rows = [(from_x * (1j * q) ** m) @ self.amplitudes for m in range(3)]
        columns = [from_y * (1j * q) ** n for n in range(3)]
        return [np.einsum("ij,ij->i", rows[m], columns[n]).real for m, n in ((0, 0), *DERIVATIVES)]

    def summits(self, points: int) -> Summits:
        """Return all summits to which a step of Newton's method leads from the nearest of points x points."""
        spacing = self.size / points
        derivatives = [self.on_grid(points, m, n) for m, n in DERIVATIVES]
        near = _is_top(*derivatives[2:]) & (np.hypot(*_step(*derivatives)) < spacing)
        x, y = (np.asarray(spacing * index, dtype=np.float64) for index in np.nonzero(near))
        for _ in range(_STEPS):
            dx, dy = _step(*self.at(x, y)[1:])
            length = np.hypot(dx, dy)
            damping = spacing / np.maximum(length, spacing)
            x, y = x + damping * dx, y + damping * dy
        converged = length < _RESOLUTION * spacing
        cells = np.round(np.stack([x, y])[:, converged] / (_RESOLUTION * spacing)) % round(points / _RESOLUTION)
        x, y = np.asarray(np.unique(cells, axis=1) * (_RESOLUTION * spacing), dtype=np.float64)
        z, _, _, *second = self.at(x, y)
        top = _is_top(*second)
        hxx, hxy, hyy = (derivative[top] for derivative in second)
        return Summits(z[top], -0.5 * (hxx + hyy), 1.0 / np.sqrt(hxx * hyy - hxy**2))


def _step(hx: Floats, hy: Floats, hxx: Floats, hxy: Floats, hyy: Floats) -> tuple[Floats, Floats]:
    """Return the step to where a quadratic with these derivatives is level."""
    determinant = hxx * hyy - hxy**2
    return (hxy * hy - hyy * hx) / determinant, (hxy * hx - hxx * hy) / determinant


def _is_top(hxx: Floats, hxy: Floats, hyy: Floats) -> NDArray[np.bool_]:
    return np.asarray((hxx * hyy > hxy**2) & (hxx < 0.0))
