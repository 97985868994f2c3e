"""One elastic-plastic asperity under a rigid flat, slowly: integrals by quadrature, roots and folds by search.

``Contact`` sums the springs of the method of dimensionality reduction under the profile of Zunker and Kamrin
(J. Mech. Phys. Solids 183 (2024) 105492 and 105493). ``fitted`` has fits to finite elements: first loading by Jackson
and Green (J. Tribol. 127 (2005) 343) or Kogut and Etsion (J. Appl. Mech. 69 (2002) 657), unloading by Etsion, Kligerman
and Kadin (Int. J. Solids Struct. 42 (2005) 3716). Lengths are in m, forces in N, energies in J.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

from oracles.multiprecision import Number, mp, root

WORKING = 100
"""Digits carried: a minimum is found to half of them, and 30 are wanted."""
State = tuple[Number, Number, Number]
"""Force, contact radius, and stored elastic and surface energy."""


class Springs(NamedTuple):
    """Springs of a half-space under a profile g(x) as far as ``widest``, which let go at l(a) = sqrt(2 pi a w/E*)."""

    g: Callable[[Number], Number]
    widest: Number
    modulus: Number
    work: Number

    def indentation(self, a: Number) -> Number:
        """Return g(a) - l(a), the indentation at which the springs at ``a`` let go."""
        return self.g(a) - mp.sqrt(2 * mp.pi * a * self.work / self.modulus)

    def fold(self) -> Number:
        """Return the radius at which contact is lost, where the indentation is least, by golden sections."""
        low, high, part = mp.mpf(0), self.widest, (mp.sqrt(5) - 1) / 2
        while self.work and high - low > self.widest * mp.mpf(10) ** -45:
            left, right = high - part * (high - low), low + part * (high - low)
            low, high = (low, right) if self.indentation(left) < self.indentation(right) else (left, high)
        return low

    def state(self, indentation: Number) -> State:
        """Return the stable state at an indentation; all 0 out of contact. Springs lie at x = widest sin(phi)."""
        a, fold = self.widest, self.fold()
        least, most = self.indentation(fold), self.indentation(a)
        if indentation <= least:
            return mp.mpf(0), mp.mpf(0), mp.mpf(0)
        if indentation < most:
            scale = most - least
            a *= root(lambda x: (self.indentation(x * self.widest) - indentation) / scale, fold / a, mp.mpf(1))
        over, end = self.widest, mp.asin(a / self.widest)

        def pressed(phi: Number, power: int) -> Number:
            return (indentation - self.g(over * mp.sin(phi))) ** power * over * mp.cos(phi)

        first, second = (mp.quad(partial(pressed, power=n), [0, end], method="gauss-legendre") for n in (1, 2))
        return 2 * self.modulus * first, a, self.modulus * second - mp.pi * self.work * a * a


@dataclass(frozen=True)
class Contact:
    """A sphere or paraboloid, its modulus E* and yield stress [Pa], and work of adhesion [J/m2].

    With Poisson's ratio the asperity is a whole sphere, whose centre the flat approaches; else it is on a half-space.
    """

    radius: float
    modulus: float
    yield_stress: float
    work: float = 0.0
    shape: str = "sphere"
    poisson: float | None = None

    def pressure(self, d: Number) -> Number:
        """Return the mean pressure pY [Pa] of plastic flow at the largest indentation ``d``."""
        return self.yield_stress * (1 + mp.mpf("1.75") * mp.exp(-mp.mpf("4.4") * d / self.radius))

    @cached_property
    def onset(self) -> Number:
        """The indentation dY at which the mean pressure of Hertz is pY."""
        with mp.workdps(WORKING):
            E, R = mp.mpf(self.modulus), mp.mpf(self.radius)
            return R * mp.exp(root(
                lambda y: 4 * E * mp.exp(y / 2) / (3 * mp.pi * self.pressure(R * mp.exp(y))) - 1, mp.mpf(-90), mp.mpf(9)
            ))  # fmt: skip

    @cached_property
    def start(self) -> Number:
        """The indentation d* at which the mean pressure of JKR is pY; the onset without adhesion."""

        def excess(d: Number) -> Number:
            force, a, _ = self.elastic(d)
            return force / (mp.pi * a * a * self.pressure(d)) - 1

        with mp.workdps(WORKING):
            one = two = self.onset
            while self.work and excess(two) < 0:
                one, two = two, 2 * two
            return two if one == two else root(excess, one, two)

    def elastic(self, d: Number) -> State:
        """Return the state of Hertz or JKR at an indentation ``d`` without yield."""
        R, E, w = (mp.mpf(x) for x in (self.radius, self.modulus, self.work))
        widest = 2 * (mp.sqrt(R * abs(d)) + mp.cbrt(2 * mp.pi * R * R * w / E))
        return Springs(lambda x: x * x / R, widest, E, w).state(d)

    def flow(self, d: Number) -> tuple[Number, Number]:
        """Return the largest contact radius and the force of plastic flow at ``d``."""
        R, y = mp.mpf(self.radius), self.start
        square = self.elastic(y)[1] ** 2 if self.work else y * R
        area = mp.pi * (square + 2 * (d - y) * R + (y * y - d * d if self.shape == "sphere" else 0))
        return mp.sqrt(area / mp.pi), area * self.pressure(d)

    def springs(self, d: Number) -> tuple[Springs, Number, Number]:
        """Return the springs under the ellipse that plastic flow leaves at ``d``, A/2, and s [1]."""
        R, E, w = (mp.mpf(x) for x in (self.radius, self.modulus, self.work))
        a, force = self.flow(d)
        half, s = 2 * self.pressure(d) * a / E, mp.mpf(1)
        if self.poisson is not None:
            nu, z = mp.mpf(self.poisson), R - d + half
            G, S = E * (1 - nu) / 2, mp.sqrt(a * a + z * z)
            s += force * (2 * a * a * (nu - 1) - (2 * nu - 1) * z * (S - z)) / (2 * mp.pi * a * a * G * S) / half
        return Springs(lambda x: half * (1 - mp.sqrt(max(1 - (x / a) ** 2, 0))), a, E, w), half, s

    def state(self, d: float, u: float) -> State:
        """Return the state at a rise ``u`` above the largest indentation ``d``; all 0 once contact is lost."""
        with mp.workdps(WORKING):
            if d <= self.start:
                return self.elastic(mp.mpf(d) - mp.mpf(u))
            springs, half, s = self.springs(mp.mpf(d))
            force, a, stored = springs.state(half - mp.mpf(u) / s)
            return force, a, s * stored

    def ends(self, d: float) -> tuple[Number, Number]:
        """Return the rises above ``d`` > d* at which contact is made again, and at which it is lost."""
        with mp.workdps(WORKING):
            springs, half, s = self.springs(mp.mpf(d))
            return s * half, s * (half - springs.indentation(springs.fold()))

    def lost(self, d: float) -> Number:
        """Return the energy that plastic flow has taken up to ``d`` > d*."""
        with mp.workdps(WORKING):
            flow = mp.quad(lambda x: self.flow(x)[1], [self.start, mp.mpf(d)])
            return self.elastic(self.start)[2] + flow - self.state(d, 0.0)[2]


def fitted(model: str, d: float, u: float, material: tuple[float, float, float, float]) -> State:
    """Return force, contact radius and residual indentation of a sphere at a rise ``u`` above ``d``.

    The material is radius, E*, yield stress and Poisson's ratio, and ``model`` "jackson-green" or "kogut-etsion".
    """
    R, E, Y, nu = (mp.mpf(x) for x in material)
    green = model == "jackson-green"
    C = mp.mpf("2.8") * (mp.mpf("0.454") + mp.mpf("0.41") * nu)
    C = mp.mpf("1.295") * mp.exp(mp.mpf("0.736") * nu) if green else C
    critical = (mp.pi * C * Y / (2 * E)) ** 2 * R
    unit, w = 4 * E * mp.sqrt(R * critical) * critical / 3, d / critical
    if w <= mp.mpf("1.9" if green else "1"):
        x = max(mp.mpf(d) - u, 0) / critical
        return unit * x * mp.sqrt(x), mp.sqrt(R * critical * x), mp.mpf(0)
    if green:
        area = w * (w / mp.mpf("1.9")) ** (mp.mpf("0.14") * mp.exp(23 * Y / E))
        hardness = mp.mpf("2.84") * (1 - mp.exp(-mp.mpf("0.82") * (critical * area / R) ** mp.mpf("-0.35")))  # H_G/Y
        force = mp.exp(-(w ** (mp.mpf(5) / 12)) / 4) * w * mp.sqrt(w)
        force += 4 * hardness / C * (1 - mp.exp(-(w ** (mp.mpf(5) / 9)) / 25)) * w
    elif w <= 110:
        c, n, b, m = ("1.03", "1.425", "0.93", "1.136") if w <= 6 else ("1.40", "1.263", "0.94", "1.146")
        force, area = mp.mpf(c) * w ** mp.mpf(n), mp.mpf(b) * w ** mp.mpf(m)
    else:  # fully plastic: 2.8 Y on 2 pi R d
        force, area = mp.mpf("8.4") / C * w, 2 * w
    left = d * (1 - w ** mp.mpf("-0.28")) * (1 - w ** mp.mpf("-0.69"))
    part = max((mp.mpf(d) - u - left) / (d - left), 0)
    force *= unit * part ** (mp.mpf("1.5") * w ** mp.mpf("-0.0331"))
    return force, mp.sqrt(R * critical * area * part ** (w ** mp.mpf("-0.12"))), left
