"""A rigid height map pressed into an elastic half-space by boundary elements, without adhesion.

The pressures of the grid cells are found by constrained conjugate gradients (I. A. Polonsky, L. M. Keer, Wear 231
(1999), 206). Where the half-space repeats with the map they displace the surface by the Green's function in wave
numbers, 2/(E* q), and the mean displacement is 0: separations count from the mean plane of the deformed half-space.
Where the map stands alone they do so by that of a rectangle under pressure (A. E. H. Love, Phil. Trans. R. Soc. A 228
(1929), 377), on a grid of twice the sides, and separations count from the undeformed half-space.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

_RESIDUAL = 1e-6
"""The largest gap in contact, or overlap outside it, over the deepest overlap: about the error of the force."""
_MAX_ITERATIONS = 2000  # most iterations, next to full contact; usual are 50 to 100
_DIFFERENCE, STIFFNESS_ERROR = 0.01, 0.01
"""Step of the separation, each way, over the deepest overlap. Cells at an edge touch one by one, so that the stiffness
is accurate to 1 %."""
_EDGE_SHARE = (math.pi - 1.0 + math.log(2.0)) / 24.0
"""Area to take off for each side of a cell on the edge of a contact, in cells: the mean over directions of the edge
(V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114 (2017), 161)."""
_OF_ALL_SIDES, _OF_EACH_SIDE = 0.015, 0.4
"""Error of the area by the sides of cells at the edges, in cells: by their number, as the mean over directions of one
shape is not that of another, and by its root, as each is off on its own (``pipelines/study.py hills``)."""


class Patches(NamedTuple):
    """The connected contacts."""

    contacts: int
    area: float
    """Areas, in the square of the unit of the sides."""
    radius_sum: float
    """Sum of the radii of discs of these areas, in the unit of the sides."""
    area_error: float
    """Error of the summed area by the cells at the edges, at given force, in the square of the unit of the sides."""


class BoundaryElements:
    """A height map over a patch of ``sides``, all in one unit, which E* = 1 goes with; -inf is never touched.

    The half-space repeats with the map unless it is not ``periodic``. The pressures of the last separation are kept,
    and the next one starts from them.
    """

    def __init__(self, height: Floats, sides: Floats, *, periodic: bool = True) -> None:
        from scipy import fft

        self.height, self.sides, self.periodic = height, sides, periodic
        self.cell_area = float(sides[0] * sides[1]) / height.size
        cell = sides / np.array(height.shape)
        self._shape = height.shape if periodic else tuple(fft.next_fast_len(2 * n, real=True) for n in height.shape)
        self._compliance = _of_waves(self._shape, cell) if periodic else fft.rfft2(_of_rectangles(self._shape, cell))
        self._cell_stiffness = 1.0 / float(fft.irfft2(self._compliance, s=self._shape)[0, 0])
        self.pressure = np.zeros_like(height)
        """Pressure [E*] at the last separation."""
        self.work = 0.0
        """Number of iterations so far times points of the grid."""

    def displacement(self) -> Floats:
        """Return the displacement of the surface, into the half-space."""
        return self._displaced(self.pressure)

    def _displaced(self, pressure: Floats) -> Floats:
        from scipy import fft

        spectrum = fft.rfft2(pressure, s=self._shape)
        spectrum *= self._compliance
        displaced = np.asarray(fft.irfft2(spectrum, s=self._shape, overwrite_x=True))
        return displaced[: pressure.shape[0], : pressure.shape[1]]

    def press(self, separation: float) -> float:
        """Return the force at a separation; NaN where none is found, as from the mean height of a periodic map down."""
        with np.errstate(invalid="ignore"):
            overlap = self.height - separation
        deepest = float(overlap.max())
        if deepest <= 0.0:
            self.pressure = np.zeros_like(overlap)
            return 0.0
        if self.periodic and overlap.mean() >= 0.0:
            return math.nan
        overlap /= deepest
        for start in self._starts(overlap):
            pressure = self._solve(overlap, start)
            if pressure is not None:
                self.pressure = pressure * deepest
                return self.cell_area * float(self.pressure.sum())
        self.pressure = np.zeros_like(overlap)
        return math.nan

    def _starts(self, overlap: Floats) -> Iterator[Floats]:
        """Yield the last pressures, and pressures proportional to the overlap, both with the best factor."""
        for pressure in (self.pressure, overlap.clip(0.0)):
            work = _dot(pressure, np.where(pressure > 0.0, overlap, 0.0))
            if work > 0.0:
                yield np.asarray(pressure * (work / _dot(pressure, self._displaced(pressure))))

    def _solve(self, overlap: Floats, pressure: Floats) -> Floats | None:
        """Return the pressures that undo the overlap; None where they are not found."""
        before, direction = 0.0, np.zeros_like(overlap)
        for _ in range(_MAX_ITERATIONS):
            self.work += math.prod(self._shape)
            gap = self._displaced(pressure) - overlap
            loaded = pressure > 0.0
            rest = np.where(loaded, gap, 0.0)
            if max(float(np.abs(rest).max()), -float(gap.min())) <= _RESIDUAL:
                return pressure
            square = _dot(rest, rest)
            direction = rest + (square / before * np.where(loaded, direction, 0.0) if before > 0.0 else 0.0)
            curvature = _dot(direction, self._displaced(direction))
            flat = not curvature > 0.0  # the loaded cells are in equilibrium, but others overlap
            step = self._cell_stiffness if flat else _dot(rest, direction) / curvature
            pressure = np.maximum(pressure - step * direction, 0.0)
            hit = (pressure == 0.0) & (gap < 0.0)
            pressure[hit] -= step * gap[hit]
            if flat and not hit.any():
                return None
            before = 0.0 if hit.any() else square
        return None

    def stiffness(self, separation: float) -> float:
        """Return -dF/dh by a central difference; the pressures stay as they are."""
        kept = self.pressure
        change = _DIFFERENCE * (float(self.height.max()) - separation)
        if change <= 0.0:
            return 0.0
        nearer = self.press(separation - change)
        farther = self.press(separation + change)
        self.pressure = kept
        return (nearer - farther) / (2.0 * change)

    def patches(self) -> Patches:
        """Return the connected contacts, with the mean share of the cells at their edges taken off."""
        loaded = self.pressure > 0.0
        labels, count = connected(loaded, across=self.periodic)
        cells = np.bincount(labels.ravel(), minlength=count + 1).astype(np.float64)
        edges = np.zeros(count + 1)
        around = np.pad(loaded, 1, mode="wrap" if self.periodic else "edge")  # contacts continue where a map ends
        for beside in (around[:-2, 1:-1], around[2:, 1:-1], around[1:-1, :-2], around[1:-1, 2:]):
            edges += np.bincount(labels[loaded & ~beside], minlength=count + 1)
        area = (cells - _EDGE_SHARE * edges)[1:] * self.cell_area
        radius_sum = math.fsum(np.sqrt(area / math.pi).tolist())
        sides = float(edges.sum())
        error = (_OF_ALL_SIDES * sides + _OF_EACH_SIDE * math.sqrt(sides)) * self.cell_area
        return Patches(count, math.fsum(area.tolist()), radius_sum, error)


def _dot(a: Floats, b: Floats) -> float:
    """Return the sum of the products; a BLAS would share it among threads, and its bits depend on their number."""
    return float(np.einsum("ij,ij->", a, b))


def _of_waves(shape: tuple[int, ...], cell: Floats) -> Floats:
    """Return the displacement by waves of pressure, over the pressure: 2/q, 0 of the mean."""
    from scipy import fft

    wave = np.hypot(fft.fftfreq(shape[0], cell[0])[:, None], fft.rfftfreq(shape[1], cell[1]))
    wave[0, 0] = np.inf
    return 1.0 / (math.pi * wave)


def _of_rectangles(shape: tuple[int, ...], cell: Floats) -> Floats:
    """Return the displacement at all distances from a cell under unit pressure, those of cells before it at the end."""
    x, y = (np.fft.fftfreq(n, 1.0 / n) * size for n, size in zip(shape, cell, strict=True))
    left, right = ((x + each)[:, None] for each in (-0.5 * cell[0], 0.5 * cell[0]))
    below, above = (y + each for each in (-0.5 * cell[1], 0.5 * cell[1]))

    def part(a: Floats, b: Floats) -> Floats:
        return a * np.arcsinh(b / np.abs(a)) + b * np.arcsinh(a / np.abs(b))

    return np.asarray(part(right, above) - part(right, below) - part(left, above) + part(left, below)) / math.pi


def connected(loaded: NDArray[np.bool_], *, across: bool) -> tuple[NDArray[np.int64], int]:
    """Return the number from 1 of the patch of each cell, 0 outside, and their count; ``across`` the rim too."""
    from scipy.ndimage import label
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    labels, count = label(loaded)
    if not across:
        return labels.astype(np.int64), int(count)
    one = np.concatenate([labels[0], labels[:, 0]])
    other = np.concatenate([labels[-1], labels[:, -1]])
    both = (one > 0) & (other > 0)
    pairs = coo_array((np.ones(both.sum()), (one[both], other[both])), shape=(count + 1, count + 1))
    merged, number = connected_components(pairs, directed=False)  # the outside, joined with nothing, is number 0
    return number[labels].astype(np.int64), merged - 1
