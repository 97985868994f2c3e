"""One asperity with JKR adhesion, unloaded from deep contact to its fold: every method for its curve."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from oracles.jkr import Asperity
from oracles.multiprecision import mp
from oracles.profiles import profile_of
from scipy.optimize import brentq, minimize_scalar

import roughmdr as rm
from roughmdr.kernels.adhesion import release_stretch
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.springs import Springs
from studies.work_precision.points import Curve, Method, Reference, each_setting

MODULUS, WORK = 4e6, 0.05  # a soft rubber against a rigid body [Pa], [J/m^2]
DEPTHS = np.append(np.geomspace(1e-3, 1.0, 20), np.geomspace(1.0, 11.0, 181)[1:])  # above the fold, over its depth
DIGITS = 70
_DEEPEST = 50.0  # radius beyond the deepest contact, over that at the fold
_MIN_RTOL = 1e-15  # about the least relative tolerance that brentq takes
_MATERIAL: Any = {"effective_modulus": MODULUS, "work": WORK}
Formula = Callable[[Floats], Floats]


class Tip(NamedTuple):
    """A shape with f', g, g' and ∫ x g' dx as printed in the paper."""

    shape: Shape
    slope: Formula
    g: Formula
    dg: Formula
    reduced_load: Formula

    @property
    def fold(self) -> float:
        """Radius [m] of pull-off under fixed grips."""
        return float(rm.pull_off(self.shape, **_MATERIAL, control="displacement").contact_radius)

    @property
    def indentation(self) -> Floats:
        """The path [m]."""
        return -float(rm.pull_off(self.shape, **_MATERIAL, control="displacement").indentation) * (DEPTHS - 1.0)


def _paraboloid(R: float) -> Tip:
    return Tip(
        rm.Paraboloid(R), lambda r: r / R, lambda x: x * x / R, lambda x: 2 * x / R, lambda x: 2 * x**3 / (3 * R)
    )


def _rounded_cone(slope: float, blend: float) -> Tip:
    """Return the closed forms beyond ``blend``, which with q = 0 hold below it too."""

    def q(x: Floats) -> Floats:
        return np.sqrt(np.maximum(x * x - blend * blend, 0.0))

    def angle(x: Floats) -> Floats:
        return np.arccos(np.minimum(blend / x, 1.0))

    def g(x: Floats) -> Floats:
        return slope * x * ((x - q(x)) / blend + angle(x))

    def integral(x: Floats) -> Floats:
        cubes = (x**3 - q(x) ** 3) / (3.0 * blend)
        return slope * (cubes + 0.5 * (x * x * angle(x) - blend * q(x)))

    return Tip(
        rm.RoundedCone(slope, blend),
        lambda r: slope * np.minimum(r / blend, 1.0),
        g,
        lambda x: slope * (2.0 * (x - q(x)) / blend + angle(x)),
        lambda x: x * g(x) - integral(x),
    )


TIPS = {"paraboloid, JKR": _paraboloid(50e-6), "rounded cone, JKR": _rounded_cone(0.17, 8.3e-6)}


def stretch(a: Floats) -> Floats:
    """Return dl(a) [m]."""
    return np.asarray(np.sqrt(2.0 * math.pi * WORK / MODULUS * a))


def load(reduced_load: Formula, a: Floats) -> Floats:
    """Return P(a) [N] under JKR."""
    return 2.0 * MODULUS * (reduced_load(a) - a * stretch(a))


def reference(tip: Tip, *, quick: bool) -> Reference:
    """Compute by quadrature of f' alone with ``DIGITS`` digits."""
    steps = list(range(0, DEPTHS.size, 50 if quick else 20))
    with mp.workdps(DIGITS):
        profile = profile_of(tip.shape.name, dict(tip.shape.parameters))
        asperity = Asperity(profile, MODULUS, WORK, tip.shape.nondimensional()[0])
        branches = asperity.branches("indentation")
        states = [asperity.solve(branches, "indentation", delta) for delta in tip.indentation[steps].tolist()]
        force = np.array([float(state["force"]) for state in states if state])
        area = np.array([float(mp.pi * state["contact_radius"] ** 2) for state in states if state])
        pull_off = float(asperity.branches("force")[-1].value)
    return Reference(steps, force, steps, area, pull_off)


def by_package(tip: Tip, shape: Shape) -> Curve:
    """Compute by the package, for a shape."""
    state = rm.indent(shape, **_MATERIAL, indentation=tip.indentation)
    off = rm.pull_off(shape, **_MATERIAL, control="force")
    return Curve(state.force.to_numpy(), state.contact_area.to_numpy(), DEPTHS.size + 1, float(off.force))


def by_springs(tip: Tip, count: int) -> Curve:
    """Compute by a row of springs for each indentation, and by one under dead load."""
    state = rm.indent(tip.shape, **_MATERIAL, indentation=tip.indentation, method="springs", springs=count)
    pull_off = Springs.of(tip.shape, MODULUS, WORK, count).pull_off_force()
    return Curve(state.force.to_numpy(), state.contact_area.to_numpy(), (DEPTHS.size + 1) * count, pull_off)


def by_root_finder(tip: Tip, g: Formula, reduced_load: Formula, tolerance: float, weight: int = 1) -> Curve:
    """Compute by scipy's brentq and minimiser; each g and each reduced load count ``weight`` evaluations."""

    def excess(a: float, delta: float) -> float:
        return float(g(np.array([a]))[0]) - release_stretch(a, MODULUS, WORK) - delta

    def tension(a: float) -> float:
        return float(load(reduced_load, np.array([a]))[0])

    fold = tip.fold
    # xtol is a length: its default, 2e-12 m, leaves 2e-8 of such contacts
    xtol = tolerance * fold
    given: Any = {"xtol": xtol, "rtol": max(tolerance, _MIN_RTOL), "full_output": True}
    roots = [brentq(excess, fold, _DEEPEST * fold, args=(delta,), **given) for delta in tip.indentation.tolist()]
    radii, calls = np.array([root for root, _ in roots]), [found.function_calls for _, found in roots]
    lowest = minimize_scalar(tension, bounds=(fold, 8.0 * fold), method="bounded", options={"xatol": xtol})
    evaluations = weight * (sum(calls) + lowest.nfev + radii.size)
    return Curve(load(reduced_load, radii), math.pi * radii**2, evaluations, float(lowest.fun))


def by_vectors(tip: Tip, newton_steps: int) -> Curve:
    """Compute by Newton's method on ln a for all indentations at once, from beyond the deepest; the least P."""
    a = np.full(DEPTHS.size, _DEEPEST * tip.fold)
    for _ in range(newton_steps):
        excess = tip.g(a) - stretch(a) - tip.indentation
        a = a * np.exp(-excess / (a * tip.dg(a) - 0.5 * stretch(a)))
    return Curve(load(tip.reduced_load, a), math.pi * a * a, (newton_steps + 1) * a.size)


def by_quadrature(tip: Tip, nodes: float) -> Callable[[], Curve]:
    """Prepare g and ∫ x g' dx by Gauss's rule on f' over the angle, in brentq."""
    x, weights = np.polynomial.legendre.leggauss(int(nodes))
    sine, weights = np.sin(0.25 * math.pi * (1.0 + x)), 0.25 * math.pi * weights

    def g(a: Floats) -> Floats:
        return np.asarray(a * (tip.slope(a[:, None] * sine) @ weights))

    def reduced_load(a: Floats) -> Floats:
        return np.asarray(a * a * (tip.slope(a[:, None] * sine) @ (weights * sine**2)))

    return partial(by_root_finder, tip, g, reduced_load, 1e-14, int(nodes))


def by_table(tip: Tip, points: float) -> Callable[[], Curve]:
    """Prepare the profile as a table, to 1.5 times the largest contact radius."""
    farthest = rm.indent(tip.shape, **_MATERIAL, indentation=float(tip.indentation[-1]))
    r = np.linspace(0.0, 1.5 * float(farthest.contact_radius), int(points))
    return partial(by_package, tip, rm.Tabulated(r, tip.shape.f(r)))


_SPRINGS, _NODES = (10, 30, 100, 300, 1e3, 3e3, 1e4, 3e4, 1e5), (2, 3, 4, 6, 8, 12, 16, 32, 64, 128)
_TOLERANCES, _STEPS = tuple(10.0**-k for k in range(1, 15)), tuple(range(2, 16))
METHODS = (
    Method("closed forms", "-", each_setting((1.0,), lambda tip, _: partial(by_package, tip, tip.shape))),
    Method("table", "points", each_setting((5, 10, 20, 40, 80, 160, 320), by_table)),
    Method("springs", "springs", each_setting(_SPRINGS, lambda tip, n: partial(by_springs, tip, int(n)))),
    Method("Abel quadrature", "nodes", each_setting(_NODES, by_quadrature)),
    Method("brentq", "tolerance", each_setting(
        _TOLERANCES, lambda tip, limit: partial(by_root_finder, tip, tip.g, tip.reduced_load, limit)
    )),
    Method("plain NumPy", "Newton steps", each_setting(_STEPS, lambda tip, n: partial(by_vectors, tip, int(n)))),
)  # fmt: skip
