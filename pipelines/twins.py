"""A slow reference: one power-law asperity by the formulas as printed, in the contact radius a, with 60 digits."""

from collections.abc import Callable
from typing import Any

import mpmath

import roughmdr as rm

mp = mpmath.mp.clone()
mp.dps = 60

Real = Any  # mpmath carries no types
PowerShape = rm.Paraboloid | rm.Cone | rm.PowerLaw


def kappa(exponent: float) -> Real:
    """g over f (H 26)."""
    n = mp.mpf(exponent)
    return mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2)


def coefficient_and_exponent(shape: PowerShape) -> tuple[Real, Real]:
    """c and n of f = c r^n."""
    given = {name: mp.mpf(value) for name, value in shape.parameters.items()}
    if "radius" in given:
        return 1 / (2 * given["radius"]), mp.mpf(2)
    if "slope" in given:
        return given["slope"], mp.mpf(1)
    n = given["exponent"]
    return given["coefficient"] if "coefficient" in given else given["rise"] / given["width"] ** n, n


class Twin:
    """f = c r^n pressed into a half-space, without (work = 0) or with JKR adhesion."""

    def __init__(self, shape: PowerShape, effective_modulus: float, work: float) -> None:
        c, self.n = coefficient_and_exponent(shape)
        self.kappa = kappa(self.n)
        self.g_at_1 = self.kappa * c
        self.effective_modulus = mp.mpf(effective_modulus)
        self.work = mp.mpf(work)

    def g(self, a: Real) -> Real:
        """MDR profile [m]."""
        return self.g_at_1 * mp.mpf(a) ** self.n

    def G(self, a: Real) -> Real:
        """Its integral [m2]."""
        return self.g_at_1 * mp.mpf(a) ** (self.n + 1) / (self.n + 1)

    def stretch(self, a: Real) -> Real:
        """dl, at which a spring at a lets go."""
        return mp.sqrt(2 * mp.pi * a * self.work / self.effective_modulus)

    def indentation(self, a: Real) -> Real:
        """delta [m] of equilibrium (H 40)."""
        return self.g(a) - self.stretch(a)

    def force(self, a: Real) -> Real:
        """P [N] (H 41)."""
        return 2 * self.effective_modulus * (a * self.g(a) - self.G(a) - a * self.stretch(a))

    def stiffness(self, a: Real) -> Real:
        """dP/d(delta) [N/m] along the equilibria."""
        slope, dl = self.n * self.g(a) / a, self.stretch(a)
        return 2 * self.effective_modulus * (a * slope - 3 * dl / 2) / (slope - dl / (2 * a))

    def fold(self, control: str) -> Real:
        """The a where a g' is dl/2 (under fixed "indentation") or 3/2 dl (under fixed "force"); 0 without adhesion."""
        multiple = {"indentation": mp.mpf(1) / 2, "force": mp.mpf(3) / 2}[control]
        return (multiple * self.stretch(1) / (self.n * self.g_at_1)) ** (1 / (self.n - mp.mpf(1) / 2))

    def radius(self, control: str, value: float) -> Real:
        """The a of the stable branch at an indentation or a force."""
        law = {"indentation": self.indentation, "force": self.force}[control]
        if self.work == 0:
            power = self.n + (control == "force")
            return (value / law(mp.mpf(1))) ** (1 / power)
        weight: dict[str, Callable[[Real], Real]] = {
            "indentation": lambda a: self.n * self.g(a) - self.stretch(a) / 2,
            "force": lambda a: 2 * self.effective_modulus * a * (self.n * self.g(a) - 3 * self.stretch(a) / 2),
        }
        return _newton(law, weight[control], value, self.fold(control), 1 / self.n)


def _newton(
    law: Callable[[Real], Real], log_slope: Callable[[Real], Real], value: float, fold: Real, step: Real
) -> Real:
    """law(a) = value above the fold. There law is convex in ln a, so Newton from the right never overshoots."""
    a = fold * mp.exp(step)
    while law(a) < value:
        a = a * mp.exp(step)
    for _ in range(500):
        change = (law(a) - value) / log_slope(a)
        a *= mp.exp(-change)
        if abs(change) < mp.mpf(10) ** -45:
            return a
    raise ArithmeticError(f"no root of {value} above {fold}")
