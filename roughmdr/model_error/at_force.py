"""The errors of contact area, stiffness and contact radii at given force, from that of the force at given separation.

A law whose force is off by a shift of the separation alone has no other error at given force: what is left there is how
the contacts share the load. Errors at any other given quantity follow from these and from the slopes of the law.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Origin
from roughmdr.model_error.coupling import coupling_error, summits_error
from roughmdr.model_error.interaction import ASPERITIES, HILLS, MOST_TENSION, SUMMITS, interaction_error
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import CONDUCTANCES, ORIGINS

AREA, STIFFNESS, CONDUCTANCE, RADIUS_SUM = range(4)
"""Quantities with an error of their own at given force, in the order of ``Method.errors``."""
QUANTITIES = {
    "contact_area": AREA,
    "contact_fraction": AREA,
    "stiffness": STIFFNESS,
    "conductance_radius": CONDUCTANCE,
    **dict.fromkeys(CONDUCTANCES, CONDUCTANCE),
    "contact_radius_sum": RADIUS_SUM,
}
"""Quantity that each variable of a law is proportional to."""


NAMES = ("contact_area", "stiffness", "conductance_radius", "contact_radius_sum")
"""Variables that stand for the quantities."""


class AtForce(NamedTuple):
    """The relative error of a quantity at given force: share I + constant + root sqrt(f).

    I is the relative error of the force at given separation by interaction, f the contact fraction.
    """

    share: float
    constant: float = 0.0
    root: float = 0.0


class ByInteraction(NamedTuple):
    """Errors by interaction of the force at given separation [1]."""

    own: Floats
    elastic: Floats
    """The error if contacts of these radii were elastic."""
    softness: Floats | float
    """Share that yielding has left of it, but for flanks of summits."""


class Method(NamedTuple):
    """Errors of one way to compute a law, against boundary elements (``pipelines/study.py at_pressure``)."""

    interaction: Callable[[Floats], Floats]
    """Return a multiple of the error by interaction at contact fractions, for results that hold its largest alone."""
    errors: tuple[AtForce, AtForce, AtForce, AtForce]
    """Errors of the quantities ``NAMES`` at given force."""


def _constant(fraction: Floats) -> Floats:
    return np.where(fraction > 0.0, 1.0, 0.0 * fraction)


METHODS: dict[tuple[Origin, bool], Method] = {
    ("asperities", False): Method(
        partial(interaction_error, coefficients=ASPERITIES),
        (AtForce(0.36), AtForce(0.95), AtForce(0.95), AtForce(0.58)),
    ),
    ("asperities", True): Method(
        lambda fraction: np.asarray(fraction**1.5),
        (AtForce(0.5, root=0.08), AtForce(3.5, root=0.03), AtForce(1.0, root=0.03), AtForce(0.5, root=0.06)),
    ),
    ("summits", False): Method(
        partial(interaction_error, coefficients=SUMMITS),
        (AtForce(0.0, 0.2, 0.3), AtForce(0.9), AtForce(0.9), AtForce(0.0, 0.15, 1.8)),
    ),
    ("summits", True): Method(
        partial(summits_error, origin="summits"),
        (AtForce(0.0, 0.2, 0.3), AtForce(0.75), AtForce(0.75), AtForce(0.0, 0.15, 1.8)),
    ),
    ("hills", False): Method(partial(interaction_error, coefficients=HILLS), (AtForce(1.0),) * 4),
    ("hills", True): Method(
        _constant, (AtForce(1.0, 0.02, 0.4), AtForce(1.0), AtForce(1.0, root=0.1), AtForce(1.0, root=3.0))
    ),
}
"""Methods by the origin of the asperities, and whether they are coupled in pairs."""
_ON_GRID = Method(_constant, (AtForce(1.0, 0.02), AtForce(1.0, 0.01), AtForce(1.0, 0.01), AtForce(1.0, 0.02)))
"""Boundary elements in place of pairs: what flanks of summits cost, and about the error of the grid."""


_SOFTENING, _FLOWING = 0.125, 2.0
"""Power of the contact fraction with which contacts that yield become softer, typically; power of the softness with
which the area at given force loses the error of elastic contacts (``pipelines/study.py versus_saturated``)."""
_LEAST_TABOR, _DMT = 1e-9, 1.0 / 3.0
"""Tabor number below which nothing changes; error of JKR's pull-off force there, where Derjaguin, Muller and Toporov's
holds, which is 4/3 of it.
"""
_RANGE, _RANGE_POWER = 0.123, 1.3
"""Error of the pull-off force of JKR at Tabor number 1, and the power with which it falls: 5 % at 2, 1.2 % at 6 of
contacts in pairs (``pipelines/study.py versus_adhesive_bem``)."""
RELEASING = 2.5
"""Error of the force of contacts near their release, over that of their pull-off force: 2.0 to 2.6 of one paraboloid by
Dugdale's adhesion at Tabor numbers of 1 to 3. On rough surfaces some are near it at the largest tension."""
_BY_RANGE = (2.0, 0.5, 1.0, 1.0)
"""Errors of the quantities ``NAMES`` at given force by the range, over that of the pull-off force of one contact: JKR
counts some of the attracted rim as contact. That of the stiffness is at zero load."""
_FADING = 0.25
"""Power of the pull-off forces over the load with which these errors fall beyond: one paraboloid has 0.28."""
_PULLED = 0.07
"""Error of half of the pull-off force of independent contacts, over the error of the force by interaction, typically:
towards the largest tension the stiffness goes to 0 as the distance from it."""
_PULL_OFF: dict[tuple[Origin, bool], Callable[[Floats], Floats]] = {
    ("asperities", False): lambda fraction: MOST_TENSION * np.sqrt(fraction),
    ("asperities", True): lambda fraction: coupling_error(fraction, np.zeros_like(fraction)),
    ("summits", False): lambda fraction: MOST_TENSION * np.sqrt(fraction) + summits_error(fraction, "summits"),
    ("summits", True): partial(summits_error, origin="summits"),
    ("hills", False): np.ones_like,
    ("hills", True): lambda fraction: np.full_like(fraction, 0.5),
}
"""Errors of the pull-off force by interaction over its contact fraction, by the methods: of hills the worst but one of
40 maps (``pipelines/study.py adhesive_hills``)."""


def range_error(tabor: Floats | float) -> Floats:
    """Return the relative error of JKR's pull-off force [1] by the range of the attraction; NaN for an unknown one."""
    return np.minimum(_RANGE / np.maximum(tabor, _LEAST_TABOR) ** _RANGE_POWER, _DMT)


def by_range(of_force: Floats, tabor: Floats, largest: Floats) -> Floats:
    """Return the error by the range of quantities at given force, in ``_BY_RANGE`` [1], from that of the force.

    ``largest`` is the largest force over the load. Where the Tabor number is not known it is that of the force alone.
    """
    alone, over_load = range_error(tabor), of_force * largest
    share = np.minimum(over_load / np.maximum(alone, np.finfo(np.float64).tiny), 1.0) ** _FADING
    found = np.where(np.isfinite(tabor), alone * share, over_load)
    return np.where(of_force > 0.0, np.minimum(found, _DMT), 0.0 * of_force)


def relative_at_force(
    interaction: ByInteraction,
    fraction: Floats,
    others: Sequence[Floats],
    of_range: Floats,
    left: Floats,
    *known: Floats,
) -> list[Floats]:
    """Return the relative errors [1] of the quantities at given force, at most 1: [...] each.

    ``fraction`` is the contact fraction, ``others`` are all other parts of each error but that by the range of
    adhesion: ``of_range`` is that of the pull-off force of JKR, ``left`` the distance of the force from the largest
    tension, over it, at most 1. ``known`` are the code of ``ORIGINS`` and the points of a grid, 0 of pairs, NaN of
    independent contacts: arrays that go together. NaN where an error is not known.
    """
    by_own, elastic, softness = interaction
    shape = np.broadcast_shapes(*(each.shape for each in (by_own, fraction, *others, left, *known)))
    found = [np.full(shape, np.nan) for _ in NAMES]
    for method, own in _methods(*known):
        for quantity, (share, constant, root) in enumerate(method.errors):
            shared = by_own != 0.0  # not so the load of a lone asperity
            kept = softness**_FLOWING if quantity == AREA else 1.0
            by_force = elastic if quantity == CONDUCTANCE else by_own  # patches conduct as if they were elastic
            along = share * by_force + shared * kept * constant + shared * kept * root * np.sqrt(fraction)
            np.copyto(found[quantity], along + others[quantity] + _BY_RANGE[quantity] * of_range, where=own)
    found[STIFFNESS] = found[STIFFNESS] + (1.0 / left - 1.0) * (_BY_RANGE[STIFFNESS] * of_range + _PULLED * by_own)
    touching = np.where(fraction > 0.0, 1.0, 0.0 * fraction)
    return [np.minimum(error, 1.0) * touching for error in found]


def interaction_along(
    largest: Floats, fraction: Floats, largest_fraction: Floats, origin: Floats, grid: Floats
) -> Floats:
    """Return the error by interaction [1] at a contact fraction, from the ``largest`` of a path and the fraction there.

    It is for results that store the largest alone.
    """
    found = np.full(np.broadcast_shapes(largest.shape, fraction.shape, origin.shape, grid.shape), np.nan)
    for method, own in _methods(origin, grid):
        here, there = np.broadcast_arrays(method.interaction(fraction), method.interaction(largest_fraction))
        share = np.divide(here, there, out=np.zeros(here.shape), where=there > 0.0)
        np.copyto(found, largest * share, where=own)
    return found


def softened(
    largest: Floats, softness: Floats, fraction: Floats, largest_fraction: Floats, origin: Floats, grid: Floats
) -> ByInteraction:
    """Return errors by interaction of independent contacts that yield, as ``interaction_along``.

    ``softness`` is that at the largest contact fraction, towards which contacts become softer, slowly; NaN where they
    are elastic.
    """
    along = interaction_along(largest, fraction, largest_fraction, origin, grid)
    here, there = (_elastic(each, origin, grid) for each in (fraction, largest_fraction))
    flanks = np.where(origin == ORIGINS.index("summits"), summits_error(fraction, "summits"), 0.0)
    lighter = (largest_fraction / np.where(fraction > 0.0, fraction, np.inf)) ** _SOFTENING
    soft = np.where(np.isnan(softness), 1.0, np.minimum(softness * lighter, 1.0))
    own = np.where(largest > there, along, flanks + soft * (here - flanks)) * (largest > 0.0)
    return ByInteraction(own, np.maximum(own, here * (largest > 0.0)), soft)


def _elastic(fraction: Floats, origin: Floats, grid: Floats) -> Floats:
    """Return the error by interaction [1] of independent elastic contacts at a contact fraction."""
    found = np.full(np.broadcast_shapes(fraction.shape, origin.shape, grid.shape), np.nan)
    for method, own in _methods(origin, grid):
        np.copyto(found, method.interaction(fraction), where=own)
    return found


def pull_off_error(
    fraction: Floats, tabor: Floats, interaction: Floats, slope: Floats, origin: Floats, grid: Floats
) -> Floats:
    """Return the relative error of the pull-off force [1], at most 1, from the contact fraction and Tabor number there.

    ``interaction`` and ``slope`` are these parts of the model error, the largest of the path. Nothing is known of a
    range that is not given: NaN for the ``tabor`` number.
    """
    of_range = np.minimum(np.nan_to_num(RELEASING * range_error(tabor)), _DMT)
    found = np.full(np.broadcast_shapes(fraction.shape, origin.shape, grid.shape), np.nan)
    for (kind, pairs), error in _PULL_OFF.items():
        own = (origin == ORIGINS.index(kind)) & (np.isfinite(grid) == pairs)
        np.copyto(found, error(fraction), where=own)
    return np.minimum(np.hypot(np.where(interaction > 0.0, found, 0.0 * interaction), of_range) + slope, 1.0)


def _methods(origin: Floats, grid: Floats) -> Iterator[tuple[Method, NDArray[np.bool_]]]:
    """Yield the methods of the runs, and which runs are computed by each."""
    for (kind, pairs), method in METHODS.items():
        own = (origin == ORIGINS.index(kind)) & ((grid == 0.0) if pairs else np.isnan(grid))
        if own.any():
            yield method, own
    if (grid > 0.0).any():
        yield _ON_GRID, np.broadcast_to(grid > 0.0, np.broadcast_shapes(origin.shape, grid.shape))
