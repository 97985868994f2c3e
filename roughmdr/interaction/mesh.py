"""The displacements of contacts by each other in N log N: near pairs one by one, all others on a mesh (P3M).

Ewald's sums with the waves taken from a mesh by fast Fourier transforms (R. W. Hockney, J. W. Eastwood, Computer
Simulation Using Particles, 1988; D. Lindbo, A.-K. Tornberg, J. Comput. Phys. 230 (2011) 8744). Loads are spread over
the mesh by the exponential of a semicircle (A. H. Barnett, J. Magland, L. af Klinteberg, SIAM J. Sci. Comput. 41 (2019)
C479). A free patch lies in a larger one, on which the far part of 1/r is cut off smoothly beyond the largest distance.
"""

import math
from typing import NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import erf, erfcinv

from roughmdr.interaction.green import (
    Periodic,
    below_all,
    far_part_at_load,
    far_wave,
    mean_of_near_part,
    near_part,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import njit

_OVERSAMPLING = 1.6  # mesh points for each half wave that is kept
_MESH_PER_REACH = 1.0  # mesh points for each mean spacing of the contacts, over erfc^-1(error)
_FREE = 2.5  # side of the patch in which a free one lies
_STEEPNESS = 10.0  # steepness of the cut: erfc(5) is 2e-12
_LEAST_MESH, _LEAST_FREE_MESH = 24, 120  # mesh points for the shorter side; the cut must be resolved
_LARGE_MESH = 2**18  # points from which on a transform is worth several cores
_ROWS_AT_A_TIME = 8  # rows of the mesh along which points follow each other, so that their cells are in the cache
_NODES, _WEIGHTS = unit_gauss(60)

Complex = NDArray[np.complex128]


class Spread(NamedTuple):
    """Where the points lie on the mesh: first row and column, and weights [point, cell] along x and y."""

    first: NDArray[np.int64]
    along_x: Floats
    along_y: Floats


@njit
def _locate(at: Floats, points: int, axis: int, spread: Spread, beta: float) -> None:
    """Fill the cells and the weights along an axis with so many mesh points, of points ``at`` [side of the mesh]."""
    weights = spread.along_x if axis == 0 else spread.along_y
    width = weights.shape[1]
    for i in range(at.size):
        place = at[i] * points
        low = math.ceil(place - 0.5 * width)
        spread.first[i, axis] = low % points
        for k in range(width):
            z = (low + k - place) / (0.5 * width)
            weights[i, k] = math.exp(beta * (math.sqrt(max(1.0 - z * z, 0.0)) - 1.0)) if abs(z) < 1.0 else 0.0


@njit
def _scatter(load: Floats, spread: Spread, mesh: Floats) -> None:
    rows, columns = mesh.shape
    width = spread.along_x.shape[1]
    for i in range(load.size):
        if load[i] != 0.0:
            for k in range(width):
                row = (spread.first[i, 0] + k) % rows
                part = load[i] * spread.along_x[i, k]
                column = spread.first[i, 1]
                for m in range(width):
                    mesh[row, column] += part * spread.along_y[i, m]
                    column = column + 1 if column + 1 < columns else 0


@njit
def _gather(mesh: Floats, spread: Spread, values: Floats) -> None:
    rows, columns = mesh.shape
    width = spread.along_x.shape[1]
    for i in range(values.size):
        total = 0.0
        for k in range(width):
            row = (spread.first[i, 0] + k) % rows
            column = spread.first[i, 1]
            part = 0.0
            for m in range(width):
                part += mesh[row, column] * spread.along_y[i, m]
                column = column + 1 if column + 1 < columns else 0
            total += spread.along_x[i, k] * part
        values[i] += total


@njit
def _near_fields(pairs: NDArray[np.int64], at: Floats, patch: Periodic, periodic: bool, fields: Floats) -> None:
    """Fill G, its slopes and its Laplacian of the near part of each pair, [pair, row]."""
    for number in range(pairs.shape[0]):
        i, j = pairs[number]
        dx, dy = at[i, 0] - at[j, 0], at[i, 1] - at[j, 1]
        if periodic:
            dx, dy = dx - math.floor(dx + 0.5), dy - patch.side_y * math.floor(dy / patch.side_y + 0.5)
        fields[number] = near_part(dx, dy, patch.split)


@njit
def _add_near_potential(pairs: NDArray[np.int64], fields: Floats, load: Floats, out: Floats) -> None:
    for number in range(pairs.shape[0]):
        i, j = pairs[number]
        g = fields[number, 0]
        out[i] += g * load[j]
        out[j] += g * load[i]


@njit
def _add_near_field(pairs: NDArray[np.int64], fields: Floats, load: Floats, out: Floats) -> None:
    for number in range(pairs.shape[0]):
        i, j = pairs[number]
        g, gx, gy, lap = fields[number, 0], fields[number, 1], fields[number, 2], fields[number, 3]
        p, q = load[i], load[j]
        out[0, i] += g * q
        out[0, j] += g * p
        out[1, i] += gx * q
        out[1, j] -= gx * p
        out[2, i] += gy * q
        out[2, j] -= gy * p
        out[3, i] += lap * q
        out[3, j] += lap * p


@njit
def _add_near_moments(pairs: NDArray[np.int64], fields: Floats, sources: Floats, out: Floats) -> None:
    for number in range(pairs.shape[0]):
        i, j = pairs[number]
        gx, gy, lap = fields[number, 1], fields[number, 2], fields[number, 3]
        out[i] += lap * sources[0, j] + gx * sources[1, j] + gy * sources[2, j]
        out[j] += lap * sources[0, i] - gx * sources[1, i] - gy * sources[2, i]


class Mesh:
    """Points on a patch with their near pairs and the mesh for all others, in units of the patch."""

    def __init__(self, x: Floats, y: Floats, patch: Periodic, periodic: bool, error: float) -> None:
        self.error = error
        self._count, reach = x.size, float(erfcinv(error))
        around = 1.0 if periodic else _FREE
        sides = around, around * patch.side_y
        least = _LEAST_MESH if periodic else _LEAST_FREE_MESH
        per_spacing = _MESH_PER_REACH * reach
        per_side = max(per_spacing * math.sqrt(x.size / patch.side_y), least / min(1.0, patch.side_y))
        self._shape = tuple(scipy.fft.next_fast_len(math.ceil(per_side * side), real=True) for side in sides)
        self._workers = -1 if self._shape[0] * self._shape[1] >= _LARGE_MESH else 1
        finest = min(points / side for points, side in zip(self._shape, sides, strict=True))
        split = math.pi * finest / (2.0 * reach * _OVERSAMPLING)
        cutoff = reach / split
        if periodic and cutoff > 0.5 * min(sides):
            split, cutoff = 2.0 * reach / min(sides), 0.5 * min(sides)
        own = Periodic(patch.side_y, split)
        at = np.column_stack([x, y])
        self._order = self._along_rows(at / sides)
        at = at[self._order]
        self._pairs = self._near_pairs(at, cutoff, np.array([1.0, patch.side_y]) if periodic else None)
        self._fields = np.empty((self._pairs.shape[0], 4))
        _near_fields(self._pairs, at, own, periodic, self._fields)
        width = math.ceil(-math.log10(error)) + 2
        beta = math.pi * width * (1.0 - 0.5 / _OVERSAMPLING)
        self._spread = Spread(np.empty((x.size, 2), np.int64), np.empty((x.size, width)), np.empty((x.size, width)))
        for axis in range(2):
            _locate(at[:, axis] / sides[axis], self._shape[axis], axis, self._spread, beta)
        waves = [2.0 * math.pi * scipy.fft.fftfreq(n, side / n) for n, side in zip(self._shape, sides, strict=True)]
        waves[1] = waves[1][: self._shape[1] // 2 + 1]
        kx, ky = waves[0][:, None], np.abs(waves[1])[None, :]
        k = np.hypot(kx, ky)
        if periodic:
            k[0, 0] = 1.0
            amplitude = _far_waves(k, split, patch.side_y)
            amplitude[0, 0] = -mean_of_near_part(split, patch.side_y)
        else:
            amplitude = self._cut_off(split, patch.side_y, sides)
        amplitude *= self._shape[0] * self._shape[1]
        windows = [_window(wave * side / n * 0.5 * width, beta) * 0.5 * width
                   for wave, side, n in zip(waves, sides, self._shape, strict=True)]  # fmt: skip
        self._green = amplitude / (windows[0][:, None] ** 2 * windows[1][None, :] ** 2)
        self._kx, self._ky = 1j * kx, 1j * ky
        if self._shape[0] % 2 == 0:
            self._kx[self._shape[0] // 2] = 0.0  # the highest wave has no slope on the mesh
        if self._shape[1] % 2 == 0:
            self._ky[:, -1] = 0.0
        self._laplace = -(k * k)
        if periodic:
            self._laplace[0, 0] = 0.0
        self._own, self._own_laplacian = far_part_at_load(split)

    def _along_rows(self, at: Floats) -> NDArray[np.int64]:
        """Return the order of points ``at`` [side of the mesh] in which they are kept: along a few rows at a time."""
        cell = np.floor(at * np.array(self._shape)).astype(np.int64)
        return np.lexsort((cell[:, 1], cell[:, 0] // _ROWS_AT_A_TIME))

    def _as_given(self, values: Floats) -> Floats:
        """Return values [..., point] in the order in which the points were given."""
        result = np.empty_like(values)
        result[..., self._order] = values
        return result

    @staticmethod
    def _near_pairs(at: Floats, cutoff: float, box: Floats | None) -> NDArray[np.int64]:
        wrapped = at if box is None else np.minimum(at % box, np.nextafter(box, 0.0))
        pairs = cKDTree(wrapped, boxsize=box).query_pairs(cutoff, output_type="ndarray")
        return np.ascontiguousarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].astype(np.int64))

    def _cut_off(self, split: float, side_y: float, sides: tuple[float, float]) -> Floats:
        """Return the waves of erf(split r)/r on the larger patch, cut off smoothly between the sides of the two."""
        away = [np.abs(scipy.fft.fftfreq(n, 1.0 / side)) for n, side in zip(self._shape, sides, strict=True)]
        r = np.hypot(away[0][:, None], away[1][None, :])
        with np.errstate(invalid="ignore", divide="ignore"):
            kernel = np.where(r > 0.0, erf(split * r) / r, far_part_at_load(split)[0])
        for axis, (distance, own, whole) in enumerate(zip(away, (1.0, side_y), sides, strict=True)):
            beyond = (distance / own - 1.0) / (0.5 * whole / own - 1.0)  # 0 at the largest distance, 1 at the edge
            keep = 0.5 * (1.0 - erf(_STEEPNESS * (beyond.clip(0.0, 1.0) - 0.5)))
            kernel *= keep[:, None] if axis == 0 else keep[None, :]
        return np.asarray(scipy.fft.rfft2(kernel).real / kernel.size)

    def _waves_of(self, load: Floats) -> Complex:
        mesh = np.zeros(self._shape)
        _scatter(load, self._spread, mesh)
        return np.asarray(scipy.fft.rfft2(mesh, overwrite_x=True, workers=self._workers))

    def _at_points(self, waves: Complex) -> Floats:
        values = np.zeros(self._count)
        _gather(scipy.fft.irfft2(waves, s=self._shape, overwrite_x=True, workers=self._workers), self._spread, values)
        return values

    def potential(self, load: Floats) -> Floats:
        """Return the displacement of each point by point loads."""
        load = load[self._order]
        result = self._at_points(self._waves_of(load) * self._green) - self._own * load
        _add_near_potential(self._pairs, self._fields, load, result)
        return self._as_given(result)

    def least_displacement(self, load: Floats) -> float:
        """Return about the least displacement between the points by compressive point loads."""
        load = load[self._order]
        far = self._at_points(self._waves_of(load) * self._green) - self._own * load
        return below_all(far)

    def field(self, load: Floats) -> Floats:
        """Return displacement, slopes and Laplacian at each point by point loads, [row, asperity]."""
        load = load[self._order]
        waves = self._waves_of(load) * self._green
        rows = [self._at_points(waves * kind) for kind in (1.0, self._kx, self._ky, self._laplace)]
        rows[0] -= self._own * load
        rows[3] -= self._own_laplacian * load
        result = np.array(rows)
        _add_near_field(self._pairs, self._fields, load, result)
        return self._as_given(result)

    def of_moments(self, laplacian: Floats, along_x: Floats, along_y: Floats) -> Floats:
        """Return the displacement by sources of the Laplacian and of the slopes of G."""
        sources = np.array([laplacian, along_x, along_y])[:, self._order]
        kinds = self._laplace, self._kx, self._ky
        waves = sum((self._waves_of(source) * kind for source, kind in zip(sources, kinds, strict=True)),
                    start=np.zeros(1, np.complex128))  # fmt: skip
        result = self._at_points(waves * self._green) - self._own_laplacian * sources[0]
        _add_near_moments(self._pairs, self._fields, sources, result)
        return self._as_given(result)


@njit
def _far_waves(k: Floats, split: float, area: float) -> Floats:
    waves = np.empty_like(k)
    for i in range(k.shape[0]):
        for j in range(k.shape[1]):
            waves[i, j] = far_wave(k[i, j], split, area)
    return waves


def _window(angle: Floats, beta: float) -> Floats:
    """Return ∫ of the spreading function on (-1, 1) times cos(angle z)."""
    z = 2.0 * _NODES - 1.0
    height = np.exp(beta * (np.sqrt(1.0 - z * z) - 1.0)) * 2.0 * _WEIGHTS
    return np.asarray(np.cos(angle[:, None] * z[None, :]) @ height)
