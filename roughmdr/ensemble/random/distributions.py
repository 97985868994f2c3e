"""Distributions, sampled through their inverse, so that draws can be shared and compared."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from roughmdr.ensemble.random.families import Family, find_family
from roughmdr.ensemble.streams import SMALLEST_UNIFORM
from roughmdr.numerics.arguments import Floats

# Fractions below which and above which values lie, by normal scores: over these a rule of equal steps finds moments.
_SCORES, _SCORE_STEP = np.linspace(-37.0, 37.0, 2369, retstep=True)
_FAR_SCORE, _UNFELT = 8.0, 1e-14  # beyond so many normal scores values are checked if a mean cube feels that of them
_CENTRED = 1e-9  # of the standard deviation: scipy integrates some means to no more digits
_ENDS = np.arange(-8.0, 9.0)  # normal scores, as far as draws reach
_SPREAD_OF_LOGS = 0.2  # up to it the spread of forces is known from few draws
_LONG = 15.0  # times the two scores of a normal distribution: that is 4 of itself, 12 of an exponential one
_FAR_OUT = 1e-15  # fractions beyond which some inverses of scipy are wrong by many orders, as that of invgauss


@dataclass(frozen=True)
class Distribution:
    """A distribution of a quantity in SI, or a constant: ``loc``, with ``scale`` 0 and no family."""

    family: str
    """Name in scipy.stats; empty for a constant."""
    own: tuple[float, ...]
    """The family's own shape parameters."""
    loc: float
    scale: float
    min: float = -math.inf
    """Where it is cut off below."""
    max: float = math.inf
    """Where it is cut off above."""
    placed: bool = field(default=True, repr=False, compare=False)  # it changes no number
    """Whether whoever asked for it said where it lies; else ``loc`` is 0, as in scipy.stats."""

    @property
    def constant(self) -> float | None:
        """The value, where every draw has the same."""
        return None if self.family else self.loc

    @property
    def off_centre(self) -> bool:
        """Whether its mean, before any cut, is another than 0 though nobody said where it lies."""
        if self.placed:
            return False
        mean, variance = self._standard.moments(*self.own)
        spread = math.sqrt(variance) if math.isfinite(variance) else 1.0
        return math.isfinite(mean) and abs(mean) > _CENTRED * spread

    @property
    def cut(self) -> bool:
        """Whether it is cut off at either end."""
        return math.isfinite(self.min) or math.isfinite(self.max)

    @property
    def _standard(self) -> Family:
        family = find_family(self.family)
        if family is None:
            raise AssertionError("checked when the distribution was read")
        return family

    def _fractions(self, values: Floats) -> tuple[Floats, Floats]:
        """The fractions of the uncut distribution below and above values."""
        with np.errstate(all="ignore"):
            reduced = (values - self.loc) / self.scale
            return self._standard.below(reduced, *self.own), self._standard.above(reduced, *self.own)

    @cached_property
    def _tails(self) -> tuple[float, float, float]:
        """The fractions of the uncut distribution below ``min`` and above ``max``, and what is left between them."""
        if not self.cut:
            return 0.0, 0.0, 1.0
        below, above = self._fractions(np.array([self.min, self.max]))
        left = above[0] - above[1] if below[0] > 0.5 else below[1] - below[0]
        return float(below[0]), float(above[1]), float(left)

    @property
    def share(self) -> float:
        """The part of the uncut distribution that lies between ``min`` and ``max``."""
        return self._tails[2]

    def _between(self, lower: Floats, upper: Floats) -> Floats:
        """The values below which the fractions ``lower`` and above which ``upper`` = 1 - lower lie.

        From the nearer tail of the uncut distribution: its inverse near 1 may round to infinity.
        """
        below, above, left = self._tails
        lower, upper = below + left * lower, above + left * upper
        values = np.empty_like(lower)
        far = upper < lower
        with np.errstate(all="ignore"):  # what overflows is refused when the distribution is read
            values[~far] = self._standard.lower(lower[~far], *self.own)
            values[far] = self._standard.upper(upper[far], *self.own)
            values = values * self.scale + self.loc
        return np.clip(values, self.min, self.max) if self.cut else values

    def quantile(self, uniform: Floats) -> Floats:
        """The values below which the given fractions lie."""
        return self._between(uniform, 1.0 - uniform) if self.family else np.full_like(uniform, self.loc)

    def of_scores(self, scores: Floats) -> Floats:
        """The values that lie as high in the distribution as ``scores`` do in the standard normal one.

        NaN so far out that the inverse of the family leads to values that are much too far.
        """
        from scipy.special import ndtr

        if not self.family:
            return np.full_like(scores, self.loc)
        values = self._between(ndtr(scores), ndtr(-scores))
        far = np.abs(scores) > _FAR_SCORE
        if far.any():
            values[far] = self._trusted(scores[far], values[far])
        return values

    def _trusted(self, scores: Floats, values: Floats) -> Floats:
        """Values far out, NaN where too few lie beyond them and they would be felt in a mean all the same."""
        from scipy.special import ndtr

        below, above = self.fractions(values)
        share, beyond = ndtr(-np.abs(scores)), np.where(scores > 0.0, above, below)
        near = np.abs(self.of_scores(np.array([-_FAR_SCORE, _FAR_SCORE])) - self.loc).max()
        with np.errstate(all="ignore"):
            felt = ~(share * (np.abs(values - self.loc) / near) ** 3 <= _UNFELT)
        return np.where(felt & ~(beyond > 0.5 * share), math.nan, values)

    def fractions(self, values: Floats) -> tuple[Floats, Floats]:
        """The fractions of all draws below values, and above them."""
        below, above = self._fractions(values)
        if not self.cut:
            return below, above
        (below_min, below_max), (above_min, above_max) = self._fractions(np.array([self.min, self.max]))
        low = below < above  # differences of the nearer tail keep their digits
        lower = np.where(low, below - below_min, above_min - above) / self.share
        upper = np.where(low, below_max - below, above - above_max) / self.share
        return lower.clip(0.0, 1.0), upper.clip(0.0, 1.0)

    def scores(self, values: Floats) -> Floats:
        """The standard normal scores of values; the inverse of ``of_scores``."""
        from scipy.special import ndtri

        lower, upper = self.fractions(values)
        return np.asarray(np.where(lower < upper, ndtri(lower), -ndtri(upper)))

    @property
    def from_loc(self) -> "Distribution":
        """The distribution of the differences to ``loc``, which keep their digits however near to it they are."""
        return replace(self, loc=0.0, min=self.min - self.loc, max=self.max - self.loc)

    def density(self, values: Floats) -> Floats:
        """The density at values, over the unit of the quantity; 0 where there is none, inf where it has a pole."""
        with np.errstate(all="ignore"):
            density = self._standard.density((values - self.loc) / self.scale, *self.own) / (self.scale * self.share)
        return np.where((values >= self.min) & (values <= self.max), density, 0.0)

    @cached_property
    def _moments(self) -> tuple[float, float]:
        """Mean and standard deviation where it is cut."""
        from scipy.special import ndtr

        lower, upper = ndtr(_SCORES), ndtr(-_SCORES)
        values = self._between(lower, upper)
        weights = np.exp(-0.5 * _SCORES**2) * (_SCORE_STEP / math.sqrt(2.0 * math.pi))
        middle = float(values[_SCORES.size // 2])
        below, above = self._fractions(values)
        near, back = np.where(upper < lower, (upper, above), (lower, below))
        with np.errstate(all="ignore"):
            lost = (near < _FAR_OUT) & ~(np.abs(back / near - 1.0) < 0.5)
        # So far out that no fraction is left of the uncut one, or that the family's inverse does not lead there.
        values = np.where(np.isfinite(values) & ~lost, values, middle)
        with np.errstate(all="ignore"):  # a cut at one end may leave no moments
            mean = middle + float(weights @ (values - middle))
            return mean, math.sqrt(float(weights @ (values - mean) ** 2))

    @property
    def mean(self) -> float:
        """Mean; inf or NaN where the distribution has none."""
        if not self.family:
            return self.loc
        return self._moments[0] if self.cut else self.loc + self.scale * self._standard.moments(*self.own)[0]

    @property
    def std(self) -> float:
        """Standard deviation; inf or NaN where the distribution has none."""
        if not self.family:
            return 0.0
        return self._moments[1] if self.cut else self.scale * math.sqrt(self._standard.moments(*self.own)[1])

    @cached_property
    def many_sized(self) -> bool:
        """Whether its values, all above 0, are of many sizes: anywhere more so than those of a narrow lognormal one."""
        return bool(self.family) and float(np.max(np.diff(np.log(self.of_scores(_ENDS))))) > _SPREAD_OF_LOGS

    @cached_property
    def long_tailed(self) -> bool:
        """Whether its upper tail is longer, beside what is usual, than an exponential one."""
        if not self.family:
            return False
        middle, upper, far = self.of_scores(np.array([0.0, 2.0, _ENDS[-1]]))
        return bool(far - middle > _LONG * (upper - middle))

    @property
    def least(self) -> float:
        """The lowest value that can be drawn."""
        return float(self.quantile(np.array([SMALLEST_UNIFORM]))[0])

    @property
    def greatest(self) -> float:
        """The greatest value that can be drawn."""
        return float(self.quantile(np.array([1.0 - SMALLEST_UNIFORM]))[0])
