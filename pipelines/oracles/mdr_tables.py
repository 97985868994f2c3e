"""MDR tables with any number of digits: g by Hermite's basis, G by a Gauss rule that is exact for it."""

from itertools import pairwise

from oracles.multiprecision import Number, mp
from oracles.profiles import Floats, Profile


class MdrTableProfile(Profile):
    """g at rising radii [m], between them the monotone cubic in a^2 of F. N. Fritsch and J. Butland (1984)."""

    def __init__(self, a: Floats, g: Floats) -> None:
        super().__init__([])
        self.s = [mp.mpf(0), *(mp.mpf(each) ** 2 for each in a.tolist())]
        self.g = [mp.mpf(0), *map(mp.mpf, g.tolist())]
        self.slopes = _slopes(self.s, self.g)

    @property
    def kinks(self) -> list[Number]:
        """Radii at which a piece ends [m]."""
        return [mp.sqrt(s) for s in self.s[1:]]

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """Return g(a) [m], g'(a) [1] and G(a) [m2]."""
        ends = [mp.mpf(0), *(b for b in self.kinks if b < a), a]
        nodes = [(mp.mpf(x) + 1, mp.mpf(w)) for x, w in _gauss()]
        G = mp.fsum(
            (high - low) / 2 * w * self._value_and_slope(low + (high - low) / 2 * x)[0]
            for low, high in pairwise(ends)
            for x, w in nodes
        )
        g, slope = self._value_and_slope(a)
        return g, 2 * a * slope, G

    def _value_and_slope(self, a: Number) -> tuple[Number, Number]:
        """Return g and dg/da^2."""
        s = a * a
        if s >= self.s[-1]:
            return self.g[-1] + self.slopes[-1] * (s - self.s[-1]), self.slopes[-1]
        k = max(i for i, begin in enumerate(self.s) if begin <= s)
        h, rise = self.s[k + 1] - self.s[k], self.g[k + 1] - self.g[k]
        u, left, right = (s - self.s[k]) / h, self.slopes[k], self.slopes[k + 1]
        blend = u * u * (3 - 2 * u)
        value = self.g[k] + rise * blend + h * (left * u * (1 - u) ** 2 - right * u * u * (1 - u))
        slope = 6 * u * (1 - u) * rise / h + left * (1 - u) * (1 - 3 * u) + right * u * (3 * u - 2)
        return value, slope


def _gauss() -> list[tuple[Number, Number]]:
    """Return five nodes and weights on -1 to 1."""
    near, far = (mp.sqrt(5 + sign * 2 * mp.sqrt(mp.mpf(10) / 7)) / 3 for sign in (-1, 1))
    heavy, light = ((322 + sign * 13 * mp.sqrt(mp.mpf(70))) / 900 for sign in (1, -1))
    return [
        (mp.mpf(0), mp.mpf(128) / 225),
        *((sign * x, w) for x, w in ((near, heavy), (far, light)) for sign in (-1, 1)),
    ]


def _slopes(s: list[Number], g: list[Number]) -> list[Number]:
    """Return dg/ds at each point: weighted harmonic means, at the ends those of a parabola, kept from the chord."""
    h = [b - a for a, b in pairwise(s)]
    chord = [(b - a) / each for (a, b), each in zip(pairwise(g), h, strict=True)]
    if len(h) == 1:
        return [chord[0], chord[0]]
    inner = [
        3 * (a + b) / ((a + 2 * b) / left + (2 * a + b) / right)
        for (a, b), (left, right) in zip(pairwise(h), pairwise(chord), strict=True)
    ]
    ends = []
    for one, two, first, second in ((h[0], h[1], chord[0], chord[1]), (h[-1], h[-2], chord[-1], chord[-2])):
        parabola = ((2 * one + two) * first - one * second) / (one + two)
        ends.append(min(max(parabola, first / 2), 2 * first))
    return [ends[0], *inner, ends[1]]
