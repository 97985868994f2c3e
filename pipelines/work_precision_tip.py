"""One asperity with JKR adhesion, drawn back from deep contact to its fold: every way to its curve."""

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from mpmath import mp, mpf
from scipy.optimize import brentq, minimize_scalar
from work_precision_points import Curve, Method, Point, Reference, timed

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.springs import Springs

MODULUS, WORK = 4e6, 0.05  # of a soft rubber against a rigid body [Pa], [J/m^2]
DEPTHS = np.append(np.geomspace(1e-3, 1.0, 20), np.geomspace(1.0, 11.0, 181)[1:])  # above the fold, over its depth
DIGITS = 20
_FAR = 50.0  # times the contact radius at the fold: beyond the deepest contact
_FINEST = 1e-15  # about the least relative tolerance that brentq takes

Formula = Callable[[Floats], Floats]


class Tip(NamedTuple):
    """A shape, and what its reader would write of it: f', g, g' and ∫ x g' dx, straight from the paper."""

    shape: Shape
    slope: Formula
    kink: float
    """The radius [m] at which f' has one; 0 for none."""
    g: Formula
    dg: Formula
    push: Formula

    @property
    def fold(self) -> tuple[float, float]:
        """Radius [m] and depth [m] at which fixed grips lose it."""
        off = rm.pull_off(self.shape, effective_modulus=MODULUS, work=WORK)
        return float(off.contact_radius), -float(off.indentation)

    @property
    def indentation(self) -> Floats:
        """The path [m]."""
        return self.fold[1] * (DEPTHS - 1.0)


def _paraboloid(radius: float) -> Tip:
    return Tip(
        rm.Paraboloid(radius),
        lambda r: r / radius,
        0.0,
        lambda x: x * x / radius,
        lambda x: 2.0 * x / radius,
        lambda x: 2.0 * x**3 / (3.0 * radius),
    )


def _rounded_cone(slope: float, blend: float) -> Tip:
    """The closed forms are those beyond ``blend``, which with q = 0 hold below it too."""

    def q(x: Floats) -> Floats:
        return np.sqrt(np.maximum(x * x - blend * blend, 0.0))

    def angle(x: Floats) -> Floats:
        return np.arccos(np.minimum(blend / x, 1.0))

    def g(x: Floats) -> Floats:
        return slope * x * ((x - q(x)) / blend + angle(x))

    def swept(x: Floats) -> Floats:
        cubes = (x**3 - q(x) ** 3) / (3.0 * blend)
        return slope * (cubes + 0.5 * (x * x * angle(x) - blend * q(x)))

    return Tip(
        rm.RoundedCone(slope, blend),
        lambda r: slope * np.minimum(r / blend, 1.0),
        blend,
        g,
        lambda x: slope * (2.0 * (x - q(x)) / blend + angle(x)),
        lambda x: x * g(x) - swept(x),
    )


TIPS = {"paraboloid, JKR": _paraboloid(50e-6), "rounded cone, JKR": _rounded_cone(0.17, 8.3e-6)}


def stretch(a: Floats) -> Floats:
    """dl(a) [m]."""
    return np.asarray(np.sqrt(2.0 * math.pi * WORK / MODULUS * a))


def load(push: Formula, a: Floats) -> Floats:
    """P(a) [N] under JKR."""
    return 2.0 * MODULUS * (push(a) - a * stretch(a))


def reference(tip: Tip, *, quick: bool) -> Reference:
    """By quadrature of f' alone with ``DIGITS`` digits."""
    steps = list(range(0, DEPTHS.size, 50 if quick else 20))
    found = rm.indent(tip.shape, effective_modulus=MODULUS, work=WORK, indentation=tip.indentation[steps])
    loosest = rm.pull_off(tip.shape, effective_modulus=MODULUS, work=WORK, control="force")
    with mp.workdps(DIGITS):
        precise = _Precise(tip)
        radii = [
            mp.findroot(lambda a, delta=delta: precise.indentation(a) - mpf(delta), mpf(start))
            for delta, start in zip(tip.indentation[steps].tolist(), found.contact_radius.to_numpy(), strict=True)
        ]
        lowest = mp.findroot(lambda a: mp.diff(precise.force, a), mpf(float(loosest.contact_radius)), tol=1e-15)
        force = np.array([float(precise.force(a)) for a in radii])
        area = np.array([float(mp.pi * a * a) for a in radii])
        return Reference(steps, force, steps, area, float(precise.force(lowest)))


class _Precise:
    """g and ∫ x g' dx as integrals over the angle, r = a sin(phi)."""

    def __init__(self, tip: Tip) -> None:
        self._tip = tip

    def _integral(self, a: mpf, weight: Callable[[mpf], mpf]) -> mpf:
        """Of f' times a weight."""
        kink = mpf(self._tip.kink)
        corners = [0, mp.asin(kink / a), mp.pi / 2] if 0 < kink < a else [0, mp.pi / 2]
        density = partial(self._density, a, weight)
        return mp.quad(density, corners, method="gauss-legendre")

    def _density(self, a: mpf, weight: Callable[[mpf], mpf], phi: mpf) -> mpf:
        return self._tip.slope(a * mp.sin(phi)) * weight(phi)

    def indentation(self, a: mpf) -> mpf:
        """delta(a) [m]."""
        return a * self._integral(a, lambda phi: mpf(1)) - mp.sqrt(2 * mp.pi * a * mpf(WORK) / mpf(MODULUS))

    def force(self, a: mpf) -> mpf:
        """P(a) [N]."""
        push = a * a * self._integral(a, lambda phi: mp.sin(phi) ** 2)
        return 2 * mpf(MODULUS) * (push - a * mp.sqrt(2 * mp.pi * a * mpf(WORK) / mpf(MODULUS)))


def by_package(tip: Tip, shape: Shape) -> Curve:
    """The states that the package finds for a shape."""
    state = rm.indent(shape, effective_modulus=MODULUS, work=WORK, indentation=tip.indentation)
    off = rm.pull_off(shape, effective_modulus=MODULUS, work=WORK, control="force")
    return Curve(state.force.to_numpy(), state.contact_area.to_numpy(), float(off.force), DEPTHS.size + 1)


def as_table(tip: Tip, points: int) -> Shape:
    """The same profile as a table of so many points, as far as the contact reaches and a half."""
    farthest = rm.indent(tip.shape, effective_modulus=MODULUS, work=WORK, indentation=float(tip.indentation[-1]))
    r = np.linspace(0.0, 1.5 * float(farthest.contact_radius), points)
    return rm.Tabulated(r, tip.shape.f(r))


def by_springs(tip: Tip, count: int) -> Curve:
    """A row of springs for each indentation, and one under dead load."""
    state = rm.indent(
        tip.shape, effective_modulus=MODULUS, work=WORK, indentation=tip.indentation, method="springs", springs=count
    )
    row = Springs.of(tip.shape, MODULUS, WORK, count)
    evaluations = (DEPTHS.size + 1) * count
    return Curve(state.force.to_numpy(), state.contact_area.to_numpy(), row.pull_off_force(), evaluations)


def by_root_finder(tip: Tip, g: Formula, push: Formula, tolerance: float, weight: int = 1) -> Curve:
    """scipy's brentq for each indentation, and its minimiser for the pull-off; each g or push counts ``weight``."""
    fold, _ = tip.fold
    count = 0

    def excess(a: float, delta: float) -> float:
        nonlocal count
        count += weight
        return float(g(np.array([a]))[0] - stretch(np.array([a]))[0]) - delta

    def tension(a: float) -> float:
        nonlocal count
        count += weight
        return float(load(push, np.array([a]))[0])

    # xtol is a length: its default, 2e-12 m, leaves 2e-8 of such contacts
    near, finest = tolerance * fold, max(tolerance, _FINEST)
    radii = np.array(
        [brentq(excess, fold, _FAR * fold, args=(d,), xtol=near, rtol=finest) for d in tip.indentation.tolist()]
    )
    force = load(push, radii)
    lowest = minimize_scalar(tension, bounds=(fold, 8.0 * fold), method="bounded", options={"xatol": tolerance * fold})
    return Curve(force, math.pi * radii**2, float(lowest.fun), count + weight * radii.size)


def by_vectors(tip: Tip, passes: int) -> Curve:
    """So many steps of Newton's method on ln a for all indentations at once, from beyond the deepest; least P."""
    fold, _ = tip.fold
    a = np.full(DEPTHS.size, _FAR * fold)
    for _ in range(passes):
        excess = tip.g(a) - stretch(a) - tip.indentation
        a = a * np.exp(-excess / (a * tip.dg(a) - 0.5 * stretch(a)))
    force = load(tip.push, a)
    return Curve(force, math.pi * a * a, float(force.min()), (passes + 1) * a.size)


def _each(
    settings: tuple[float, ...], way: Callable[[Tip, float], Callable[[], Curve]]
) -> Callable[[Tip, Reference, bool], Iterator[Point]]:
    """A point for each setting, of the curve that ``way`` makes ready; every other setting where it is to be quick."""

    def points(tip: Tip, exact: Reference, quick: bool) -> Iterator[Point]:
        way(tip, settings[0])()  # compiled before the clock runs
        for setting in settings[:: 2 if quick else 1]:
            curve, seconds = timed(way(tip, setting), 1 if quick else 3)
            yield Point(setting, exact.errors(curve), seconds, curve.evaluations)

    return points


def _quadrature(tip: Tip, nodes: float) -> Callable[[], Curve]:
    """g and ∫ x g' dx by Gauss's rule on f' over the angle, in brentq."""
    x, weights = np.polynomial.legendre.leggauss(int(nodes))
    sine, weights = np.sin(0.25 * math.pi * (1.0 + x)), 0.25 * math.pi * weights

    def g(a: Floats) -> Floats:
        return np.asarray(a * (tip.slope(a[:, None] * sine) @ weights))

    def push(a: Floats) -> Floats:
        return np.asarray(a * a * (tip.slope(a[:, None] * sine) @ (weights * sine**2)))

    return partial(by_root_finder, tip, g, push, 1e-14, int(nodes))


METHODS = (
    Method("closed forms", "-", _each((1.0,), lambda tip, _: partial(by_package, tip, tip.shape))),
    Method(
        "table",
        "points",
        _each((5, 10, 20, 40, 80, 160, 320), lambda tip, n: partial(by_package, tip, as_table(tip, int(n)))),
    ),
    Method(
        "springs",
        "springs",
        _each((10, 30, 100, 300, 1e3, 3e3, 1e4, 3e4, 1e5), lambda tip, n: partial(by_springs, tip, int(n))),
    ),
    Method("Abel quadrature", "nodes", _each((2, 3, 4, 6, 8, 12, 16, 32, 64, 128), _quadrature)),
    Method(
        "brentq",
        "tolerance",
        _each(
            tuple(10.0**-k for k in range(1, 15)), lambda tip, rtol: partial(by_root_finder, tip, tip.g, tip.push, rtol)
        ),
    ),
    Method(
        "plain NumPy",
        "Newton steps",
        _each(tuple(range(2, 16)), lambda tip, n: partial(by_vectors, tip, int(n))),
    ),
)
