"""One power-law asperity without adhesion or with JKR adhesion, by the formulas as printed, with 60 digits."""

import roughmdr as rm
from oracles.multiprecision import Number, mp

PowerShape = rm.Paraboloid | rm.Cone | rm.PowerLaw


def kappa(exponent: Number) -> Number:
    """Return g/f (H 26)."""
    n = mp.mpf(exponent)
    return mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2)


def coefficient_and_exponent(shape: PowerShape) -> tuple[Number, Number]:
    """Return c and n of f = c r^n."""
    given = {name: mp.mpf(value) for name, value in shape.parameters.items()}
    if "radius" in given:
        return 1 / (2 * given["radius"]), mp.mpf(2)
    if "slope" in given:
        return given["slope"], mp.mpf(1)
    n = given["exponent"]
    return given["coefficient"] if "coefficient" in given else given["rise"] / given["width"] ** n, n


class JkrPowerLaw:
    """f = c r^n pressed into a half-space, without (work = 0) or with JKR adhesion."""

    def __init__(self, shape: PowerShape, effective_modulus: float, work: float) -> None:
        c, self.n = coefficient_and_exponent(shape)
        self.kappa = kappa(self.n)
        self.g_at_1 = self.kappa * c
        self.effective_modulus = mp.mpf(effective_modulus)
        self.work = mp.mpf(work)

    def g(self, a: Number) -> Number:
        """Return the MDR profile [m]."""
        return self.g_at_1 * mp.mpf(a) ** self.n

    def reduced_load(self, a: Number) -> Number:
        """Return a g(a) - G(a) [m2], G the integral of g from 0."""
        return self.n / (self.n + 1) * a * self.g(a)

    def release_stretch(self, a: Number) -> Number:
        """Return dl(a) [m], the stretch at which a spring at ``a`` detaches (H 44)."""
        return mp.sqrt(2 * mp.pi * a * self.work / self.effective_modulus)

    def indentation(self, a: Number) -> Number:
        """Return delta [m] in equilibrium (H 40)."""
        return self.g(a) - self.release_stretch(a)

    def force(self, a: Number) -> Number:
        """Return P [N] in equilibrium (H 41)."""
        return 2 * self.effective_modulus * (self.reduced_load(a) - a * self.release_stretch(a))

    def under(self, control: str, a: Number) -> Number:
        """Return the indentation or the force."""
        return self.force(a) if control == "force" else self.indentation(a)

    def stiffness(self, a: Number) -> Number:
        """Return dP/d(delta) [N/m] along the equilibria."""
        slope, dl = self.n * self.g(a) / a, self.release_stretch(a)
        return 2 * self.effective_modulus * (a * slope - 3 * dl / 2) / (slope - dl / (2 * a))

    def fold(self, control: str) -> Number:
        """Return the a where a g' is dl/2 (under a given "indentation") or 3/2 dl ("force"); 0 without adhesion."""
        multiple = mp.mpf(3 if control == "force" else 1) / 2
        return (multiple * self.release_stretch(1) / (self.n * self.g_at_1)) ** (1 / (self.n - mp.mpf(1) / 2))

    def radius(self, control: str, value: Number) -> Number:
        """Return the a of the stable branch at an indentation or a force."""
        if self.work == 0:
            return (value / self.under(control, mp.mpf(1))) ** (1 / (self.n + (control == "force")))
        return self._newton(control, value)

    def _newton(self, control: str, value: Number) -> Number:
        """Above the fold the control is convex in ln a, so that Newton's method from the right never overshoots."""
        fold = self.fold(control)
        a = fold * mp.exp(1 / self.n)
        while self.under(control, a) < value:
            a = a * mp.exp(1 / self.n)
        for _ in range(500):
            slope = self.n * self.g(a) - (3 if control == "force" else 1) * self.release_stretch(a) / 2
            slope *= 2 * self.effective_modulus * a if control == "force" else 1  # by ln a
            change = (self.under(control, a) - value) / slope
            a *= mp.exp(-change)
            if abs(change) < mp.mpf(10) ** -45:
                return a
        raise ArithmeticError(f"no root of {value} above {fold}")
