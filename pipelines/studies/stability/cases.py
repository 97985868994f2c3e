"""The cases of the stability study: ensembles of power laws placed over seven axes."""

from typing import Any, NamedTuple

import numpy as np
from scipy.stats import qmc

import roughmdr as rm

SEED = 20260
ASPERITIES = 3  # asperities of a case
_WIDTHS = (0.0, -0.5, 0.5)  # logarithms of the widths of the asperities, in spreads [decades]
_MARGIN = 0.04  # part of the cases that lies at each end of an axis


class Axis(NamedTuple):
    """A quantity between two ends, varied in the logarithm of its distance to ``origin``, or linearly (None)."""

    long_name: str
    label: str
    units: str
    low: float
    high: float
    origin: float | None = 0.0

    def at(self, fraction: float) -> float:
        """Return the value at a fraction of the axis."""
        if self.origin is None:
            return self.low + fraction * (self.high - self.low)
        near, far = self.low - self.origin, self.high - self.origin
        return float(np.clip(self.origin + near * (far / near) ** fraction, self.low, self.high))

    def fraction(self, values: Any) -> Any:
        """Return the fractions of the axis at which ``values`` lie."""
        if self.origin is None:
            return (values - self.low) / (self.high - self.low)
        near, far = self.low - self.origin, self.high - self.origin
        return np.log((values - self.origin) / near) / np.log(far / near)


AXES = {
    "effective_modulus": Axis("effective modulus", "E* [Pa]", "Pa", 1e3, 1e13),
    "width": Axis("width of the asperities", "width [m]", "m", 1e-10, 1.0),
    "work": Axis("work of adhesion", "w [J/m²]", "J m-2", 1e-9, 10.0),
    "exponent": Axis("exponent of the profile", "exponent", "1", 0.51, 200.0, 0.5),
    "tabor": Axis("Tabor number", "Tabor number", "1", 1e-3, 1e3),
    "distance": Axis("distance to the fold over its depth", "distance to fold", "1", 1e-12, 1e3),
    "spread": Axis("decades over which the widths are spread", "spread [decades]", "1", 0.0, 6.0, None),
}
_ASPECT = Axis("rise over width", "aspect", "1", 1e-4, 10.0)


class Case(NamedTuple):
    """An ensemble of power-law asperities, each at a distance from its fold, the first at ``distance``."""

    effective_modulus: float
    width: float
    work: float
    exponent: float
    tabor: float
    distance: float
    spread: float
    aspect: float
    other_distances: tuple[float, ...]

    def shapes(self) -> list[rm.PowerLaw]:
        """Return the asperities."""
        widths = [self.width * 10.0 ** (self.spread * position) for position in _WIDTHS]
        return [rm.PowerLaw(exponent=self.exponent, width=width, rise=self.aspect * width) for width in widths]

    def distances(self) -> tuple[float, ...]:
        """Return the distance of each asperity from its fold, over the depth of the fold."""
        return (self.distance, *self.other_distances)


def design(count: int) -> list[Case]:
    """Return cases that fill the space of all axes evenly, in every leading part of the list too (Sobol's sequence)."""
    fractions = qmc.Sobol(len(AXES) + ASPERITIES, rng=SEED).random(count)
    fractions = np.clip((fractions - _MARGIN) / (1.0 - 2.0 * _MARGIN), 0.0, 1.0)
    axes = [*AXES.values(), _ASPECT, *[AXES["distance"]] * (ASPERITIES - 1)]
    rows = [[axis.at(float(fraction)) for axis, fraction in zip(axes, row, strict=True)] for row in fractions]
    first = len(AXES) + 1
    return [Case._make([*row[:first], tuple(row[first:])]) for row in rows]
