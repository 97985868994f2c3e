"""What one contact bears on each of its stable branches, as tables over the root of the distance to where it begins.

With x the reduced distance to the onset of contact and x = foot + s^2, every quantity times 2 s is smooth in s even at
a fold, where the stiffness runs off as 1/s; and 2 s ds is dx.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.totals import AREA, COUNT, ENERGY, FORCE, RADIUS, STIFFNESS
from roughmdr.arguments import Floats
from roughmdr.contact import Contact
from roughmdr.ensemble.nodes import Heights
from roughmdr.expected.table import Table
from roughmdr.kernels import row as places
from roughmdr.kernels.elementwise import apply, apply_all

_TOLERANCE, _TOLERANCE_STIFFNESS = 2e-12, 1e-10
"""Of the greatest value on a piece: about what the kernels themselves are right to away from a fold."""
_FOLD = 2.0**-9  # in s: a fold is smooth on its own scale, 1, and nearer to it roundings are seen
_GROWTH = 2.0  # from one piece to the next, where contacts that reach differently far share a curve
_LAST_BITS = 2.0**-44
_NEAREST = 1e-7  # of the width of the heights: what is less deep adds nothing


class Curve(NamedTuple):
    """The tables of all branches of one contact, one after the other; rows over their natural scales, times 2 s."""

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

    Contacts that differ in their scales alone share one.
    """
    ranges = np.array(
        [
            (max((own.high - deepest) / contact.depth[0], 0.0) + 1.0, _NEAREST * own.scale / contact.depth[0])
            for contact, own in zip(contacts, heights, strict=True)
        ]
    )
    forms = [np.asarray(contact.form).tobytes() for contact in contacts]
    curves = {}
    for form in dict.fromkeys(forms):
        alike = [number for number, other in enumerate(forms) if other == form]
        reaches, nearest = ranges[alike, 0], float(ranges[alike, 1].min())
        curves[form] = _curve(contacts[alike[0]], float(reaches.min()), float(reaches.max()), nearest, rows)
    return [curves[form] for form in forms]


def _curve(contact: Contact, least: float, farthest: float, nearest: float, rows: tuple[int, ...]) -> Curve:
    """Up to the reduced distance ``farthest``, from as near the onset as ``nearest``.

    Of the contacts that share the curve some reach no farther than ``least``.
    """
    tolerance = np.array([_TOLERANCE_STIFFNESS if row == STIFFNESS else _TOLERANCE for row in rows])
    finest = _FOLD if contact.law.adhesive else math.sqrt(nearest)

    def narrow(low: Floats, high: Floats) -> Floats:
        return np.where(low <= finest, finest, _LAST_BITS * high)

    def weight(low: Floats, high: Floats) -> Floats:
        return (high - low) / high

    branches, tables = _branches(contact, farthest), []
    for rung, (foot, top) in enumerate(branches, start=1):

        def bears(s: Floats, rung: int = rung, foot: float = foot) -> Floats:
            return _quantities(contact, s, foot, rung, rows)

        tables.append(Table.of(bears, _edges(math.sqrt(least), math.sqrt(top - foot)), tolerance, narrow, weight))
    first = np.cumsum([0, *(table.low.size for table in tables)])
    merged = Table(*(np.concatenate(parts) for parts in zip(*tables, strict=True)))
    return Curve(first, np.array([foot for foot, _ in branches]), merged)


def _edges(least: float, top: float) -> Floats:
    """From 0 to ``top``, in steps that grow from ``least``.

    A piece is right to its greatest value: one that reaches far beyond ``least`` would be wrong below it.
    """
    edges = [top]
    while edges[-1] > _GROWTH * least:
        edges.append(edges[-1] / _GROWTH)
    return np.array([0.0, *reversed(edges)])


def _branches(contact: Contact, farthest: float) -> list[tuple[float, float]]:
    """Where each branch begins and ends, in x."""
    if not contact.law.branched:
        return [(0.0, farthest)]
    row = contact.form
    count = int(row[places.COUNT])
    feet = np.maximum(row[places.FOOT_X : places.FOOT_X + count], 0.0).tolist()
    tops = row[places.TOP_X : places.TOP_X + count - 1].tolist()
    return list(zip(feet, [*tops, max(farthest, feet[-1] + 1.0)], strict=True))


def _quantities(contact: Contact, s: Floats, foot: float, rung: int, rows: tuple[int, ...]) -> Floats:
    """The wanted quantities at s: [row, s]."""
    law, form = contact.law, contact.form
    x = foot + s * s
    if law.branched and law.state_on is not None:
        state = apply(law.state_on, x, float(rung), form)
    else:
        state = apply(law.state, x, form)
    if law.answer is not None:
        radius, force, stiffness = apply_all(law.answer, state, form)
    else:
        radius, force, stiffness = (apply(kernel, state, form) for kernel in (law.radius, law.force, law.stiffness))
    found = {
        FORCE: force,
        RADIUS: radius,
        AREA: radius * radius,
        STIFFNESS: stiffness,
        COUNT: np.where(radius > 0.0, 1.0, 0.0),
    }
    if ENERGY in rows:
        found[ENERGY] = apply(law.energy, state, form)
    return np.array([2.0 * s * found[row] for row in rows])
