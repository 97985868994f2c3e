"""Two equal indenters on a free half-space, and one on a tilted plane: boundary integrals with a free edge.

No multipole and no formula of the method of dimensionality reduction is in it. Profiles are f = c r^n, E* is 1. The edge
of the contact is an unknown, together with the pressure (``mapped_disc``): Newton's method finds both from the
displacement δ - f - u in the contact, u from outside. Of two equal indenters each is the mirror image of the other.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import eval_jacobi, gamma, roots_jacobi

from oracles.mapped_disc import Complexes, MappedDisc, evaluate
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats

_MAX_ITERATIONS = 30
_DIFFERENCE = 1e-5  # of a coefficient of the edge, for a derivative
_RTOL_STEP = 1e-11


class Contact(NamedTuple):
    """One contact in the field of its surroundings."""

    force: float
    moment: float
    """∫ p x dA about the axis of the indenter."""
    second_moment: float
    """∫ p r² dA about that axis."""
    area: float
    residual: float
    """The largest error of the displacement in the contact, over the approach."""


# Displacement at z by the pressure of amplitudes j on the contact: (z, positions and weights of its points) -> matrix
Field = Callable[[Complexes, Complexes], Floats]


def mirrored(distance: float) -> Field:
    """Return the influence of the mirror image of a contact, whose axis is ``distance`` away along x."""
    return lambda z, source: 1.0 / (math.pi * np.abs(z[:, None] - (distance - source.conj())))


def alone(z: Complexes, source: Complexes) -> Floats:
    """Return no influence."""
    return np.zeros((z.size, source.size))


def lone_radius(exponent: float, slope: float, approach: float) -> float:
    """Return the contact radius of c r^n on its own (I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47)."""
    kappa = math.sqrt(math.pi) * gamma(0.5 * exponent + 1.0) / gamma(0.5 * exponent + 0.5)
    return float((approach / (kappa * slope)) ** (1.0 / exponent))


def press(
    exponent: float, slope: float, approach: float, field: Field = alone, tilt: float = 0.0, degree: int = 12
) -> Contact:
    """Return the contact of f = ``slope`` r^``exponent`` at ``approach`` from the plane with surface ``tilt`` x.

    ``degree`` of the polynomials says how fine it is. Odd exponents converge slowly: there the tip is not smooth.
    OutOfRange where Newton's method does not converge.
    """
    disc = MappedDisc(degree)
    whole = disc.whole
    edge = np.zeros(degree + 4)  # coefficients of z; that of ζ² is 0, for which the centre stands
    edge[1] = lone_radius(exponent, slope, approach)
    free = np.array([0, 1, *range(3, edge.size)])

    def mismatch(edge: Floats, amplitudes: Floats) -> Floats:
        z, _ = evaluate(edge, disc.points)
        source, area = evaluate(edge, whole.zeta)
        outside = field(z, source) @ (whole.weight * area * (whole.modes @ amplitudes))
        wanted = approach - slope * np.abs(z) ** exponent - tilt * z.real
        return disc.root_weight * (disc.own_displacement(edge, amplitudes) + outside - wanted)

    amplitudes = np.zeros(len(disc.modes))
    for _ in range(_MAX_ITERATIONS):
        z, _ = evaluate(edge, disc.points)
        source, area = evaluate(edge, whole.zeta)
        by_pressure = disc.own_displacement(edge) + field(z, source) @ ((whole.weight * area)[:, None] * whole.modes)
        if not amplitudes.any():
            wanted = approach - slope * np.abs(z) ** exponent - tilt * z.real
            amplitudes = np.linalg.lstsq(by_pressure, wanted, rcond=None)[0]
        step = _DIFFERENCE * edge[1]
        by_edge = [
            (mismatch(edge + shift, amplitudes) - mismatch(edge - shift, amplitudes)) / (2.0 * step)
            for shift in step * np.eye(edge.size)[free]
        ]
        jacobian = np.column_stack((disc.root_weight[:, None] * by_pressure, *by_edge))
        change = np.linalg.lstsq(jacobian, -mismatch(edge, amplitudes), rcond=None)[0]
        amplitudes = amplitudes + change[: amplitudes.size]
        edge[free] += change[amplitudes.size :]
        if np.abs(change[amplitudes.size :]).max() <= _RTOL_STEP * edge[1]:
            break
    else:
        raise OutOfRange(f"degree is {degree}: the edge of the contact is not found")
    source, area = evaluate(edge, whole.zeta)
    load = whole.weight * area * (whole.modes @ amplitudes)
    residual = np.abs(mismatch(edge, amplitudes) / disc.root_weight).max() / approach
    order = np.arange(edge.size)
    return Contact(
        force=float(load.sum()),
        moment=float(load @ source.real),
        second_moment=float(load @ np.abs(source) ** 2),
        area=math.pi * float(order @ edge**2),
        residual=float(residual),
    )
