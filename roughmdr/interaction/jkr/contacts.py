"""One adhesive contact (JKR) on a surface that others displace, tilt and curve: its part of the energy.

The energy of a contact of radius a under the indentation delta, over E*, is

    e = ∫_0^a (delta' - g - 2 c x^2)^2 dx - pi w a^2/E* + kappa tilt^2/2,    delta' = delta + lambda tilt^2/2

with the curvature c of the surface (H 28, 40, the profile increased by c r^2), lambda = 2 a/g'(a), by which a tilted
contact slides to its new top (the radius of a paraboloid; less near the edge of a flat), and
kappa = 4 a^3/3 - 2 lambda ∫ x g' dx, so that the moment is that of the coupled tilt, K tilt with
K = 4 a^3/3 - 4 a^2 (g - delta)/g'. All that follows is derived from it: load P = de/d(delta), second moment M = -de/dc,
moment D = de/d(tilt), and the edge condition de/da = 0.

Lengths are over the side L of the patch, loads over pi E* L^2, energies over E* L^3.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction.interface import Asperities, kernel
from roughmdr.numerics.arguments import Floats

_STEP = 1e-4  # relative step of the state, for derivatives of lambda, which only a small square multiplies
_HELD = 0.3  # state of a contact with a flat up to which its edge keeps it from sliding


class Contacts(NamedTuple):
    """Contacts at their states under their loads, one number for each asperity; 0 out of contact."""

    radius: Floats
    """a."""
    slope: Floats
    """da/dt."""
    stretch: Floats
    """g + 2 c a^2 - delta', by which the edge is stretched; dl in equilibrium."""
    edge: Floats
    """de/da; 0 in equilibrium."""
    depth: Floats
    """The indentation delta that the load takes."""
    second_moment: Floats
    """M."""
    tilting: Floats
    """K, the moment for a tilt of 1."""
    lift: Floats
    """lambda; out of contact by how much the tilt brings first touch forward."""
    edge_by_radius: Floats
    edge_by_load: Floats
    edge_by_curvature: Floats
    edge_by_tilt: Floats
    """Over the tilt."""
    moment_by_radius: Floats
    energy: Floats
    """e."""


def strain_of_power(t: float, n: float) -> float:
    """Return 2 n^2 t^(2 n + 1)/((n + 1)(2 n + 1))."""
    return 2.0 * n * n / ((n + 1.0) * (2.0 * n + 1.0)) * math.pow(t, 2.0 * n + 1.0)


def strain_of_profile(t: float, params: Floats) -> float:
    """Return the integral of a profile."""
    return float(kernel.elastic_integral(t, params))


def lift(t: float, size: float, depth: float, params: Floats) -> float:
    """Return lambda = 2 a/g', which goes to 0 at the edge of a flat; there with no infinite slope over a."""
    a, da, _, dg, _ = kernel.terms(t, params)
    slides = 1.0 - kernel.held(t)
    return 2.0 * a * da / dg * slides * size * size / depth


def slide(t: float, size: float, depth: float, params: Floats) -> tuple[float, float, float]:
    """Return lambda with its first and second derivative over a."""
    step = _STEP * t
    low, here, high = (
        kernel.lift(t - step, size, depth, params),
        kernel.lift(t, size, depth, params),
        kernel.lift(t + step, size, depth, params),
    )
    da = size * kernel.terms(t, params)[1]
    bend = size * (kernel.terms(t + step, params)[1] - kernel.terms(t - step, params)[1]) / (2.0 * step)
    by_a = (high - low) / (2.0 * step * da)
    return here, by_a, ((high - 2.0 * here + low) / (step * step) - by_a * bend) / (da * da)


def held(t: float) -> float:
    """Return the part of its slide from which the edge of a flat keeps a contact; all of it with the flat's radius."""
    return _HELD * _HELD / (t * t + _HELD * _HELD) if kernel.flat else 0.0


def fill(
    inside: NDArray[np.bool_],
    t: Floats,
    load: Floats,
    field: Floats,
    work: float,
    asperities: Asperities,
    out: Contacts,
) -> None:
    """Fill in the contacts; ``work`` is w/(E* L), ``field`` [row, asperity] the displacement with its derivatives."""
    sizes, depths, params = asperities.size, asperities.depth, asperities.params
    for i in range(t.size):
        for row in out:
            row[i] = 0.0
        size, depth, own = sizes[i], depths[i], kernel.params_of(params, i)
        c, tilt = 0.25 * field[3, i], math.hypot(field[1, i], field[2, i])
        square = tilt * tilt
        if not inside[i]:
            if kernel.pinned:
                out.lift[i] = -2.0 / 3.0 * c * size * size
            elif tilt > 0.0:
                steep = tilt * size / depth
                ratio = max(2.0 * c * size / depth * size, -0.5)
                out.lift[i] = depth * steep * kernel.top(0.0, steep, ratio, own)
            continue
        p = math.pi * load[i]
        shift = shift_by_a = shift_by_aa = 0.0
        if kernel.pinned:
            a, da, g, dg, first, third, strain = size, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
        else:
            a, da, g, dg, first = kernel.terms(t[i], own)
            third = kernel.cubic_integral(t[i], own) * size**3 * depth
            strain = kernel.strain(t[i], own) * size * depth * depth
            a, da, g, dg, first = size * a, size * da, depth * g, depth * dg, size * depth * first
            if tilt > 0.0:
                shift, shift_by_a, shift_by_aa = kernel.slide(t[i], size, depth, own)
        third_of_tilt = 4.0 / 3.0 * a**3 - 2.0 * shift * first
        kept = 0.0 if kernel.pinned else 4.0 * a * a * kernel.held(t[i])
        stretch = (first - 0.5 * p) / a + 4.0 / 3.0 * c * a * a
        rising = dg / da  # g'
        out.radius[i], out.slope[i], out.stretch[i] = a, da, stretch
        turning = shift_by_a * (p - 2.0 * first) + kept
        out.edge[i] = stretch * stretch - 2.0 * math.pi * work * a + 0.5 * square * turning
        out.depth[i] = g + 2.0 * c * a * a - stretch - 0.5 * shift * square
        out.second_moment[i] = (
            2.0 / 3.0 * a * a * load[i]
            - 4.0 / (3.0 * math.pi) * (a * a * first - third)
            - 32.0 / (45.0 * math.pi) * a**5 * c
        )
        out.tilting[i] = shift * load[i] + third_of_tilt / math.pi
        out.lift[i] = shift
        out.edge_by_radius[i] = 2.0 * stretch * (rising - stretch / a + 4.0 * c * a) - 2.0 * math.pi * work
        if tilt > 0.0 and not kernel.pinned:
            kept_by_a = kept * (2.0 / a - 2.0 * t[i] / (t[i] * t[i] + _HELD * _HELD) / da)
            out.edge_by_radius[i] += square * (
                0.5 * (shift_by_aa * (p - 2.0 * first) + kept_by_a) - shift_by_a * a * rising
            )
        out.edge_by_load[i] = -math.pi * stretch / a + 0.5 * math.pi * shift_by_a * square
        out.edge_by_curvature[i] = 8.0 / 3.0 * stretch * a * a
        out.edge_by_tilt[i] = turning
        out.moment_by_radius[i] = (
            4.0 / 3.0 * a * load[i] - 8.0 / (3.0 * math.pi) * a * first - 32.0 / (9.0 * math.pi) * a**4 * c
        )
        bowed = strain + 4.0 * c * (a * a * first - third / 3.0) + 32.0 / 15.0 * c * c * a**5
        out.energy[i] = (
            bowed
            - 2.0 * stretch * (first + 4.0 / 3.0 * c * a**3)
            + stretch * stretch * a
            - math.pi * work * a * a
            + 0.5 * third_of_tilt * square
        )
