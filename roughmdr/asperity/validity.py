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
"""The Tabor number below which there is a warning.

There the pull-off force of a paraboloid is 1 % off that of JKR, and that of a flat punch, as it is or with a rounded
edge, 5 %; it is 1 % off at 7.
"""

_SLOPE_DIVISOR = 3.0  # g of a sphere is that of its paraboloid times 1 + (x/R)^2/3 + ...
_VERTICAL = 10.0  # slope from which on a flank counts as vertical
_UPRIGHT = float(np.finfo(np.float64).max)  # slope of a vertical flank


def relative_loads(radius: Floats, slopes: Floats) -> Floats:
    """Return a^2 f'(a) [1] of contact radii [m] and the slopes there, which is about proportional to their forces."""
    loads = np.minimum(slopes, _VERTICAL)
    loads[np.isnan(loads)] = 0.0
    relative = radius / np.max(radius)
    loads *= np.square(relative, out=relative)
    return loads


class ValidityLimits(NamedTuple):
    """The extremes over all contacts."""

    slope: float = 0.0  # largest f'(a) [1]
    extent: float = 0.0  # largest a over the radius where the profile ends
    tabor: float = math.inf  # least Tabor number of contacts that are computed with JKR
    slope_error: float = 0.0  # relative error of the force by slopes that are not small
    end_error: float = 0.0  # share of the force that contacts beyond the end of their profile bear

    @classmethod
    def of(cls, radius: Floats, slopes: Floats, ends: Floats) -> "ValidityLimits":
        """Return the limits of contact radii [m], with the slopes there and the ends [m] of their profiles.

        A contact bears a share of the force as ``relative_loads`` has it.
        """
        if not (radius > 0.0).any():
            return cls()
        with np.errstate(all="ignore"):
            steepest = np.where((radius > 0.0) & ~np.isnan(slopes), slopes, 0.0)
            farthest = np.where(np.isfinite(radius), radius / ends, 0.0)
            loads = relative_loads(radius, steepest)
            slope, extent = min(float(np.max(steepest)), _UPRIGHT), min(float(np.max(farthest)), _UPRIGHT)
            total = float(np.sum(loads)) or 1.0
            beyond = float(np.sum(loads[farthest > 1.0])) if extent > 1.0 else 0.0
            loads *= np.minimum(np.square(steepest, out=steepest) / _SLOPE_DIVISOR, 1.0)
        return cls(slope, extent, slope_error=float(np.sum(loads)) / total, end_error=beyond / total)

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
