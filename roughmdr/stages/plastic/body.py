"""Body: the constants of bodies that yield, and the numbers of each asperity that follow from them."""

import math
from functools import partial
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import TooMuchContact
from roughmdr.kernels.closed import jkr_paraboloid as jkr
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

# Rows of the numbers of an asperity.
RADIUS, CRITICAL, LIMIT, SQUARE, BEFORE, DEPTH, TIP, PULL, STIFFNESS_AT_TIP = range(9)
"""Radius R [m], or what else the shape is made of; critical indentation [m] of fitted formulas; indentation at which a
contact yields [m], the square of its radius there [m2] and the energy that it stores there [J]; scales of its JKR
contact before: depth [m], radius [m], force [N] and stiffness [N/m]."""
ROWS = 9


class Body(NamedTuple):
    """The bodies in contact, one of which yields."""

    effective_modulus: float
    """E* [Pa]."""
    yield_strength: float
    """Y [Pa]."""
    work: float
    """Work of adhesion [J/m2]."""
    poisson: float
    """Poisson's ratio of the body that yields; NaN where no model needs it."""
    shear_modulus: float
    """Its shear modulus [Pa] where asperities are spheres of their own; infinite on a half-space."""
    squared: float
    """1 for spheres, whose section at depth d has the area pi (2 R d - d^2); 0 for paraboloids."""


class Mark(NamedTuple):
    """The mark that the deepest indentation has left in an asperity.

    By "mdr": radius b [m] and profile height H [m] of the dent, and how far the flat moves over its springs [1]. By the
    fits: force [N] and radius [m] at that indentation, and the indentation [m] that is left.
    """

    first: float
    second: float
    third: float


class State(NamedTuple):
    """A contact."""

    force: float
    """[N]"""
    radius: float
    """[m]"""
    stiffness: float
    """dF/d(indentation) [N/m]: of more yielding where ``rise`` is 0, elastic elsewhere."""
    stored: float
    """Elastic energy less that of adhesion [J]."""


class PlasticKernels(ModuleType):
    """Kernels of a contact that yields: compiled functions of an ``asperity``, ``ROWS`` numbers in a row."""

    parameter: str = "radius"
    """Name of what a shape is made of, which is in the first row."""
    round: bool = True
    """Whether asperities are spheres or paraboloids, whose models end at some depth and width over the radius."""
    adhesive: bool
    kinks: tuple[float, ...]
    """Indentations over ``LIMIT`` where the law of deeper contacts has kinks or jumps; the last is infinite."""
    load: Any
    """(deepest, asperity, body) -> force [N] and radius [m] of a contact that yields, where formulas are fitted."""
    prepare: Any
    """(asperity, body) -> None: fill the row behind its radius."""
    mark: Any
    """(deepest, asperity, body) -> Mark that a deepest indentation [m] leaves."""
    ends: Any
    """(deepest, mark, asperity, body) -> rises of the flat [m] since then at which contact is made again and lost."""
    state: Any
    """(indentation, rise, mark, asperity, body) -> State at an indentation and a rise of the flat [m]."""
    lost: Any
    """(deepest, mark, asperity, body) -> energy [J] that has gone into yielding."""


NO_MARK = Mark(0.0, 0.0, 0.0)
"""Mark of an asperity that has not yielded."""
JUST_RISEN = 5e-324
"""Rise [m] of a flat that has been as low before, next to none: contacts are elastic there."""
_DEEPEST = 0.9  # indentation over the radius beyond which the force of "mdr" on spheres falls
_WIDEST = 0.41  # contact radius over that of the asperity up to which Jackson and Green fitted their formulas


@partial(njit, small=True)
def hertz(indentation: float, asperity: Floats, body: Body) -> State:
    """A contact that has not yielded, under an indentation [m]: F = 4/3 E* sqrt(R) d^(3/2), a = sqrt(R d)."""
    depth = max(indentation, 0.0)
    radius = math.sqrt(asperity[RADIUS] * depth)
    stiffness = 2.0 * body.effective_modulus * radius
    force = stiffness * depth / 1.5
    return State(force, radius, stiffness, 0.4 * force * depth)


@partial(njit, small=True)
def elastic(indentation: float, asperity: Floats, body: Body) -> State:
    """The contact of a paraboloid that has not yielded: Hertz, or JKR."""
    if body.work > 0.0:
        v = jkr.state(max(1.0 + indentation / asperity[DEPTH], 0.0), 2.0)
        slope = jkr.stiffness(v if v > 0.0 else 1.0, 2.0)
        return State(
            asperity[PULL] * jkr.force(v, 2.0),
            asperity[TIP] * jkr.radius(v, 2.0),
            asperity[STIFFNESS_AT_TIP] * (slope if v > 0.0 else -math.inf),
            asperity[PULL] * asperity[DEPTH] * jkr.energy(v, 2.0),
        )
    return hertz(indentation, asperity, body)


@njit
def fill_elastic(height: Floats, separation: float, rows: Floats, body: Body, found: Floats) -> None:
    """Fill in contacts as if none had yielded, [number of ``State``, asperity]: a loop that becomes vector code."""
    for i in range(height.size):
        found[0, i], found[1, i], found[2, i], found[3, i] = elastic(height[i] - separation, rows[i], body)


def check_depth(kernels: PlasticKernels, deepest: Floats, rows: Floats) -> None:
    """Raise TooMuchContact where round asperities that yield, [asperity, row], are pressed too deep [m]."""
    if not kernels.round:
        return
    beyond = np.where(deepest > rows[:, LIMIT], deepest / rows[:, RADIUS], 0.0)
    if (beyond > _DEEPEST).any():
        worst = int(np.argmax(beyond))
        raise TooMuchContact(
            f"an asperity with a radius of {rows[worst, RADIUS]:g} m yields under an indentation of {deepest[worst]:g} "
            f"m; with [plasticity] it must be at most {_DEEPEST:g} of the radius"
        )


def range_warnings(kernels: PlasticKernels, contact_radius: Floats, rows: Floats) -> tuple[str, ...]:
    """Warn of contacts, whose radii [m] are given, that are wider than models of yielding were fitted to."""
    told = f"contacts wider than {_WIDEST:g} of the radius of their asperity, where fits of yielding end"
    return (told,) if kernels.round and (contact_radius > _WIDEST * rows[:, RADIUS]).any() else ()
