"""One power-law asperity without adhesion or with JKR adhesion, whose folds have closed forms, with 60 digits."""

import roughmdr as rm
from oracles.jkr import Asperity
from oracles.multiprecision import Number, mp
from oracles.profiles import closed_profile

PowerShape = rm.Paraboloid | rm.Cone | rm.PowerLaw


def kappa(exponent: Number) -> Number:
    """Return g/f (H 26)."""
    n = mp.mpf(exponent)
    return mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2)


class JkrPowerLaw(Asperity):
    """f = c r^n pressed into a half-space, without (work = 0) or with JKR adhesion."""

    def __init__(self, shape: PowerShape, effective_modulus: float, work: float) -> None:
        super().__init__(closed_profile(shape), effective_modulus, work, 1.0)
        ((slope_at_1, power),) = self.profile.pieces[0].terms
        self.n = mp.mpf(power) + 1
        self.kappa = kappa(self.n)
        self.g_at_1 = self.kappa / self.n * slope_at_1

    def g(self, a: Number) -> Number:
        """Return the MDR profile [m]."""
        return self.g_at_1 * mp.mpf(a) ** self.n

    def reduced_load(self, a: Number) -> Number:
        """Return a g(a) - G(a) [m2], G the integral of g from 0."""
        return self.n / (self.n + 1) * a * self.g(a)

    def indentation(self, a: Number) -> Number:
        """Return delta [m] in equilibrium (H 40)."""
        return self.g(a) - self.dl(a)

    def force(self, a: Number) -> Number:
        """Return P [N] in equilibrium (H 41)."""
        return 2 * self.effective_modulus * (self.reduced_load(a) - a * self.dl(a))

    def under(self, control: str, a: Number) -> Number:
        """Return the indentation or the force."""
        return self.force(a) if control == "force" else self.indentation(a)

    def fold(self, control: str) -> Number:
        """Return the a where a g' is dl/2 (under a given "indentation") or 3/2 dl ("force"); 0 without adhesion."""
        multiple = mp.mpf(3 if control == "force" else 1) / 2
        return (multiple * self.dl(1) / (self.n * self.g_at_1)) ** (1 / (self.n - mp.mpf(1) / 2))

    def radius(self, control: str, value: Number) -> Number:
        """Return the a of the stable branch at an indentation or a force.

        Above the fold the control is convex in ln a, so that Newton's method from the right never overshoots.
        """
        dead_load = control == "force"
        if self.work == 0:
            return (value / self.under(control, mp.mpf(1))) ** (1 / (self.n + dead_load))
        fold = self.fold(control)
        a = fold * mp.exp(1 / self.n)
        while self.under(control, a) < value:
            a = a * mp.exp(1 / self.n)
        for _ in range(500):
            slope = self.n * self.g(a) - (3 if dead_load else 1) * self.dl(a) / 2
            slope *= 2 * self.effective_modulus * a if dead_load else 1  # by ln a
            change = (self.under(control, a) - value) / slope
            a *= mp.exp(-change)
            if abs(change) < mp.mpf(10) ** -45:
                return a
        raise ArithmeticError(f"no root of {value} above {fold}")
