"""One contact without adhesion on a surface that others displace, tilt and curve, to second order in their distance.

The neighbours displace the half-space by U + tilt . x + curvature r^2 about the axis of an asperity. Each term is exact
to its order:

- curvature r^2 adds to the profile, so 2 curvature x^2 to g;
- a tilt moves the contact to the new top, where it is deeper by a tilt^2/g'(a), and its pressure with it: the moment
  about the old axis is K tilt, K = 4/3 E* a^3, whatever the profile. Where tilt > g'(a), the top is the radius at which
  tilt = g'. The edge of a tip limits that (``tip_edge.py``);
- the pressure of the contact is felt by others as its load, its second moment M = ∫ p r^2 dA, and that moment.
"""

import math
from collections.abc import Callable, Mapping

from roughmdr.interaction.interface import Asperities, Contacts, CoupledKernels, Slid, Terms, kernel
from roughmdr.interaction.tip_edge import edge_curvature, tipped, whole_edge
from roughmdr.kernels.interface import Kernels
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import once, specialise

_NODES, _WEIGHTS = unit_gauss(20)
_RTOL, _MAX_ITERATIONS = 1e-14, 100
_DOUBLINGS, _BISECTIONS = 60, 60


def terms_of_power(t: float, n: float) -> Terms:
    """Return the terms of g = t^n."""
    power = t * t if n == 2.0 else math.pow(t, n)
    return t, 1.0, power, n * power / t if t > 0.0 else 0.0, n / (n + 1.0) * t * power


def cubic_integral_of_power(t: float, n: float) -> float:
    """Return n t^(n + 3)/(n + 3)."""
    return n / (n + 3.0) * t * t * t * (t * t if n == 2.0 else math.pow(t, n))


def terms_of_profile(t: float, params: Floats) -> Terms:
    """Return the terms of a profile."""
    a, da, g, dg = kernel.mdr_profile(t, params)
    return a, da, g, dg, kernel.reduced_load(t, params)


def cubic_integral_of_profile(t: float, params: Floats) -> float:
    """Return ∫ x^3 g' dx panel by panel, in the fourth root of the position, as g' may begin like a root."""
    total, low = 0.0, 0.0
    while low < t:
        high = min(1.0 if low < 1.0 else 2.0 * low, t)
        for i in range(_NODES.size):
            z = _NODES[i]
            a, _, _, dg = kernel.mdr_profile(low + (high - low) * z * z * z * z, params)
            total += 4.0 * (high - low) * _WEIGHTS[i] * z * z * z * a * a * a * dg
        low = high
    return total


def curved_state(t: float, ratio: float, params: Floats) -> float:
    """Find the state from that alone on downwards, as load and curvature add up; within the edge of a tip at once."""
    load = kernel.terms(t, params)[4]
    if kernel.edged:
        within = 4.0 / 3.0 * kernel.edge_curvature(ratio, params)
        if load <= within:
            a = math.pow(load / within, 1.0 / 3.0) if load > 0.0 else 0.0
            return -a if kernel.flat else a
    return float(kernel.loaded_state(load, t, ratio, params))


def loaded_state(load: float, t: float, ratio: float, params: Floats) -> float:
    """Find the state by Newton's method, from one with at least the load alone on downwards."""
    added = 2.0 / 3.0 * ratio
    while kernel.terms(t, params)[4] < load:
        t *= 2.0
    for _ in range(_MAX_ITERATIONS):
        a, da, _, dg, own = kernel.terms(t, params)
        step = (own + added * a * a * a - load) / (a * (dg + 3.0 * added * a * da))
        t = max(t - step, 0.25 * t)
        if abs(step) <= _RTOL * t:
            break
    return t


def curved_state_of_power(t: float, ratio: float, n: float) -> float:
    """Return the state in closed form for n = 2, else by Newton's method."""
    if n == 2.0:
        return t * math.pow(1.0 + ratio, -1.0 / 3.0)
    return float(kernel.newton_state(t, ratio, n))


def top(t: float, tilt: float, ratio: float, params: Floats) -> float:
    """Find the radius by bisection; that of t where the profile is nowhere so steep."""
    low, high = t, max(2.0 * t, 1e-6)
    for _ in range(_DOUBLINGS):
        a, da, _, dg, _ = kernel.terms(high, params)
        if dg / da + 2.0 * ratio * a >= tilt:
            break
        high *= 2.0
    else:
        return kernel.terms(t, params)[0]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        a, da, _, dg, _ = kernel.terms(middle, params)
        if dg / da + 2.0 * ratio * a >= tilt:
            high = middle
        else:
            low = middle
    return kernel.terms(high, params)[0]


def top_of_power(t: float, tilt: float, ratio: float, n: float) -> float:
    """Return the radius in closed form for n = 2, else by bisection."""
    return 0.5 * tilt / (1.0 + ratio) if n == 2.0 else float(kernel.bisected_top(t, tilt, ratio, n))


def slid(
    t: float, a: float, slope: float, tilt: float, ratio: float, depth: float, size: float, params: Floats
) -> Slid:
    """Return how deep and how far; to the new top where g is nowhere so steep in the contact."""
    steep = tilt * size / depth
    if slope >= steep:
        return depth * (a * steep * steep / slope), 2.0 * a / slope * size / depth * size
    top = kernel.top(max(t, 0.0), steep, ratio, params)
    return depth * steep * top, size * top / tilt


def load_alone(x: Floats, asperities: Asperities, contacts: Contacts) -> None:
    """Fill state, load, stiffness and radii of contacts that carry their load alone."""
    depth, size, params = asperities.depth, asperities.size, asperities.params
    for i in range(x.size):
        contacts.state[i] = contacts.load[i] = contacts.growth[i] = contacts.stiffness[i] = contacts.radius[i] = 0.0
        contacts.punch[i] = size[i] if kernel.pinned or kernel.flat else 0.0
        if x[i] > 0.0:
            own = kernel.params_of(params, i)
            t = kernel.state(x[i] / depth[i], own)
            if kernel.pinned:
                a, load = 1.0, t
            else:
                a, _, _, _, load = kernel.terms(t, own)
            contacts.state[i] = t
            contacts.radius[i] = contacts.punch[i] = size[i] * a
            contacts.load[i] = 2.0 / math.pi * size[i] * depth[i] * load
            contacts.growth[i] = contacts.stiffness[i] = 2.0 / math.pi * size[i] * a


def respond(asperities: Asperities, field: Floats, contacts: Contacts) -> int:
    """Fill radii, lift, moments and slide of contacts on a surface with the slopes and the Laplacian of ``field``.

    Return how many contacts are no discs: where the surface is curved more than the profile, the other way.
    """
    depth, size, params = asperities.depth, asperities.size, asperities.params
    lost = 0
    for i in range(size.size):
        curvature = 0.25 * field[3, i]
        tilt = math.hypot(field[1, i], field[2, i])
        t, own = contacts.state[i], kernel.params_of(params, i)
        touching = contacts.load[i] > 0.0
        a = slope = lift = moment = tilting = slide = 0.0
        ratio = 2.0 * curvature * size[i] / depth[i] * size[i]
        if ratio <= -1.0 and not kernel.pinned:
            lost, ratio = lost + 1, 0.0
        if touching:
            if kernel.pinned and t >= 2.0 / 3.0 * ratio:
                a = 1.0
                lift = 2.0 / 3.0 * curvature * size[i] * size[i]
                moment = (
                    4.0 / (3.0 * math.pi) * size[i] ** 3 * depth[i] * t
                    - 32.0 / (45.0 * math.pi) * curvature * size[i] ** 5
                )
            else:
                alone = t if kernel.pinned else kernel.terms(t, own)[2]
                t = -math.pow(1.5 * t / ratio, 1.0 / 3.0) if kernel.pinned else kernel.curved_state(t, ratio, own)
                a, da, g, dg, _ = (-t, 1.0, 0.0, 0.0, 0.0) if t <= 0.0 else kernel.terms(t, own)
                lift = depth[i] * ((g - alone) + ratio * a * a)
                slope = dg / da + 2.0 * ratio * a
                cubic = kernel.cubic_integral(t, own) if t > 0.0 else 0.0
                moment = size[i] ** 3 * depth[i] / math.pi * (4.0 / 3.0 * cubic + 8.0 / 15.0 * ratio * a**5)
            tilting = 4.0 / (3.0 * math.pi) * (size[i] * a) ** 3
            contacts.radius[i] = size[i] * a
            contacts.punch[i] = max(size[i] * a, size[i]) if kernel.pinned or kernel.flat else size[i] * a
        steep = tilt * size[i] / depth[i]
        load = 0.5 * math.pi * contacts.load[i] / size[i] / depth[i]
        if kernel.edged and load < whole_edge(steep, kernel.edge_curvature(ratio, own)):
            deeper, shift, narrower, turned = kernel.tipped(load, steep, ratio, own)
            lift -= depth[i] * deeper
            slide = size[i] * shift / tilt if tilt > 0.0 else 0.0
            if touching:
                a = 1.0 / (1.0 / a + narrower)
                contacts.radius[i], contacts.stiffness[i] = size[i] * a, 2.0 / math.pi * size[i] * a
                tilting = turned * 4.0 / (3.0 * math.pi) * (size[i] * a) ** 3
        elif steep > 0.0 and not kernel.pinned:
            deeper, slide = kernel.slid(t, a, slope, tilt, ratio, depth[i], size[i], own)
            lift -= deeper
        contacts.lift[i], contacts.second_moment[i], contacts.tilting[i], contacts.slide[i] = (
            lift, moment, tilting, slide
        )  # fmt: skip
    return lost


@once
def coupled_kernels(kernels: Kernels) -> CoupledKernels:
    """Return the kernels of a shape without adhesion with what a displaced surface needs, and both loops, compiled."""
    pinned = kernels.name.endswith("flat_punch")
    edged = pinned or (isinstance(kernels, ProfileKernels) and (kernels.flat or kernels.corner))
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
    parts |= {each.__name__: each for each in common}
    return with_parts(kernels, f"coupled_{kernels.name}", parts, pinned=pinned, edged=edged)


def with_parts(
    kernels: Kernels, name: str, parts: Mapping[str, Callable[..., object]], **constants: bool
) -> CoupledKernels:
    """Return kernels with more, which are compiled for them."""
    whole = CoupledKernels(name)
    vars(whole).update(vars(kernels) | {"__name__": name} | constants)
    for part_name, part in parts.items():
        vars(whole)[part_name] = specialise(part, whole)
    return whole
