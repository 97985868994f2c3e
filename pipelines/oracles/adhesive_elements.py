"""A rigid height map on an adhesive elastic half-space by boundary elements: periodic, attraction of finite range.

The gap is 0 or more; of it the energy is elastic, by waves, less the work of adhesion w exp(-gap/range) on the area
(V. Rey, G. Anciaux, J.-F. Molinari, Comput. Mech. 60 (2017) 69). From separation to separation it is followed downhill
by conjugate gradients with bounds (R. Bugnicourt et al., Tribol. Lett. 66 (2018) 29), here preconditioned. E* is 1.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats

_RTOL = 1e-3  # largest traction out of balance, over the strength
_RTOL_MEAN = 1e-4  # mean traction out of balance, over the mean attraction
_RTOL_FAR = 1e-9  # mean attraction that no longer counts, over the strength
_RTOL_PLANE = 1e-4  # displacement of the mean plane, over the range
_LARGEST_STEP = 1.0  # largest change of gaps within _NEAR ranges, over the range
_NEAR = 8.0
_FAR = 40.0  # ranges: exp(-40) is 4e-18
_MAX_ITERATIONS = 5000


class Adhered(NamedTuple):
    """The state at one separation."""

    force: float  # pressure less attraction over the patch: compression > 0
    closed: float  # area where the gap is 0
    attracted: float  # area where the gap is less than the range, which holds the closed one
    energy: float  # elastic energy less the work of adhesion of the area; 0 far away


class _Balance(NamedTuple):
    """Tractions of the grid cells."""

    pull: Floats  # the attraction
    slope: Floats  # elastic traction and attraction together, which where the gap is 0 the pressure takes up


class AdhesiveMap:
    """Heights on a periodic square grid over ``size``, facing a half-space of modulus 1.

    ``work`` is that of adhesion, ``reach`` its range: the attraction is work/reach exp(-gap/reach). The mean
    displacement is held at 0, so that separations count from the mean plane of the deformed half-space.
    """

    def __init__(self, height: Floats, size: float, work: float, reach: float) -> None:
        self.height, self.size, self.work, self.reach = height, size, work, reach
        points = height.shape[0]
        along = 2.0 * math.pi / size * points * np.fft.fftfreq(points)
        half = 2.0 * math.pi / size * np.arange(points // 2 + 1)
        self._stiffness = 0.5 * np.hypot(along[:, None], half[None, :])
        self._stiffness[0, 0] = self._plane = 0.5 * math.pi * points / size  # of the spring that holds the mean plane
        self._mean_pressure = 0.0
        self._separation = math.inf
        self.gap: Floats = np.full_like(height, math.inf)
        """At the last separation."""

    def move(self, separation: float) -> Adhered:
        """Return the state at ``separation`` of the datum plane, reached downhill from that of the last call.

        OutOfRange where it does not come to rest.
        """
        free_gap = separation - self.height
        came = math.isinf(self._separation)
        gap = np.maximum(free_gap if came else self.gap + (separation - self._separation), 0.0)
        self._separation = separation
        while True:
            gap, balance = self._descend(gap, free_gap)
            plane = float(np.mean(gap - free_gap))
            self._mean_pressure += self._plane * plane
            if abs(plane) <= _RTOL_PLANE * self.reach:
                break
        self.gap = gap
        return self._adhered(free_gap, balance)

    def _adhered(self, free_gap: Floats, balance: _Balance) -> Adhered:
        """Return force, areas and energy of the gap that is found."""
        area = self.size**2 / self.gap.size
        closed = self.gap == 0.0
        displacement = self.gap - free_gap
        displacement -= displacement.mean()
        elastic = 0.5 * _product(displacement, self._filtered(displacement, self._stiffness))
        return Adhered(
            force=area * float(np.sum(balance.slope[closed]) - np.sum(balance.pull)),
            closed=area * float(np.count_nonzero(closed)),
            attracted=area * float(np.count_nonzero(self.gap < self.reach)),
            energy=area * (elastic - self.reach * float(np.sum(balance.pull))),
        )

    def _filtered(self, values: Floats, factor: Floats) -> Floats:
        return np.asarray(irfft2(factor * rfft2(values), s=values.shape))

    def _balance(self, gap: Floats, elastic: Floats) -> _Balance:
        pull = self.work / self.reach * np.exp(-np.minimum(gap / self.reach, _FAR))
        return _Balance(pull, elastic + self._mean_pressure + pull)

    def _at_rest(self, balance: _Balance, residual: Floats) -> bool:
        strength = self.work / self.reach
        mean = max(_RTOL_MEAN * float(np.mean(balance.pull)), _RTOL_FAR * strength)
        return bool(np.abs(residual).max() <= _RTOL * strength and abs(float(residual.mean())) <= mean)

    def _descend(self, gap: Floats, free_gap: Floats) -> tuple[Floats, _Balance]:
        """Return the gap of least energy downhill from ``gap``, under the mean pressure of now."""
        compliance = 1.0 / self._stiffness
        elastic = self._filtered(gap - free_gap, self._stiffness)
        d = before = None
        for _ in range(_MAX_ITERATIONS):
            balance = self._balance(gap, elastic)
            free = (gap > 0.0) | (balance.slope < 0.0)
            r = np.where(free, balance.slope, 0.0)
            if self._at_rest(balance, r):
                return gap, balance
            z = np.where(free, self._filtered(r, compliance), 0.0)
            d = _direction(z, r, d, before, free)
            before = z, r
            by_d = self._filtered(d, self._stiffness)
            step = self._step(gap, d, r, by_d, balance.pull)
            new = gap + step * d
            clipped = new < 0.0
            if clipped.any():
                new[clipped] = 0.0
                elastic = elastic + self._filtered(new - gap, self._stiffness)
                d = np.where(clipped, 0.0, d)
            else:
                elastic = elastic + step * by_d
            gap = new
        raise OutOfRange(f"separation is {self._separation:g}: boundary elements do not converge")

    def _step(self, gap: Floats, d: Floats, r: Floats, by_d: Floats, pull: Floats) -> float:
        """Return the step along ``d`` to the least energy by its curvature, short where the attraction changes."""
        curvature = _product(d, by_d) - _product(pull, d * d) / self.reach
        near = np.abs(d[gap < _NEAR * self.reach]).max(initial=0.0)
        most = _LARGEST_STEP * self.reach / near if near > 0.0 else math.inf
        return min(-_product(r, d) / curvature, most) if curvature > 0.0 else float(most)


def _product(a: Floats, b: Floats) -> float:
    """Return the sum of products, in one thread: those of BLAS would wait for each other longer than it takes."""
    return float(np.einsum("ij,ij->", a, b))


def _direction(
    z: Floats, r: Floats, d: Floats | None, before: tuple[Floats, Floats] | None, free: NDArray[np.bool_]
) -> Floats:
    """Return the next direction by E. Polak and G. Ribiere, from the preconditioned residual ``z``; downhill."""
    if d is None or before is None:
        return -z
    z_old, r_old = before
    beta = max(_product(z, r - r_old) / _product(z_old, r_old), 0.0)
    found = np.where(free, beta * d - z, 0.0)
    return -z if _product(found, r) >= 0.0 else found
