"""What one contact bears on each of its stable branches, as tables over the root of the distance to where it begins.

With x the reduced distance to the onset of contact and x = foot + s^2, every quantity is smooth in s even at a fold,
but for the stiffness, which runs off as 1/s: of that 2 s times it is tabulated.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.totals import AREA, COUNT, ENERGY, FORCE, RADIUS, STIFFNESS
from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Heights
from roughmdr.errors import OutOfRange
from roughmdr.expected.table import Table
from roughmdr.kernels.elementwise import apply, apply_all
from roughmdr.kernels.profile import layout as places
from roughmdr.numerics.arguments import Floats

_TOLERANCE, _TOLERANCE_STIFFNESS = 2e-12, 1e-10
"""Of the greatest value on a piece: about what the kernels themselves are right to away from a fold."""
_FOLD = 2.0**-9  # in s: a fold is smooth on its own scale, 1, and nearer to it roundings are seen
_LAST_BITS = 2.0**-44
# Of the width of the heights: where what is less deep adds nothing, and where without adhesion the first piece ends.
_NEAREST, _SHALLOW = 1e-7, 1e-2
_ALIKE = math.log(1e6)  # heights that differ less beside the depths of their contacts
_WIDER, _MOST_EDGES = 4.0, 100  # how much wider than the one before it a piece may be at first


class Curve(NamedTuple):
    """The tables of all branches of one contact, one after the other; rows over their natural scales, the stiffness
    times 2 s.
    """

    first: NDArray[np.int64]
    """The first piece of each branch, and the number of all: [branch + 1]."""
    foot: Floats
    """x where each branch begins: [branch]."""
    table: Table


def scales_of(contact: Contact, rows: Sequence[int]) -> Floats:
    """What the rows of a curve are multiplied by."""
    scales = {
        FORCE: contact.force,
        RADIUS: contact.radius,
        AREA: math.pi * contact.radius * contact.radius,
        STIFFNESS: contact.stiffness,
        COUNT: 1.0,
        ENERGY: contact.force * contact.depth[0],
    }
    return np.array([scales[row] for row in rows])


def curves_of(
    contacts: list[Contact], heights: tuple[Heights, ...], deepest: float, rows: tuple[int, ...]
) -> list[Curve]:
    """The curve of each contact, as far as the flat at ``deepest`` [m] presses its highest summit.

    Contacts that differ in their scales alone share one, unless the heights differ much beside them.
    """
    ranges = [
        (max(own.edges[-1] - (deepest - own.origin), own.scale) / contact.depth[0], own.scale / contact.depth[0])
        for contact, own in zip(contacts, heights, strict=True)
    ]
    groups: dict[tuple[bytes, int], list[int]] = {}
    for number, (contact, (_, typical)) in enumerate(zip(contacts, ranges, strict=True)):
        decade = round(math.log(typical) / _ALIKE) if 0.0 < typical < math.inf else 0
        groups.setdefault((np.asarray(contact.params).tobytes(), decade), []).append(number)
    curves: dict[int, Curve] = {}
    for alike in groups.values():
        farthest, typical = max(ranges[number][0] for number in alike), min(ranges[number][1] for number in alike)
        curves |= dict.fromkeys(alike, _curve(contacts[alike[0]], farthest, typical, rows))
    return [curves[number] for number in range(len(contacts))]


def _curve(contact: Contact, farthest: float, typical: float, rows: tuple[int, ...]) -> Curve:
    """Up to the reduced indentation ``farthest``, for heights that are as wide as ``typical``."""
    tolerance = np.array([_TOLERANCE_STIFFNESS if row == STIFFNESS else _TOLERANCE for row in rows])
    adhesive = contact.law.adhesive
    least = _FOLD if adhesive else math.sqrt(_NEAREST * typical)
    first_edge = 1.0 if adhesive else math.sqrt(_SHALLOW * typical)

    def narrow(low: Floats, high: Floats) -> Floats:
        return np.where(low <= least, least, _LAST_BITS * high)

    def weight(low: Floats, high: Floats, _: Floats) -> Floats:
        return (high - low) / high

    feet, tops = branch_ends(contact)
    last = max(farthest + float(adhesive), feet[-1] + 1.0 if adhesive else 0.0)
    tables = []
    for rung, (foot, top) in enumerate(zip(feet, [*tops, last], strict=True), start=1):

        def bears(s: Floats, rung: int = rung, foot: float = foot) -> Floats:
            return _quantities(contact, s, foot, rung, rows)

        # A piece that reaches far higher than another begins would not hold what is small there.
        end = math.sqrt(top - foot)
        if end > first_edge * _WIDER**_MOST_EDGES:
            raise OutOfRange(
                f"the heights reach {farthest:.3g} times the natural depth of {contact.shape}; the expected law "
                f"goes up to {(first_edge * _WIDER**_MOST_EDGES) ** 2:.3g} times, estimator 'sampled' has no such limit"
            )
        edges = [0.0, *(first_edge * _WIDER**k for k in range(_MOST_EDGES) if first_edge * _WIDER**k < end), end]
        tables.append(Table.of(bears, np.array(edges), tolerance, narrow, weight))
    first = np.cumsum([0, *(table.low.size for table in tables)])
    merged = Table(*(np.concatenate(parts) for parts in zip(*tables, strict=True)))
    return Curve(first, np.array(feet), merged)


def branch_ends(contact: Contact) -> tuple[list[float], list[float]]:
    """x where each stable branch begins, and where each but the last ends."""
    row = contact.params
    if not contact.law.branched or row.size < -places.TOP_X:  # the row of a punch has no place for others
        return [0.0], []
    count = int(row[places.COUNT])
    feet = np.maximum(row[places.FOOT_X : places.FOOT_X + count], 0.0).tolist()
    return feet, row[places.TOP_X : places.TOP_X + count - 1].tolist()


def _quantities(contact: Contact, s: Floats, foot: float, rung: int, rows: tuple[int, ...]) -> Floats:
    """The wanted quantities at s, the stiffness times 2 s: [row, s]."""
    law, params = contact.law, contact.params
    x = foot + s * s
    state = apply(law.state_on_branch, x, float(rung), params) if law.branched else apply(law.state, x, params)
    radius, force, stiffness = apply_all(law.radius_force_stiffness, state, params)
    found = {
        FORCE: force,
        RADIUS: radius,
        AREA: radius * radius,
        STIFFNESS: 2.0 * s * stiffness,
        COUNT: np.where(radius > 0.0, 1.0, 0.0),
    }
    if ENERGY in rows:
        found[ENERGY] = apply(law.energy, state, params)
    return np.array([found[row] for row in rows])
