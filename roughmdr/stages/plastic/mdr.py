"""Elastic and perfectly plastic spheres by the method of dimensionality reduction, with adhesion.

W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492. Once its mean pressure is
p_Y = Y (1 + 1.75 e^(-4.4 d/R)), a contact yields: at the deepest indentation d it has the radius b,
b^2 = 2 R d - d^2 + c/pi, and bears pi b^2 p_Y. Below d it is elastic, with a dent whose one-dimensional profile is an
ellipse, g(x) = H (1 - sqrt(1 - x^2/b^2)) with H = 2 p_Y b/E*, on which the full contact bears a uniform pressure. With
a = b sin(phi) all follows in closed form. Adhesion is that of M. Hess (2012), equation 44: springs at the edge let go
at l(a) = sqrt(2 pi a w/E*).

On first loading a contact follows Hertz, or JKR where it adheres, until its mean pressure is p_Y. There c makes b its
radius; so force and radius have no jump, and adhesion that vanishes leaves the dry contact.
"""

import math

import numpy as np

from roughmdr.kernels.closed import jkr_paraboloid as jkr
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss
from roughmdr.numerics.jit import njit, once
from roughmdr.stages.plastic.body import (
    BEFORE,
    DEPTH,
    LIMIT,
    NO_MARK,
    PULL,
    RADIUS,
    SQUARE,
    STIFFNESS_AT_TIP,
    TIP,
    Body,
    Mark,
    PlasticKernels,
    State,
    elastic,
)

_RISE, _DECAY = 1.75, 4.4  # mean pressure of yielding, Y (1 + _RISE e^(-_DECAY d/R)): Zunker and Kamrin, from elements
_NODES, _WEIGHTS = gauss(16)
_ITERATIONS = 200  # most steps of a search: that for a contact next to its loss halves its error in each
_RTOL = 4e-16  # relative change of a root at which a search ends


@njit
def yield_pressure(deepest: float, asperity: Floats, body: Body) -> float:
    """p_Y [Pa] at the deepest indentation."""
    return float(body.yield_strength * (1.0 + _RISE * math.exp(-_DECAY * deepest / asperity[RADIUS])))


@njit
def _area_over_pi(deepest: float, asperity: Floats, body: Body) -> float:
    """b^2 [m2] of a contact that yields; that of a sphere stays as it is once half of it is pressed flat."""
    radius, limit = asperity[RADIUS], asperity[LIMIT]
    d = min(deepest, radius) if body.squared > 0.0 else deepest
    return float(asperity[SQUARE] + (d - limit) * (2.0 * radius - body.squared * (d + limit)))


@njit
def _yielding_force(deepest: float, asperity: Floats, body: Body) -> float:
    """pi b^2 p_Y [N]."""
    return math.pi * _area_over_pi(deepest, asperity, body) * yield_pressure(deepest, asperity, body)


@njit
def _reduced_radius(stretch: float, steep: float) -> float:
    """t = a/R where a contact yields: steep (t - 3/2 stretch/sqrt(t)) = 1 + _RISE e^(-_DECAY d/R).

    The left is the mean pressure over Y of a paraboloid with d/R = t^2 - stretch sqrt(t), stretch^2 = 2 pi w/(E* R) and
    steep = 4 E*/(3 pi Y). Newton's method, halved where a step leaves the interval that holds the root.
    """
    loadless = float(np.cbrt(2.25 * stretch * stretch))  # t at no load
    low, high = max(1.0 / steep, loadless), (1.0 + _RISE) / steep + loadless
    t = low
    for _ in range(_ITERATIONS):
        root = math.sqrt(t)
        fall = _RISE * math.exp(-_DECAY * (t * t - stretch * root))
        excess = steep * (t - 1.5 * stretch / root) - 1.0 - fall
        low, high = (low, t) if excess > 0.0 else (t, high)
        slope = steep * (1.0 + 0.75 * stretch / (t * root)) + _DECAY * (2.0 * t - 0.5 * stretch / root) * fall
        new = t - excess / slope
        new = new if low <= new <= high else 0.5 * (low + high)
        if abs(new - t) <= _RTOL * t:
            break
        t = new
    return t


@njit
def prepare(asperity: Floats, body: Body) -> None:
    """Fill the row of an asperity behind its radius: where it yields, and the scales of its JKR contact."""
    radius, modulus = asperity[RADIUS], body.effective_modulus
    if body.work > 0.0:
        depth, tip, pull, stiffness = jkr.scales(modulus, body.work, radius, 0.5 * radius, 2.0)
        asperity[DEPTH], asperity[TIP], asperity[PULL], asperity[STIFFNESS_AT_TIP] = depth[0], tip, pull, stiffness
    stretch = math.sqrt(2.0 * math.pi * body.work / (modulus * radius))
    t = _reduced_radius(stretch, 4.0 * modulus / (3.0 * math.pi * body.yield_strength))
    asperity[LIMIT], asperity[SQUARE] = radius * (t * t - stretch * math.sqrt(t)), (radius * t) * (radius * t)
    asperity[BEFORE] = elastic(asperity[LIMIT], asperity, body).stored


@njit
def mark(deepest: float, asperity: Floats, body: Body) -> Mark:
    """b [m], H [m], and the rise of the flat over that of the springs of the dent [1]; no mark before yielding.

    That is 1 on a half-space. Of a sphere of its own the flat approaches the centre, which is compressed as well.
    """
    if deepest <= asperity[LIMIT]:
        return NO_MARK
    pressure, square = yield_pressure(deepest, asperity, body), _area_over_pi(deepest, asperity, body)
    b = math.sqrt(square)
    height = 2.0 * pressure * b / body.effective_modulus
    if body.shear_modulus == math.inf:
        return Mark(b, height, 1.0)
    z = max(asperity[RADIUS] - deepest, 0.0) + height
    s = math.sqrt(square + z * z)
    sinking = 2.0 * square * (body.poisson - 1.0) - (2.0 * body.poisson - 1.0) * z * (square / (s + z))
    return Mark(b, height, 1.0 + pressure * sinking / (2.0 * body.shear_modulus * s) / height)


@njit
def _stretch(mark: Mark, body: Body) -> float:
    """l(b)/H [1]."""
    return math.sqrt(2.0 * math.pi * mark.first * body.work / body.effective_modulus) / mark.second


@njit
def _sine_at_loss(stretch: float) -> float:
    """sin(phi) where the springs of a dent are about to be lost: s^3 + q^2 s^2 = q^2, q = stretch/2.

    There d(g - l)/da = 0. Newton's method from above, where the polynomial is convex.
    """
    square = 0.25 * stretch * stretch
    s = min(float(np.cbrt(square)), 1.0)
    for _ in range(_ITERATIONS):
        step = (s * s * (s + square) - square) / (s * (3.0 * s + 2.0 * square))
        if not step > _RTOL * s:
            break
        s -= step
    return s


@njit
def ends(deepest: float, mark: Mark, asperity: Floats, body: Body) -> tuple[float, float]:
    """Rises of the flat [m] at which contact is made again, and lost; deepest > 0."""
    if mark.first == 0.0:
        return deepest, deepest + (asperity[DEPTH] if body.work > 0.0 else 0.0)
    made = mark.second * mark.third
    if body.work == 0.0:
        return made, made
    stretch = _stretch(mark, body)
    s = _sine_at_loss(stretch)
    cosine = min(2.0 * s * math.sqrt(s) / stretch, 1.0)
    return made, made * (1.0 - (s * s / (1.0 + cosine) - stretch * math.sqrt(s)))


@njit
def _tension(x: float, stretch: float) -> float:
    """l(a)/H = y of an adhesive dent whose springs at the edge are about to let go, x below 1 - stretch.

    With 1 - cos(phi) = x + y that is y^2 = stretch^2 sin(phi). Newton's method from above, as the left side less the
    right is convex; where rounding leads it beyond the loss of contact, the last value before.
    """
    square, y, before = stretch * stretch, stretch, stretch
    for _ in range(_ITERATIONS):
        versine = x + y
        sine = math.sqrt(versine * (2.0 - versine))
        slope = 2.0 * y * sine - square * (1.0 - versine)
        if not slope > 0.0:
            return before
        step = sine * (y * y - square * sine) / slope
        if not step > _RTOL * y:
            break
        before, y = y, y - step
    return y


@njit
def state(indentation: float, rise: float, mark: Mark, asperity: Floats, body: Body) -> State:
    """The contact after the flat has risen from the deepest indentation."""
    if mark.first == 0.0:
        return elastic(indentation, asperity, body)
    b, height, whole = mark.first, mark.second, mark.third
    x = 1.0 - rise / (height * whole)  # indentation of the springs over H
    stretch = _stretch(mark, body) if body.work > 0.0 else 0.0
    phi, sine, cosine, tension, slope = 0.5 * math.pi, 1.0, 0.0, 1.0 - x, 1.0  # all springs hold
    if x + stretch < 1.0:
        tension = _tension(x, stretch) if body.work > 0.0 else 0.0
        versine = x + tension
        if versine <= 0.0:
            return State(0.0, 0.0, 0.0, 0.0)
        phi, cosine = 2.0 * math.asin(math.sqrt(0.5 * versine)), 1.0 - versine
        sine = math.sqrt(versine * (2.0 - versine))
        slope = sine - 0.5 * tension * cosine / sine
    modulus = body.effective_modulus * b
    pushing = phi - sine * cosine
    force = modulus * height * (pushing - 2.0 * sine * tension)
    stored = sine - phi * cosine - sine * sine * sine / 3.0 + tension * (sine * tension - pushing)
    energy = modulus * height * height * stored - math.pi * body.work * (b * sine) * (b * sine)
    if rise > 0.0:
        stiffness = 2.0 * modulus * (sine - (tension * cosine / slope if slope > 0.0 else math.inf)) / whole
    else:
        pressure = 0.5 * height * body.effective_modulus / b
        falling = _DECAY / asperity[RADIUS] * (pressure - body.yield_strength)
        widening = 2.0 * max(asperity[RADIUS] - body.squared * indentation, 0.0)
        stiffness = math.pi * (widening * pressure - b * b * falling)
    return State(force, b * sine, stiffness, energy * whole)


@njit
def lost(deepest: float, mark: Mark, asperity: Floats, body: Body) -> float:
    """Energy [J] that yielding has taken: what was stored at its onset, and the work since, less what is stored."""
    if mark.first == 0.0:
        return 0.0
    half, middle = 0.5 * (deepest - asperity[LIMIT]), 0.5 * (deepest + asperity[LIMIT])
    work = asperity[BEFORE]
    for m in range(_NODES.size):
        work += half * _WEIGHTS[m] * _yielding_force(middle + half * _NODES[m], asperity, body)
    return float(work - state(deepest, 0.0, mark, asperity, body).stored)


@once
def kernels(*, adhesive: bool) -> PlasticKernels:
    """Return the kernels."""
    found = PlasticKernels("mdr_adhesive" if adhesive else "mdr")
    found.adhesive, found.kinks = adhesive, (math.inf,)
    found.prepare, found.mark, found.ends, found.state, found.lost = prepare, mark, ends, state, lost
    return found
