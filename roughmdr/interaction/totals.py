"""The totals of coupled asperities at one separation, with the error that contacts near to each other leave.

Where they do not overlap it falls off as a power of their distance: what an order leaves out. Where they do, it grows
with how far they reach into each other. A contact that reaches to where the flank of a buried summit comes out is no
disc either. Against boundary elements of ensembles (``pipelines/study.py versus_bem``). Where neighbours tilt the
surface so that a contact does not reach the whole edge of its tip, its load is a little too large (``tip_edge.py``).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction import close
from roughmdr.interaction.neighbours import within_reach
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.numerics.arguments import Floats

_NEAR: dict[int, tuple[float, float]] = {1: (0.02, 3.0), 2: (0.004, 6.0)}
"""Error by a neighbour that touches, and the power of distance over summed radii with which it falls, by order."""
_OVERLAP = 0.45
"""Error by a neighbour over 1 - D/(a + a'), the depth of the overlap."""
_BURIED = 0.22
"""Error by a buried summit over 1 - r/a, r where its flank comes out."""
_PARTIAL = 0.4
"""Error of a tilted flat-ended punch over (1 - a/b)^(3/2), b its radius (``tests/interaction/test_tip_edge.py``)."""
_FARTHEST = 2.5
"""Distance over summed radii beyond which neighbours are left out."""

_HERTZ = 16.0 / (3.0 * math.pi)
"""Radius of a contact over the mean distance of its load from the axis, under Hertz's pressure."""

CROWDING = "crowding"
"""Asks for it among the names of variables."""


class Overlap(NamedTuple):
    """Contacts that overlap a neighbour's, or are near to one."""

    contacts: int
    share: float
    """Share of the force of contacts that overlap."""
    crowding: float = 0.0
    """About the error of the force by contacts near to each other [1]; 0 where it is not asked for."""


class Step(NamedTuple):
    """The totals at one separation, in SI."""

    force: float = 0.0
    radius_sum: float = 0.0
    area: float = 0.0
    stiffness: float = 0.0
    contacts: int = 0
    error: float = 0.0
    """About that of the force [N]; inf where there is no equilibrium."""
    overlap: Overlap = Overlap(0, 0.0)
    lost: int = 0
    """Number of contacts that are no discs."""
    energy: float = 0.0
    dissipated: float = 0.0
    """By all jumps up to here."""
    by_machine: float = 0.0
    """The part of it that a machine loses."""
    conductance: float = 0.0
    """The conductance radius."""
    doubted: float = 0.0
    """Pull-off forces, each alone, of asperities out of contact that attraction with a range may have pulled on, and of
    contacts that overlap."""
    held: float = 0.0
    """Pull-off forces of all other contacts."""
    area_error: float = 0.0
    """About that of the area of a grid at given force [m2]."""
    spread_area: float = 0.0
    """``spread_area`` of the contacts under a curved body [m2]; 0 under a flat."""
    nominal_radius: float = 0.0
    """Effective radius of the load of the contacts that push about the axis of a curved body; 0 under a flat."""


def total(
    placed: Placed,
    touching: NDArray[np.bool_],
    radius: Floats,
    load: Floats,
    pairs: close.Pairs,
    names: set[str],
    punch: Floats | None = None,
) -> Step:
    """Return what follows from the contacts of the highest asperities, with the error of a relative one of 1.

    The crowding is there where ``names`` asks for it; ``punch`` as ``whole`` of that.
    """
    sizes = math.fsum(np.abs(load[touching]).tolist())
    overlapping, length = np.zeros(touching.size, np.bool_), placed.length
    close.mark_overlaps(pairs, np.where(touching, radius, 0.0), overlapping)
    share = float(np.abs(load[overlapping]).sum()) / sizes if sizes > 0.0 else 0.0
    near = 0.0
    if CROWDING in names:
        at, emerging = placed.at[: load.size], placed.emerging[: load.size]
        near = crowding(
            at, radius, np.where(touching, load, 0.0), placed.sides, emerging, placed.interaction.order, punch
        )
    area, about = radius[touching] ** 2, (0.0, 0.0)
    if placed.axis is not None:
        at = placed.at[: load.size][touching]
        about = spread_area(at, area), _load_radius(at - placed.axis, load[touching])
    return Step(
        placed.force_unit * math.fsum(load[touching].tolist()),
        length * math.fsum(radius[touching].tolist()),
        math.pi * length * length * math.fsum(area.tolist()),
        contacts=int(np.count_nonzero(touching)),
        error=placed.force_unit * sizes,
        overlap=Overlap(int(overlapping.sum()), share, near),
        spread_area=length * length * about[0],
        nominal_radius=length * about[1],
    )


def spread_area(at: Floats, area: Floats) -> float:
    """Return the area of the disc on which contacts of these areas and positions would be evenly spread.

    It is 2 pi times the mean square distance from their middle, each by its area: the disc itself where they are spread
    evenly. Their area over it is the contact fraction where they are: the mean of the local one by contact area if that
    is a Gaussian of the distance, and 1.11 times this mean if it goes as Hertz's pressure does.
    """
    if not area.size:
        return 0.0
    weight = area / area.sum()
    return 2.0 * math.pi * float(weight @ np.square(at - weight @ at).sum(axis=1))


def _load_radius(at: Floats, load: Floats) -> float:
    """Return the effective radius of the loads that push at positions from an axis; 0 where none does."""
    pushing = np.maximum(load, 0.0)
    whole = float(pushing.sum())
    return _HERTZ * float(pushing @ np.hypot(*at.T)) / whole if whole > 0.0 else 0.0


def of_all(placed: Placed, touching: NDArray[np.bool_], radius: Floats, load: Floats) -> tuple[Floats, Floats]:
    """Return contact radii [m] and forces [N] of all asperities, those that are buried among them."""
    kept, (radii, forces) = placed.kept[: touching.size], np.zeros((2, placed.total))
    radii[kept] = np.where(touching, radius, 0.0) * placed.length
    forces[kept] = np.where(touching, load, 0.0) * placed.force_unit
    return radii, forces


def crowding(
    at: Floats,
    radius: Floats,
    load: Floats,
    sides: Floats | None,
    emerging: Floats,
    order: int,
    whole: Floats | None = None,
) -> float:
    """Return about the relative error of the force of contacts by those near to each other, at low contact fractions.

    Positions [asperity, 2], contact radii, ``sides`` of a patch that repeats and the radii from which on the flanks of
    buried summits are in a contact, in one unit; loads in any, 0 out of contact. ``whole`` are the radii with the whole
    edge of their tips in contact, where they may be larger.
    """
    on = np.flatnonzero(load)
    if not on.size:
        return 0.0
    a, share = radius[on], np.abs(load[on]) / np.sum(np.abs(load[on]))
    total = _BURIED * float(np.sum(share * np.maximum(1.0 - emerging[on] / a, 0.0)))
    if whole is not None:
        total += _PARTIAL * float(np.sum(share * np.maximum(1.0 - a / whole[on], 0.0) ** 1.5))
    touching, power = _NEAR[order]
    for i, j, away in within_reach(at[on], 2.0 * _FARTHEST * a, sides):
        apart = away / (a[i] + a[j])
        error = touching * np.maximum(apart, 1.0) ** -power + _OVERLAP * np.maximum(1.0 - apart, 0.0)
        once = ((a[j] < a[i]) | ((a[j] == a[i]) & (j < i))) & (apart < _FARTHEST)
        total += float(np.sum(np.where(once, error * (share[i] + share[j]), 0.0)))
    return total
