"""The cases of ``stability.py``: ensembles of power laws, and where they stand on the axes."""

from typing import Any, NamedTuple

import numpy as np
from scipy.stats import qmc

import roughmdr as rm

SEED = 20260
SIZE = 3  # asperities in a case
_PLACES = (0.0, -0.5, 0.5)  # of their widths within the spread, in decades
_ENDS = 0.04  # of the cases stand at each end of an axis


class Axis(NamedTuple):
    """What is varied, between two ends: in decades of its distance to ``origin``, or evenly where that is None."""

    long_name: str
    units: str
    low: float
    high: float
    origin: float | None = 0.0

    def place(self, part: float) -> float:
        """Of the way from one end to the other."""
        if self.origin is None:
            return self.low + part * (self.high - self.low)
        near, far = self.low - self.origin, self.high - self.origin
        return float(np.clip(self.origin + near * (far / near) ** part, self.low, self.high))

    def part(self, values: Any) -> Any:
        """The way to ``values``, from 0 to 1."""
        if self.origin is None:
            return (values - self.low) / (self.high - self.low)
        near, far = self.low - self.origin, self.high - self.origin
        return np.log((values - self.origin) / near) / np.log(far / near)


AXES = {
    "stiffness": Axis("effective modulus", "Pa", 1e3, 1e13),
    "scale": Axis("width of the asperities", "m", 1e-10, 1.0),
    "work": Axis("work of adhesion", "J m-2", 1e-9, 10.0),
    "exponent": Axis("exponent of the profile", "1", 0.51, 200.0, 0.5),
    "tabor": Axis("Tabor number", "1", 1e-3, 1e3),
    "distance": Axis("distance to the fold over its depth", "1", 1e-12, 1e3),
    "spread": Axis("decades that the widths spread over", "1", 0.0, 6.0, None),
}
_ASPECT = Axis("rise over width", "1", 1e-4, 10.0)


class Case(NamedTuple):
    """An ensemble of power-law asperities with adhesion, each at a distance to its fold, the first at ``distance``."""

    stiffness: float
    scale: float
    work: float
    exponent: float
    tabor: float
    distance: float
    spread: float
    aspect: float
    others: tuple[float, ...]

    def shapes(self) -> list[rm.PowerLaw]:
        """The asperities."""
        widths = [self.scale * 10.0 ** (self.spread * place) for place in _PLACES]
        return [rm.PowerLaw(exponent=self.exponent, width=width, rise=self.aspect * width) for width in widths]

    def distances(self) -> tuple[float, ...]:
        """Of each asperity."""
        return (self.distance, *self.others)


def design(count: int) -> list[Case]:
    """Cases that fill the space of all axes evenly, the first of them too (Sobol)."""
    places = qmc.Sobol(len(AXES) + SIZE, rng=SEED).random(count)
    places = np.clip((places - _ENDS) / (1.0 - 2.0 * _ENDS), 0.0, 1.0)
    ways = [*AXES.values(), _ASPECT, *[AXES["distance"]] * (SIZE - 1)]
    rows = [[way.place(float(part)) for way, part in zip(ways, row, strict=True)] for row in places]
    first = len(AXES) + 1
    return [Case(**dict(zip(Case._fields, row[:first], strict=False)), others=tuple(row[first:])) for row in rows]
