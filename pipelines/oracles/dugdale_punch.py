"""A flat punch with adhesion of finite range: all its contacts have c = b, and a > 0 until the springs' edges meet."""

from oracles.dugdale import Dugdale, State
from oracles.multiprecision import Number, mp, root


class Punch(Dugdale):
    """Radius b [m] on a half-space of ``effective_modulus`` [Pa], ``work`` [J/m2], ``strength`` [Pa]."""

    def __init__(self, radius: Number, effective_modulus: Number, work: Number, strength: Number) -> None:
        super().__init__(mp.mpf(effective_modulus), mp.mpf(work), mp.mpf(strength), mp.pi)
        self.b = mp.mpf(radius)

    def state(self, delta: Number) -> State:
        """Return the state at an indentation [m], stable while in contact."""
        b, always = self.b, mp.mpf(1)
        k = 2 * self.effective_modulus * b
        if delta >= 0:
            return State(b, b, delta, k * delta, k, always, always)
        m = min(b, -delta / self.beta)
        a = mp.sqrt((b - m) * (b + m))
        force = -2 * self.strength * (a * m + b * b * mp.acos(a / b))
        return State(a, b, delta, force, 2 * self.effective_modulus * a, always, mp.sign(a))

    def pull_off(self, control: str) -> State:
        """Return the state where gap(b) reaches the range of the adhesion.

        Under dead load a lifted punch detaches where it lifts: farther out the force stays the same.
        """
        b, unit = self.b, 2 * self.beta * self.strength / (mp.pi * self.work)

        def gap(m: Number) -> Number:
            a = mp.sqrt((b - m) * (b + m))
            return unit * (m * mp.acos(a / b) - b + a) - 1

        if gap(b) > 0:
            return self.state(-self.beta * root(gap, b * mp.mpf("1e-9"), b))
        return self.state(-self.beta * b if control == "force" else -2 * self.beta * b / mp.pi - self.range)

    def energy(self, state: State) -> Number:
        """Return U [J], its integrals done by hand."""
        a, b, beta = state.a, self.b, self.beta
        around = beta**2 * (2 * b**3 - 3 * b * b * a + a**3) / 3  # ∫ u1^2 from a to b
        area = (b * b * mp.acos(a / b) - a * mp.sqrt((b - a) * (b + a))) / 2  # ∫ sqrt(b^2 - x^2) from a to b
        elastic = a * state.delta**2 - around - 2 * beta * state.delta * area
        return self.effective_modulus * elastic - mp.pi * self.work * b * b
