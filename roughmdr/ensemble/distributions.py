"""Distributions, sampled through their inverse, so that draws can be shared and compared."""

import math
from dataclasses import dataclass

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.ensemble.draws import SMALLEST_UNIFORM
from roughmdr.ensemble.families import Family, find_family


@dataclass(frozen=True)
class Distribution:
    """A distribution of a quantity in SI, or a constant: ``loc``, with ``scale`` 0 and no family."""

    family: str
    """Name in scipy.stats; empty for a constant."""
    own: tuple[float, ...]
    """The family's own shape parameters."""
    loc: float
    scale: float

    @property
    def constant(self) -> float | None:
        """The value, where every draw has the same."""
        return None if self.family else self.loc

    @property
    def _standard(self) -> Family:
        family = find_family(self.family)
        if family is None:
            raise AssertionError("checked when the distribution was read")
        return family

    def quantile(self, uniform: Floats) -> Floats:
        """The values below which the given fractions lie."""
        if not self.family:
            return np.full_like(uniform, self.loc)
        # From the nearer tail: 1 - u is exact, and the inverse near 1 may round to infinity.
        values = np.empty_like(uniform)
        upper = uniform > 0.5
        with np.errstate(all="ignore"):  # what overflows is refused when the distribution is read
            values[~upper] = self._standard.lower(uniform[~upper], *self.own)
            values[upper] = self._standard.upper(1.0 - uniform[upper], *self.own)
            return values * self.scale + self.loc

    @property
    def std(self) -> float:
        """Standard deviation; inf or NaN where the distribution has none."""
        return self.scale * math.sqrt(self._standard.moments(*self.own)[1]) if self.family else 0.0

    @property
    def least(self) -> float:
        """The lowest value that can be drawn."""
        return float(self.quantile(np.array([SMALLEST_UNIFORM]))[0])

    @property
    def greatest(self) -> float:
        """The greatest value that can be drawn."""
        return float(self.quantile(np.array([1.0 - SMALLEST_UNIFORM]))[0])
