"""One distribution of a quantity: its quantiles, by which it is drawn, its density and its moments."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import cast

import numpy as np

from roughmdr.ensemble.random.distribution_families import Family, find_family, ndtr, ndtri
from roughmdr.ensemble.streams import SMALLEST_UNIFORM
from roughmdr.numerics.arguments import Floats

# Normal scores of the trapezoidal rule that integrates the moments of a truncated distribution.
_SCORES, _SCORE_STEP = np.linspace(-37.0, 37.0, 2369, retstep=True)
_FAR_SCORE, _NEGLIGIBLE = 8.0, 1e-14  # values beyond this score are checked unless negligible in the mean of cubes
_MEAN_ERROR = 1e-9  # error of a mean over the standard deviation: scipy integrates some to no more digits
_DRAW_SCORES = np.arange(-8.0, 9.0)  # normal scores that draws can have
_BROAD = 0.2  # largest change of log(value) per normal score with which a few draws show the spread of forces
_LONG_TAIL = 15.0  # distance of score 8 from the median over that of score 2: 4 where normal, 11 where exponential
_FAR_FRACTION = 1e-15  # fraction beyond which some inverses of scipy are wrong by orders of magnitude, e.g. invgauss


@dataclass(frozen=True)
class Distribution:
    """A distribution of a quantity in SI, or a constant: ``loc``, with ``scale`` 0 and no family."""

    family: str  # name in ``distribution_families``; empty for a constant
    family_parameters: tuple[float, ...]
    loc: float
    scale: float
    min: float = -math.inf  # where it is truncated below
    max: float = math.inf  # where it is truncated above
    location_given: bool = field(default=True, repr=False, compare=False)
    """Whether the user gave the location (for a warning alone); else ``loc`` is 0, as in scipy.stats."""

    @property
    def constant(self) -> float | None:
        """The value of a constant, None for a distribution."""
        return None if self.family else self.loc

    @property
    def mean_off_zero(self) -> bool:
        """Whether its mean before truncation is not 0, though no location was given."""
        if self.location_given:
            return False
        mean, variance = self._family.moments(*self.family_parameters)
        std = math.sqrt(variance) if math.isfinite(variance) else 1.0
        return math.isfinite(mean) and abs(mean) > _MEAN_ERROR * std

    @property
    def truncated(self) -> bool:
        """Whether it is truncated at either end."""
        return math.isfinite(self.min) or math.isfinite(self.max)

    @property
    def _family(self) -> Family:
        return cast(Family, find_family(self.family))  # checked when the distribution was read

    def _untruncated_fractions(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the fractions of the untruncated distribution below and above values."""
        with np.errstate(all="ignore"):
            x = (values - self.loc) / self.scale
            return self._family.cdf(x, *self.family_parameters), self._family.sf(x, *self.family_parameters)

    @cached_property
    def _tails(self) -> tuple[float, float, float]:
        """The fractions of the untruncated distribution below ``min``, above ``max``, and between them."""
        if not self.truncated:
            return 0.0, 0.0, 1.0
        below, above = self._untruncated_fractions(np.array([self.min, self.max]))
        between = above[0] - above[1] if below[0] > 0.5 else below[1] - below[0]
        return float(below[0]), float(above[1]), float(between)

    @property
    def kept_fraction(self) -> float:
        """The fraction of the untruncated distribution between ``min`` and ``max``."""
        return self._tails[2]

    def _at_fractions(self, below: Floats, above: Floats) -> Floats:
        """Return the values with the fraction ``below`` below them and ``above`` = 1 - below above them."""
        # From the smaller one of the untruncated distribution: its inverse near 1 may round to infinity.
        below_min, above_max, between = self._tails
        below, above = below_min + between * below, above_max + between * above
        values = np.empty_like(below)
        upper = above < below
        with np.errstate(all="ignore"):  # overflow is refused when the distribution is read
            values[~upper] = self._family.ppf(below[~upper], *self.family_parameters)
            values[upper] = self._family.isf(above[upper], *self.family_parameters)
            values = values * self.scale + self.loc
        return np.clip(values, self.min, self.max) if self.truncated else values

    def quantile(self, fraction: Floats) -> Floats:
        """Return the values below which the given fractions lie."""
        return self._at_fractions(fraction, 1.0 - fraction) if self.family else np.full_like(fraction, self.loc)

    def between_tails(self, chance: float, count: int) -> Floats:
        """Return ``count`` values, evenly spaced in normal scores, between tails of this chance each.

        No draw lies beyond them if the chance is that of the smallest uniform number, or less.
        """
        if not self.family:
            return np.full(count, self.loc)
        tail = max(chance, SMALLEST_UNIFORM)
        far = ndtri(np.array([tail]))[0]
        below = ndtr(np.linspace(far, -far, count))
        above = below[::-1].copy()
        below[0] = above[-1] = tail
        return self._at_fractions(below, above)

    def from_scores(self, scores: Floats) -> Floats:
        """Return the values at the quantiles of normal scores; NaN so far out that the family's inverse is wrong."""
        if not self.family:
            return np.full_like(scores, self.loc)
        values = self._at_fractions(ndtr(scores), ndtr(-scores))
        far = np.abs(scores) > _FAR_SCORE
        if far.any():
            values[far] = self._checked_values(scores[far], values[far])
        return values

    def _checked_values(self, scores: Floats, values: Floats) -> Floats:
        """Return values far out; NaN, for an inverse that is wrong, where too few lie beyond one.

        That is less than half of the expected fraction, unless the value is negligible in the mean of the cubes.
        """
        below, above = self.fractions(values)
        expected, beyond = ndtr(-np.abs(scores)), np.where(scores > 0.0, above, below)
        near = np.abs(self.from_scores(np.array([-_FAR_SCORE, _FAR_SCORE])) - self.loc).max()
        with np.errstate(all="ignore"):
            negligible = expected * (np.abs(values - self.loc) / near) ** 3 <= _NEGLIGIBLE
        return np.where(negligible | (beyond > 0.5 * expected), values, math.nan)

    def fractions(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the fractions of all draws below values, and above them."""
        below, above = self._untruncated_fractions(values)
        if not self.truncated:
            return below, above
        (below_min, below_max), (above_min, above_max) = self._untruncated_fractions(np.array([self.min, self.max]))
        low = below < above  # differences of the smaller fractions keep their digits
        lower = np.where(low, below - below_min, above_min - above) / self.kept_fraction
        upper = np.where(low, below_max - below, above - above_max) / self.kept_fraction
        return lower.clip(0.0, 1.0), upper.clip(0.0, 1.0)

    def scores(self, values: Floats) -> Floats:
        """Return the normal scores of values, the inverse of ``from_scores``."""
        below, above = self.fractions(values)
        return np.asarray(np.where(below < above, ndtri(below), -ndtri(above)))

    @property
    def relative_to_loc(self) -> "Distribution":
        """The distribution of the differences to ``loc``, which keep their digits however small they are."""
        return replace(self, loc=0.0, min=self.min - self.loc, max=self.max - self.loc)

    def density(self, values: Floats) -> Floats:
        """Return the density at values [1/unit of the quantity]; inf at a pole."""
        scale = self.scale * self.kept_fraction
        with np.errstate(all="ignore"):
            density = self._family.pdf((values - self.loc) / self.scale, *self.family_parameters) / scale
        return np.where((values >= self.min) & (values <= self.max), density, 0.0)

    @property
    def mean(self) -> float:
        """Mean; inf or NaN where the distribution has none."""
        return self._moments[0]

    @property
    def std(self) -> float:
        """Standard deviation; inf or NaN where the distribution has none."""
        return self._moments[1]

    @cached_property
    def _moments(self) -> tuple[float, float]:
        if not self.family:
            return self.loc, 0.0
        if not self.truncated:
            mean, variance = self._family.moments(*self.family_parameters)
            return self.loc + self.scale * mean, self.scale * math.sqrt(variance)
        below, above = ndtr(_SCORES), ndtr(-_SCORES)
        values = self._at_fractions(below, above)
        weights = np.exp(-0.5 * _SCORES**2) * (_SCORE_STEP / math.sqrt(2.0 * math.pi))
        median = float(values[_SCORES.size // 2])
        below_values, above_values = self._untruncated_fractions(values)
        smaller, actual = np.where(above < below, (above, above_values), (below, below_values))
        with np.errstate(all="ignore"):
            wrong = (smaller < _FAR_FRACTION) & ~(np.abs(actual / smaller - 1.0) < 0.5)
            # So far out that no float holds the untruncated fraction, or that the family's inverse is wrong.
            values = np.where(np.isfinite(values) & ~wrong, values, median)
            # Truncated at one end, it may have no moments.
            mean = median + float(weights @ (values - median))
            return mean, math.sqrt(float(weights @ (values - mean) ** 2))

    @cached_property
    def broad(self) -> bool:
        """Whether its values, all above 0, differ by large factors, anywhere more than in a narrow lognormal one."""
        return float(np.max(np.diff(np.log(self.from_scores(_DRAW_SCORES))))) > _BROAD

    @cached_property
    def long_tailed(self) -> bool:
        """Whether its upper tail is longer, relative to its bulk, than an exponential one."""
        median, upper, far = self.from_scores(np.array([0.0, 2.0, _DRAW_SCORES[-1]]))
        return bool(far - median > _LONG_TAIL * (upper - median))

    @cached_property
    def smallest(self) -> float:
        """The smallest value that can be drawn."""
        return float(self.quantile(np.array([SMALLEST_UNIFORM]))[0])

    @cached_property
    def largest(self) -> float:
        """The largest value that can be drawn."""
        return float(self.quantile(np.array([1.0 - SMALLEST_UNIFORM]))[0])
