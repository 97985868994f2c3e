"""Indenters f = c r^n that feel each other on a free half-space, by boundary integrals with free edges; E* is 1.

No multipole and no formula of the method of dimensionality reduction is in it. The edge of a contact is an unknown,
together with its pressure (``mapped_disc``): Newton's method finds both from the displacement in the contact, which is
approach - f less the displacement from outside. Unequal contacts are solved in turn until neither changes. All is
symmetric about the x-axis, on which the indenters stand.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from twins.mapped_disc import Complexes, MappedDisc, evaluate

DEGREE = 8
_MAX_ITERATIONS, _MAX_SWEEPS = 30, 60
_DIFFERENCE = 1e-5  # step of a coefficient of the edge, for a derivative
_RTOL_STEP, _RTOL_FORCE = 1e-11, 1e-14

Displacement = Callable[[Complexes], Floats]
Influence = Callable[[Complexes, Complexes], Floats]
"""(points, sources) -> displacement at each point by a unit force at each source."""
disc_of = lru_cache(maxsize=4)(MappedDisc)


class Indenter(NamedTuple):
    """f = ``slope`` r^``exponent``, moved by ``approach`` towards the undeformed plane."""

    exponent: float
    slope: float
    approach: float

    @property
    def lone_radius(self) -> float:
        """Contact radius on its own (I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47)."""
        n = self.exponent
        kappa = math.sqrt(math.pi) * math.gamma(0.5 * n + 1.0) / math.gamma(0.5 * n + 0.5)
        return float((self.approach / (kappa * self.slope)) ** (1.0 / n))


class Contact(NamedTuple):
    """The pressure under an indenter, whose axis is at z = 0."""

    edge: Floats
    """Coefficients of the map z(ζ); that of ζ² is 0, the centre of the disc stands for it."""
    amplitudes: Floats
    position: Complexes
    load: Floats
    """Loads of the points of a quadrature at ``position``."""
    residual: float
    """The largest error of the displacement in the contact, over the approach."""

    @property
    def force(self) -> float:
        """∫ p dA."""
        return float(self.load.sum())

    @property
    def moment(self) -> float:
        """∫ p x dA."""
        return float(self.load @ self.position.real)

    @property
    def second_moment(self) -> float:
        """∫ p r² dA."""
        return float(self.load @ np.abs(self.position) ** 2)

    @property
    def area(self) -> float:
        """Area inside the edge."""
        return math.pi * float(np.arange(self.edge.size) @ self.edge**2)


def direct(z: Complexes, source: Complexes) -> Floats:
    """Return the influence of forces on a free half-space."""
    return np.asarray(1.0 / (math.pi * np.abs(z[:, None] - source)))


def undisturbed(z: Complexes) -> Floats:
    """Return 0, the displacement of a surface that nothing else loads."""
    return np.zeros(z.shape)


def press(
    indenter: Indenter,
    outside: Displacement = undisturbed,
    images: Influence | None = None,
    degree: int = DEGREE,
    start: Contact | None = None,
) -> Contact:
    """Return the contact of an indenter on a surface that is displaced by ``outside`` already.

    ``images`` of the contact load the surface as the contact itself does. ``degree`` of the polynomials says how fine
    it is. With an odd exponent the tip is not smooth, and the error falls slowly. OutOfRange where Newton's method does
    not converge.
    """
    disc = disc_of(degree)
    whole = disc.whole

    def wanted(edge: Floats) -> Floats:
        z, _ = evaluate(edge, disc.points)
        return np.asarray(indenter.approach - indenter.slope * np.abs(z) ** indenter.exponent - outside(z))

    def imaged(edge: Floats, modes: Floats) -> Floats | float:
        if images is None:
            return 0.0
        position, area = evaluate(edge, whole.zeta)
        influence = images(evaluate(edge, disc.points)[0], position) * (whole.weight * area)
        return np.asarray(influence @ modes)

    def mismatch(edge: Floats, amplitudes: Floats) -> Floats:
        return np.asarray(
            disc.own_displacement(edge, amplitudes) + imaged(edge, whole.modes @ amplitudes) - wanted(edge)
        )

    if start is None:
        edge = np.zeros(degree + 4)
        edge[1] = indenter.lone_radius
        amplitudes = np.asarray(np.linalg.lstsq(disc.own_displacement(edge), wanted(edge), rcond=None)[0], dtype=float)
    else:
        edge, amplitudes = start.edge.copy(), np.asarray(start.amplitudes, dtype=float)
    free = np.array([0, 1, *range(3, edge.size)])
    for _ in range(_MAX_ITERATIONS):
        left = mismatch(edge, amplitudes)
        step = _DIFFERENCE * edge[1]
        by_edge = [(mismatch(edge + step * unit, amplitudes) - left) / step for unit in np.eye(edge.size)[free]]
        by_pressure = disc.own_displacement(edge) + imaged(edge, whole.modes)
        jacobian = disc.root_weight[:, None] * np.column_stack((by_pressure, *by_edge))
        change = np.linalg.lstsq(jacobian, -disc.root_weight * left, rcond=None)[0]
        amplitudes = amplitudes + change[: amplitudes.size]
        edge[free] += change[amplitudes.size :]
        if np.abs(change[amplitudes.size :]).max() <= _RTOL_STEP * edge[1]:
            break
    else:
        raise OutOfRange(f"degree is {degree}: the edge of the contact is not found")
    position, area = evaluate(edge, whole.zeta)
    load = whole.weight * area * (whole.modes @ amplitudes)
    return Contact(edge, amplitudes, position, load, float(np.abs(left).max()) / indenter.approach)


def equal_pair(indenter: Indenter, distance: float, degree: int = DEGREE) -> Contact:
    """Return the contact of either of two equal indenters, in coordinates whose x points to the other."""
    return press(indenter, images=lambda z, source: direct(z, distance - source.conj()), degree=degree)


def pair(first: Indenter, second: Indenter, distance: float, degree: int = DEGREE) -> tuple[Contact, Contact]:
    """Return both contacts of two indenters at ``distance``, each in coordinates whose x points to the other.

    OutOfRange where they do not come to rest.
    """

    def pressed(indenter: Indenter, other: Contact, start: Contact) -> Contact:
        return press(
            indenter, lambda z: direct(z, distance - other.position.conj()) @ other.load, degree=degree, start=start
        )

    one, two = press(first, degree=degree), press(second, degree=degree)
    for _ in range(_MAX_SWEEPS):
        before = one.force
        one = pressed(first, two, one)
        two = pressed(second, one, two)
        if abs(one.force - before) <= _RTOL_FORCE * before:
            return one, two
    raise OutOfRange(f"distance is {distance:g}: the two contacts do not come to rest")
