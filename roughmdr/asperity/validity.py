"""Where a result leaves what its theory supposes: contacts beyond the end of a profile, slopes that are not small."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

STEEP = 0.3
"""The slope at the edge of a contact from which on there is a warning.

Linear elasticity supposes small strains, and a half-space: a contact small beside the radii of the bodies (K. L.
Johnson, Contact Mechanics, 1985, section 4.1). At a/R = 0.3 a sphere and its paraboloid part by 3 % in g.
"""

TABOR = 3.0
"""The Tabor number below which there is a warning: there the pull-off force of a paraboloid is 1 % from that of JKR."""

_LARGEST = float(np.finfo(np.float64).max)  # stands for a flank that is upright


class ValidityLimits(NamedTuple):
    """The most that any contact comes to."""

    slope: float = 0.0
    """f'(a) [1]."""
    extent: float = 0.0
    """a over the radius where the profile ends."""
    tabor: float = math.inf
    """The least Tabor number of contacts that are taken for JKR's."""

    @classmethod
    def of(cls, radius: Floats, slopes: Floats, ends: Floats) -> "ValidityLimits":
        """Of contact radii [m], with the slopes there and the ends [m] of their profiles."""
        if not (radius > 0.0).any():
            return cls()
        with np.errstate(all="ignore"):
            steepest = np.where((radius > 0.0) & ~np.isnan(slopes), slopes, 0.0)
            farthest = np.where(np.isfinite(radius), radius / ends, 0.0)
        return cls(min(float(np.max(steepest)), _LARGEST), min(float(np.max(farthest)), _LARGEST))

    def joined(self, other: "ValidityLimits") -> "ValidityLimits":
        """The more extreme of both."""
        return ValidityLimits(
            max(self.slope, other.slope), max(self.extent, other.extent), min(self.tabor, other.tabor)
        )

    @property
    def warnings(self) -> list[str]:
        """What to tell the user, with the numbers."""
        found = []
        if self.slope > STEEP:
            found.append(
                f"slopes of up to {self.slope:.3g} at the edge of contacts: linear elasticity supposes small slopes "
                f"(warned of above {STEEP:g})"
            )
        if self.extent > 1.0:
            found.append(
                f"contact radii of up to {self.extent:.3g} times the radius where the profile, or the body that it "
                "stands for, ends: what lies beyond is extrapolated"
            )
        if self.tabor < TABOR:
            found.append(
                f"a Tabor number of {self.tabor:.3g}: adhesion reaches further than JKR supposes (warned of below "
                f"{TABOR:g}); adhesion = 'dugdale' has a range"
            )
        return found
