"""Which asperities the reference tables of adhesion of finite range are of: nanometres to millimetres, soft to hard."""

from typing import NamedTuple

import numpy as np
from oracles.dugdale import Cohesion
from oracles.multiprecision import mp
from oracles.profiles import Parameters, Profile, profile_of

_UNEVEN = (0.0, 0.11, 0.2, 0.37, 0.45, 0.7, 0.81, 1.0, 1.3, 1.45, 1.8, 2.4)
_CONICAL = tuple(x * x if x < 0.5 else x - 0.25 for x in _UNEVEN)
_FLAT = (0.0, 0.3, 0.62, 1.0, 1.2, 1.5, 1.9, 2.3, 3.0)
_EDGE = tuple(0.5 * max(x - 1.0, 0.0) ** 2 for x in _FLAT)


def few(number: float) -> float:
    """Return ``number`` to four digits."""
    return float(f"{number:.4g}")


def table(width: float, rise: float, r: tuple[float, ...], f: tuple[float, ...]) -> Parameters:
    """Return the parameters of a table, stretched."""
    return {"r": [few(width * x) for x in r], "f": [few(rise * y) for y in f]}


class Case(NamedTuple):
    """One asperity and the Tabor numbers that it is wanted at.

    Radii are asked for up to ``most`` sizes, and folds are sought up to ``reach`` sizes.
    """

    shape: str
    parameters: Parameters
    effective_modulus: float
    work: float
    tabors: tuple[float, ...]
    most: float = 20.0
    reach: float = 100.0

    @property
    def profile(self) -> Profile:
        """Return the slope of the profile."""
        return profile_of(self.shape, self.parameters)

    def size(self) -> float:
        """Return the contact radius [m] of JKR's pull-off under fixed grips, roughly."""
        if self.shape == "flat_punch":
            return float(self.parameters["radius"])
        profile = self.profile
        least = max(float(profile.flat), 1e-12)
        a = np.geomspace(least, 1e-1 if profile.end is None else 0.5 * float(profile.end), 4000)
        g = Cohesion(profile, self.effective_modulus, self.work, 1.0, 0).integrals(a, a, 1.5 * a).g
        return float(a[np.argmin(g - np.sqrt(2.0 * np.pi * a * self.work / self.effective_modulus))])

    def strengths(self) -> list[float]:
        """Return the strengths [Pa] of the Tabor numbers."""
        stretch = float(np.sqrt(2.0 * np.pi * self.size() * self.work / self.effective_modulus))
        return [few(tabor * float(mp.pi) ** (2 / 3) * self.work / stretch) for tabor in self.tabors]


FOUR, THREE = (0.03, 0.3, 3.0, 30.0), (0.1, 1.0, 8.0)

CASES = [
    Case("paraboloid", {"radius": 3e-8}, 8e10, 0.6, (0.05, 0.5, 5.0)),
    Case("paraboloid", {"radius": 0.02}, 5e5, 0.05, THREE),
    Case("cone", {"slope": 0.2}, 3e6, 0.05, FOUR),
    Case("power_law", {"exponent": 0.7, "width": 2e-6, "rise": 3e-8}, 2e8, 0.08, THREE, 300.0, 1e4),
    Case("power_law", {"exponent": 1.5, "width": 4e-9, "rise": 1e-9}, 8e10, 1.2, THREE),
    Case("power_law", {"exponent": 3.2, "width": 3e-5, "rise": 2e-5}, 1e6, 0.03, FOUR),
    Case("power_law", {"exponent": 8.0, "width": 1e-3, "rise": 3e-4}, 5e9, 0.2, THREE, 3.0, 5.0),
    Case("flat_punch", {"radius": 2.5e-7}, 7e10, 0.8, FOUR),
    Case("flat_punch", {"radius": 4e-4}, 2e6, 0.03, (0.8, 1.3)),
    Case("sphere", {"radius": 3.5e-5}, 2e6, 0.04, FOUR, 6.0, 10.0),
    Case("truncated_cone", {"slope": 0.3, "flat_radius": 2e-7}, 1e7, 0.1, FOUR),
    Case("truncated_cone", {"slope": 0.12, "flat_radius": 2e-7}, 1e7, 0.1, THREE),
    Case("truncated_paraboloid", {"radius": 5e-5, "flat_radius": 3e-6}, 4e6, 0.05, FOUR),
    Case("rounded_cone", {"slope": 0.25, "blend_radius": 4e-8}, 5e9, 0.5, THREE),
    Case("rounded_cone", {"slope": 0.25, "blend_radius": 4e-8}, 1e8, 0.5, FOUR),
    Case("capped_paraboloid", {"radius": 1e-6, "cap_radius": 2e-5, "blend_radius": 2e-7}, 1e9, 0.2, FOUR),
    Case("capped_paraboloid", {"radius": 1e-6, "cap_radius": 2e-6, "blend_radius": 2e-7}, 5e7, 0.2, THREE),
    Case("capped_paraboloid", {"radius": 1.331e-5, "cap_radius": 1.725e-5, "blend_radius": 2e-7}, 1e9, 0.2, (7.9,)),
    Case("rounded_punch", {"flat_radius": 1e-4, "edge_radius": 2e-4}, 1e6, 0.03, FOUR),
    Case("rounded_punch", {"flat_radius": 1e-5, "edge_radius": 1e-7}, 1e9, 0.05, (1.2, 5.5, 25.0), 2.0, 4.0),
    Case("rounded_punch", {"flat_radius": 3e-9, "edge_radius": 6e-12}, 2e11, 1.5, (4.0, 60.0), 2.0, 4.0),
    Case("power_series", {"terms": {"2.0": 2e5, "4.0": 1e17}}, 2e9, 0.05, FOUR),
    Case("power_series", {"terms": {"1.0": 0.05, "2.0": 5e4}}, 4e7, 0.06, THREE),
    Case("tabulated", table(3e-6, 4e-7, _UNEVEN, _CONICAL), 1e7, 0.04, (0.1, 2.0), 4.0),
    Case("tabulated", table(5e-8, 1e-8, _FLAT, _EDGE), 1e9, 0.5, THREE, 4.0),
]
