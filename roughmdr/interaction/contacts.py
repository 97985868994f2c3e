"""One contact without adhesion on a surface that others displace, tilt and curve, to second order in their distance.

The neighbours displace the half-space by U + tilt . x + curvature r^2 about the axis of an asperity. Each term is exact
to its order:

- curvature r^2 adds to the profile, so 2 curvature x^2 to g;
- a tilt moves the contact to the new top, where it is deeper by a tilt^2/g'(a), and its pressure with it: the moment
  about the old axis is K tilt, K = 4/3 E* a^3, whatever the profile. Where tilt > g'(a), the top is the radius at which
  tilt = g';
- the pressure of the contact is felt by others as its load, its second moment M = ∫ p r^2 dA, and that moment.

Lengths are over the side L of the patch, loads over pi E* L^2. The unknown of a contact is x, the indentation at which
it would carry its load alone; below 0 the distance to first touch.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from roughmdr.interaction.tip_edge import held, level, whole_edge
from roughmdr.kernels.interface import Kernels
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import once, specialise

_NODES, _WEIGHTS = unit_gauss(20)
_RTOL, _MAX_ITERATIONS = 1e-14, 100
_DOUBLINGS, _BISECTIONS = 60, 60


class Asperities(NamedTuple):
    """Asperities in units of the patch."""

    height: Floats
    """Summit heights."""
    depth: Floats
    """Natural depths."""
    size: Floats
    """Natural radii."""
    params: Floats
    """As ``Kernels.prepare`` returns them."""


class Contacts(NamedTuple):
    """Contacts at a state x, one number for each asperity."""

    state: Floats
    """The state t of its kernels."""
    load: Floats
    growth: Floats
    """Slope of the load over x."""
    stiffness: Floats
    """Slope of the load over the indentation; over x, unless the edge of a tip holds the contact."""
    radius: Floats
    """Of the contact; that of a flat punch, which is its own, also out of contact."""
    lift: Floats
    """By how much its indentation exceeds x."""
    second_moment: Floats
    """M."""
    tilting: Floats
    """K, the moment of the pressure for a tilt of 1."""
    slide: Floats
    """How far the contact moves for a tilt of 1: 2 a/g'(a), but no farther than to the new top."""


Slid = tuple[float, float]
"""How much deeper a contact lies that has slid, and its ``slide``."""
Tipped = tuple[float, float, float, float]
"""The same of one that the edge of its tip holds, what is to be added to 1/a, and K over 4/3 a^3."""


Terms = tuple[float, float, float, float, float]
"""a, da/dt, g, dg/dt and ∫ x g' dx over the natural size and depth."""


class CoupledKernels(Kernels):
    """Kernels of a shape without adhesion, with those that a displaced surface needs."""

    pinned = False
    flat = False
    edged = False
    """Whether the tip is a flat, or a cap that ends at an edge."""
    terms: Callable[..., Terms]
    """(t, params) -> the terms at a state."""
    cubic_integral: Callable[..., float]
    """(t, params) -> ∫ x^3 g' dx to a, over natural size^3 and depth."""
    curved_state: Callable[..., float]
    """(t, ratio, params) -> the state with the load of t on a surface whose curvature adds ratio a^2 to g; negative,
    minus the radius, where the contact lies within the flat of a tip."""
    newton_state: Callable[..., float]
    """As ``curved_state``, by iteration, where that has a closed form for some."""
    loaded_state: Callable[..., float]
    """(load, t, ratio, params) -> the state with a load on such a surface, from a guess t."""
    top: Callable[..., float]
    """(t, tilt, ratio, params) -> the radius from t on where dg/da is the tilt, over natural size."""
    bisected_top: Callable[..., float]
    """As ``top``, by bisection."""
    slid: Callable[..., Slid]
    """(t, a, dg/da, tilt, ratio, depth, size, params) -> a contact on a tilted surface."""
    edge_curvature: Callable[..., float]
    """(ratio, params) -> the curvature of the gap between tip and surface."""
    tipped: Callable[..., Tipped]
    """(load, tilt, ratio, depth, size, params) -> one whose load leaves part of the edge of its tip out of contact."""
    load_alone: Callable[..., None]
    respond: Callable[..., int]


law = CoupledKernels("law")
"""Stands for the kernels in parts that ``specialise`` is given."""


def terms_of_power(t: float, n: float) -> Terms:
    """Return the terms of g = t^n."""
    power = t * t if n == 2.0 else math.pow(t, n)
    return t, 1.0, power, n * power / t if t > 0.0 else 0.0, n / (n + 1.0) * t * power


def cubic_integral_of_power(t: float, n: float) -> float:
    """Return n t^(n + 3)/(n + 3)."""
    return n / (n + 3.0) * t * t * t * (t * t if n == 2.0 else math.pow(t, n))


def terms_of_profile(t: float, params: Floats) -> Terms:
    """Return the terms of a profile."""
    a, da, g, dg = law.mdr_profile(t, params)
    return a, da, g, dg, law.reduced_load(t, params)


def cubic_integral_of_profile(t: float, params: Floats) -> float:
    """Return ∫ x^3 g' dx panel by panel, in the fourth root of the position, as g' may begin like a root."""
    total, low = 0.0, 0.0
    while low < t:
        high = min(1.0 if low < 1.0 else 2.0 * low, t)
        for i in range(_NODES.size):
            z = _NODES[i]
            a, _, _, dg = law.mdr_profile(low + (high - low) * z * z * z * z, params)
            total += 4.0 * (high - low) * _WEIGHTS[i] * z * z * z * a * a * a * dg
        low = high
    return total


def curved_state(t: float, ratio: float, params: Floats) -> float:
    """Find the state from that alone on downwards, as load and curvature add up."""
    load, added = law.terms(t, params)[4], 2.0 / 3.0 * ratio
    if law.flat:
        flat = law.terms(0.0, params)[0]
        if load <= added * flat * flat * flat:
            return -math.pow(load / added, 1.0 / 3.0) if load > 0.0 else -0.0
    return float(law.loaded_state(load, t, ratio, params))


def loaded_state(load: float, t: float, ratio: float, params: Floats) -> float:
    """Find the state by Newton's method, from one with at least the load alone on downwards."""
    added = 2.0 / 3.0 * ratio
    while law.terms(t, params)[4] < load:
        t *= 2.0
    for _ in range(_MAX_ITERATIONS):
        a, da, _, dg, own = law.terms(t, params)
        step = (own + added * a * a * a - load) / (a * (dg + 3.0 * added * a * da))
        t = max(t - step, 0.25 * t)
        if abs(step) <= _RTOL * t:
            break
    return t


def curved_state_of_power(t: float, ratio: float, n: float) -> float:
    """Return the state in closed form for n = 2, else by Newton's method."""
    if n == 2.0:
        return t * math.pow(1.0 + ratio, -1.0 / 3.0)
    return float(law.newton_state(t, ratio, n))


def top(t: float, tilt: float, ratio: float, params: Floats) -> float:
    """Find the radius by bisection; that of t where the profile is nowhere so steep."""
    low, high = t, max(2.0 * t, 1e-6)
    for _ in range(_DOUBLINGS):
        a, da, _, dg, _ = law.terms(high, params)
        if dg / da + 2.0 * ratio * a >= tilt:
            break
        high *= 2.0
    else:
        return law.terms(t, params)[0]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        a, da, _, dg, _ = law.terms(middle, params)
        if dg / da + 2.0 * ratio * a >= tilt:
            high = middle
        else:
            low = middle
    return law.terms(high, params)[0]


def top_of_power(t: float, tilt: float, ratio: float, n: float) -> float:
    """Return the radius in closed form for n = 2, else by bisection."""
    return 0.5 * tilt / (1.0 + ratio) if n == 2.0 else float(law.bisected_top(t, tilt, ratio, n))


def slid(
    t: float, a: float, slope: float, tilt: float, ratio: float, depth: float, size: float, params: Floats
) -> Slid:
    """Return how deep and how far; to the new top where g is nowhere so steep in the contact."""
    steep = tilt * size / depth
    if slope >= steep:
        return depth * (a * steep * steep / slope), 2.0 * a / slope * size / depth * size
    top = law.top(max(t, 0.0), steep, ratio, params)
    return depth * steep * top, size * top / tilt


def edge_curvature(ratio: float, params: Floats) -> float:
    """Return k of ``tip_edge``: that of the cap, and of a surface that is curved away."""
    return max(0.5 * (law.terms(0.0 if law.flat else 1.0, params)[2] + ratio), 0.0)


def tipped(load: float, tilt: float, ratio: float, depth: float, size: float, params: Floats) -> Tipped:
    """Return the contact: it lies as deep as the edge allows, or as the flank does where the whole edge is reached."""
    k, steep = law.edge_curvature(ratio, params), tilt * size / depth
    reached = law.loaded_state(whole_edge(steep, k), 1.0, ratio, params)
    a, da, _, dg, _ = law.terms(reached, params)
    flank, flank_slide = law.slid(reached, a, dg / da + 2.0 * ratio * a, tilt, ratio, depth, size, params)
    radius, centre, indentation = held(load, steep, k)
    level_radius, level_indentation = level(load, k)
    narrower, turned = 0.0, 1.0
    if load > 0.0:
        share = radius / level_radius
        narrower, turned = 1.0 / radius - 1.0 / level_radius, 3.0 - 2.0 * share * share
    deeper = depth * (level_indentation - indentation)
    return max(deeper, flank), max(size * centre / tilt, flank_slide), narrower, turned


def load_alone(x: Floats, asperities: Asperities, contacts: Contacts) -> None:
    """Fill state, load, stiffness and radius of contacts that carry their load alone."""
    depth, size, params = asperities.depth, asperities.size, asperities.params
    for i in range(x.size):
        contacts.state[i] = contacts.load[i] = contacts.growth[i] = contacts.stiffness[i] = 0.0
        contacts.radius[i] = size[i] if law.pinned else 0.0
        if x[i] > 0.0:
            own = law.params_of(params, i)
            t = law.state(x[i] / depth[i], own)
            if law.pinned:
                a, load = 1.0, t
            else:
                a, _, _, _, load = law.terms(t, own)
            contacts.state[i] = t
            contacts.radius[i] = size[i] * a
            contacts.load[i] = 2.0 / math.pi * size[i] * depth[i] * load
            contacts.growth[i] = contacts.stiffness[i] = 2.0 / math.pi * size[i] * a


def respond(asperities: Asperities, field: Floats, contacts: Contacts) -> int:
    """Fill radius, lift, moments and slide of contacts on a surface with the slopes and the Laplacian of ``field``.

    Return how many contacts are no discs: where the surface is curved more than the profile, the other way.
    """
    depth, size, params = asperities.depth, asperities.size, asperities.params
    lost = 0
    for i in range(size.size):
        curvature = 0.25 * field[3, i]
        tilt = math.hypot(field[1, i], field[2, i])
        t, own = contacts.state[i], law.params_of(params, i)
        touching = contacts.load[i] > 0.0
        lift = moment = tilting = slide = 0.0
        if law.pinned:
            if touching:
                a = size[i]
                lift = 2.0 / 3.0 * curvature * a * a
                moment = 4.0 / (3.0 * math.pi) * a**3 * depth[i] * t - 32.0 / (45.0 * math.pi) * curvature * a**5
                tilting = 4.0 / (3.0 * math.pi) * a**3
        else:
            ratio = 2.0 * curvature * size[i] / depth[i] * size[i]
            if ratio <= -1.0:
                lost, ratio = lost + 1, 0.0
            a = slope = 0.0
            if touching:
                alone = law.terms(t, own)[2]
                t = law.curved_state(t, ratio, own)
                a, da, g, dg, _ = (-t, 1.0, 0.0, 0.0, 0.0) if t <= 0.0 else law.terms(t, own)
                lift = depth[i] * ((g - alone) + ratio * a * a)
                slope = dg / da + 2.0 * ratio * a
                cubic = law.cubic_integral(t, own) if t > 0.0 else 0.0
                moment = size[i] ** 3 * depth[i] / math.pi * (4.0 / 3.0 * cubic + 8.0 / 15.0 * ratio * a**5)
                tilting = 4.0 / (3.0 * math.pi) * (size[i] * a) ** 3
                contacts.radius[i] = size[i] * a
            steep = tilt * size[i] / depth[i]
            if steep > 0.0:
                load = 0.5 * math.pi * contacts.load[i] / size[i] / depth[i]
                if law.edged and load < whole_edge(steep, law.edge_curvature(ratio, own)):
                    deeper, slide, narrower, turned = law.tipped(load, tilt, ratio, depth[i], size[i], own)
                    if touching:
                        a = 1.0 / (1.0 / a + narrower)
                        contacts.radius[i], contacts.stiffness[i] = size[i] * a, 2.0 / math.pi * size[i] * a
                        tilting = turned * 4.0 / (3.0 * math.pi) * (size[i] * a) ** 3
                else:
                    deeper, slide = law.slid(t, a, slope, tilt, ratio, depth[i], size[i], own)
                lift -= deeper
        contacts.lift[i], contacts.second_moment[i], contacts.tilting[i], contacts.slide[i] = (
            lift, moment, tilting, slide
        )  # fmt: skip
    return lost


@once
def coupled_kernels(kernels: Kernels) -> CoupledKernels:
    """Return the kernels of a shape without adhesion with what a displaced surface needs, and both loops, compiled."""
    whole = CoupledKernels(f"coupled_{kernels.name}")
    vars(whole).update(vars(kernels) | {"__name__": whole.__name__})
    whole.pinned = kernels.name.endswith("flat_punch")
    whole.edged = isinstance(kernels, ProfileKernels) and (kernels.flat or kernels.corner)
    parts: dict[str, Callable[..., object]]
    if isinstance(kernels, ProfileKernels):
        parts = {
            "terms": terms_of_profile,
            "cubic_integral": cubic_integral_of_profile,
            "curved_state": curved_state,
            "top": top,
        }
    else:
        parts = {
            "terms": terms_of_power,
            "cubic_integral": cubic_integral_of_power,
            "newton_state": curved_state,
            "curved_state": curved_state_of_power,
            "bisected_top": top,
            "top": top_of_power,
        }
    common = loaded_state, slid, edge_curvature, tipped, load_alone, respond
    for name, part in (parts | {each.__name__: each for each in common}).items():
        vars(whole)[name] = specialise(part, whole)
    return whole
