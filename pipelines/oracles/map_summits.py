"""The summits of a periodic map without waves shorter than its grid resolves, found exactly by its Fourier series."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.gaussian.summit_distribution import Summits
from roughmdr.numerics.arguments import Floats

DERIVATIVES = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
"""Orders along x and y of the derivatives that determine a summit."""
_STEPS = 8  # of Newton's method, from a point of a fine grid to the nearest summit
_RESOLUTION = 1e-6  # of the spacing of the grid: nearer summits are one


@dataclass(frozen=True)
class Series:
    """h(x, y) = sum of amplitudes exp(i (qx x + qy y)) over -order..order waves along each side of a square."""

    amplitudes: NDArray[np.complex128]
    size: float
    """[m]."""

    @classmethod
    def of(cls, height: Floats, size: float, order: int) -> "Series":
        """Return the series of a square map [m] over ``size`` [m], without waves beyond ``order``."""
        waves = np.arange(-order, order + 1)
        return cls((np.fft.fft2(height) / height.size)[np.ix_(waves, waves)], size)

    @property
    def _waves(self) -> NDArray[np.int64]:
        order = self.amplitudes.shape[0] // 2
        return np.arange(-order, order + 1)

    @property
    def _numbers(self) -> Floats:
        """Wave numbers [1/m] along a side."""
        return np.asarray(2.0 * np.pi / self.size * self._waves)

    def on_grid(self, points: int, along_x: int = 0, along_y: int = 0) -> Floats:
        """Return heights [m], or derivatives of these orders along x and y, on points x points."""
        q, whole = self._numbers, np.zeros((points, points), dtype=np.complex128)
        whole[np.ix_(self._waves, self._waves)] = (
            self.amplitudes * (1j * q[:, None]) ** along_x * (1j * q[None, :]) ** along_y
        )
        return np.asarray(np.fft.ifft2(whole).real * points**2)

    def at(self, x: Floats, y: Floats) -> list[Floats]:
        """Return heights [m] and DERIVATIVES at points [m]."""
        q = self._numbers
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
