"""Densities of summit heights, and means over the summits above a height."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.quadrature import Rows, integrate
from roughmdr.schema.arguments import check_number, exactly_one

# A normal density is cut where it is negligible below, and where it underflows above.
NORMAL_EDGES = np.array([-9.0, -5.0, -2.0, 0.0, 2.0, 5.0, 9.0, 16.0, 39.0])
_QUANTILES = (0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99)
_DOUBLINGS = 128
_LIGHT_TAIL_DOUBLINGS = 40  # doublings of the width of panels after which only heavy tails are followed
_NEGLIGIBLE = 1e-20
_BLOCK = 512  # number of separations in one array


class Distribution(Protocol):
    """The interface of heights: that of a frozen continuous distribution of scipy.stats."""

    def pdf(self, x: Any) -> Any:
        """Return the density at heights x."""

    def ppf(self, q: Any) -> Any:
        """Return the heights below which fractions q lie."""

    def support(self) -> Any:
        """Return the lowest and the highest height; infinite where there is none."""


class Heights(NamedTuple):
    """A density of heights between the first and the last of ``edges``, between which it is smooth."""

    density: Callable[[Floats], Floats]
    edges: Floats
    endless: bool = False  # whether the support continues beyond the last edge

    @classmethod
    def of(cls, owner: str, std: float | str | None, heights: Distribution | None) -> "Heights":
        """Return normal heights of mean 0, or those of a distribution; RoughmdrError unless exactly one is given."""
        exactly_one(owner, std=std, heights=heights)
        if std is None:
            return _of_distribution(heights)
        deviation = check_number("std", std, "m")
        scale = 1.0 / (deviation * math.sqrt(2.0 * math.pi))
        return cls(lambda z: scale * np.exp(-0.5 * (z / deviation) ** 2), deviation * NORMAL_EDGES)

    def mean(self, start: Floats, value: Callable[[Rows, Floats], Floats]) -> Floats:
        """Return ∫ value(row, z - start) density(z) dz over z >= start, for each start.

        ``value`` may begin like a power of sqrt(z - start), which is the variable of integration.
        """
        start = np.maximum(start, self.edges[0])
        blocks = range(0, len(start), _BLOCK)
        return np.concatenate([self._block(start, i, value) for i in blocks]) if len(start) else start

    def _block(self, start: Floats, first: int, value: Callable[[Rows, Floats], Floats]) -> Floats:
        block_start = start[first : first + _BLOCK, None]

        def integrand(rows: Rows, s: Floats) -> Floats:
            beyond = s * s
            return 2.0 * s * value(rows + first, beyond) * self.density(block_start[rows] + beyond)

        edges = np.sqrt(np.maximum(self.edges - block_start, 0.0))
        values = integrate(integrand, edges)
        if self.endless:  # the last panel must be negligible
            last, inside = integrate(integrand, edges[:, -2:]), edges[:, -2] > 0.0
            if (np.abs(last)[inside] > 1e-12 * np.abs(values)[inside]).any():
                raise OutOfRange(
                    "heights have too heavy a tail: the mean over the summits is not finite, or does not converge"
                )
        return values


def _of_distribution(given: Distribution | None) -> Heights:
    """Return the heights of a distribution; panels follow its quantiles, and then double their width."""
    if given is None or not all(callable(getattr(given, name, None)) for name in ("pdf", "ppf", "support")):
        raise RoughmdrError(f"heights is {given!r}; it must be a frozen continuous distribution of scipy.stats")
    lowest, highest = (float(end) for end in given.support())
    # At its ends a density may be infinite.
    first, last = np.nextafter(lowest, math.inf), np.nextafter(highest, -math.inf)

    def density(z: Floats) -> Floats:
        with np.errstate(all="ignore"):  # far out some densities overflow before they are 0
            return np.asarray(given.pdf(np.clip(z, first, last)), dtype=np.float64)

    quantiles = np.asarray(given.ppf(_QUANTILES), dtype=np.float64)
    steps = (quantiles[-1] - quantiles[0]) * 2.0 ** np.arange(_DOUBLINGS)
    if not (np.isfinite(quantiles).all() and steps[0] > 0.0):
        raise OutOfRange(f"heights have the percentiles {quantiles}; they must be finite and differ")
    above, below = quantiles[-1] + steps, quantiles[0] - steps
    above, below = above[above < highest], below[below > lowest]
    mass, force = density(below) * steps[: len(below)], density(above) * steps[: len(above)] ** 2.5
    far = (np.arange(len(above)) < _LIGHT_TAIL_DOUBLINGS) | (force > _NEGLIGIBLE**2 * force[:1])
    # A thin tail lies within one panel; one more above it shows that nothing is left.
    above = above[_extended(_extended((force > 0.0) & far))]
    inner = [below[_extended(mass > _NEGLIGIBLE)], quantiles, above]
    ends = [end for end in (lowest, highest) if math.isfinite(end)]
    return Heights(density, np.unique(np.concatenate([*inner, ends])), highest == math.inf)


def _extended(selected: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Extend a selection of edges by the first and by the next one out."""
    return np.append(True, selected)[:-1] | selected
