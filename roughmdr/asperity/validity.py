"""Limits of the theory: contacts beyond the end of a profile, slopes that are not small, a small Tabor number."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

STEEP = 0.3
"""The slope at the edge of a contact above which there is a warning.

Linear elasticity supposes small strains, and a half-space: a contact small against the radii of the bodies (K. L.
Johnson, Contact Mechanics, 1985). At a/R = 0.3 a sphere and its paraboloid differ by 3 % in g.
"""

TABOR = 3.0
"""The Tabor number below which there is a warning: there the pull-off force of a paraboloid is 1 % off that of JKR."""

_UPRIGHT = float(np.finfo(np.float64).max)  # slope of a vertical flank


class ValidityLimits(NamedTuple):
    """The extremes over all contacts."""

    slope: float = 0.0  # largest f'(a) [1]
    extent: float = 0.0  # largest a over the radius where the profile ends
    tabor: float = math.inf  # least Tabor number of contacts that are computed with JKR

    @classmethod
    def of(cls, radius: Floats, slopes: Floats, ends: Floats) -> "ValidityLimits":
        """Return the limits of contact radii [m], with the slopes there and the ends [m] of their profiles."""
        if not (radius > 0.0).any():
            return cls()
        with np.errstate(all="ignore"):
            steepest = np.where((radius > 0.0) & ~np.isnan(slopes), slopes, 0.0)
            farthest = np.where(np.isfinite(radius), radius / ends, 0.0)
        return cls(min(float(np.max(steepest)), _UPRIGHT), min(float(np.max(farthest)), _UPRIGHT))

    def joined(self, other: "ValidityLimits") -> "ValidityLimits":
        """Return the more extreme of both."""
        slope, extent = max(self.slope, other.slope), max(self.extent, other.extent)
        return ValidityLimits(slope, extent, min(self.tabor, other.tabor))

    @property
    def warnings(self) -> list[str]:
        """Warnings for the user, with the numbers."""
        texts = []
        if self.slope > STEEP:
            texts.append(
                f"slopes of up to {self.slope:.3g} at the edge of contacts: linear elasticity supposes small slopes "
                f"(warned of above {STEEP:g})"
            )
        if self.extent > 1.0:
            texts.append(
                f"contact radii of up to {self.extent:.3g} times the radius where the profile, or the body that it "
                "stands for, ends: what lies beyond is extrapolated"
            )
        if self.tabor < TABOR:
            texts.append(
                f"a Tabor number of {self.tabor:.3g}: adhesion reaches further than JKR supposes (warned of below "
                f"{TABOR:g}); adhesion = 'dugdale' has a range"
            )
        return texts
