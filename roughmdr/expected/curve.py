"""Force, area and other quantities of one contact on each of its stable branches, tabulated.

x is the reduced distance to the onset of contact. On a branch that begins at x = foot every quantity is smooth in
s = sqrt(x - foot), even at a fold; but the stiffness grows as 1/s there, and is tabulated times 2 s.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.totals import AREA, COUNT, ENERGY, FORCE, RADIUS, STIFFNESS
from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Heights
from roughmdr.errors import OutOfRange
from roughmdr.expected.table import ORDER, AdaptiveTable
from roughmdr.kernels.elementwise import apply, apply_all
from roughmdr.kernels.profile import layout
from roughmdr.numerics.arguments import Floats, Ints

# Of the largest value on a piece: about the error of the kernels themselves away from a fold.
_RTOL, _RTOL_STIFFNESS = 2e-12, 1e-10
_FOLD = 2.0**-9  # in s: a fold is smooth on its own scale, 1, and nearer to it roundings are seen
_ROUNDING = 2.0**-44
_ABOVE_FOLD = 2.0**-52  # in x: the rounding of an indentation, nearer to a fold than which no contact is known to be
_NEGLIGIBLE_INDENTATION = 1e-7  # indentation, over the width of the heights, that does not count
_FIRST_EDGE = 1e-2  # likewise: the indentation at which the first piece ends without adhesion
_LOG_COMMON_RANGE = math.log(1e6)  # heights over depths that differ by less share a table
_GROWTH, _MAX_EDGES = 4.0, 100  # ratio of the ends of neighbouring initial pieces, and their number


class Curve(NamedTuple):
    """The tables of all branches of one contact, one after the other; rows over their natural scales."""

    first: NDArray[np.int64]
    """The first piece of each branch, and the number of all pieces: [branch + 1]."""
    offset: Floats
    """s^2 - indentation/depth: [branch]."""
    table: AdaptiveTable


def scales_of(contact: Contact, rows: Sequence[int]) -> Floats:
    """Return the natural scale of each row."""
    scales = {
        FORCE: contact.force,
        RADIUS: contact.radius,
        AREA: math.pi * contact.radius * contact.radius,
        STIFFNESS: contact.stiffness,
        COUNT: 1.0,
        ENERGY: contact.force * contact.depth[0],
    }
    return np.array([scales[row] for row in rows])


def curves_of(contacts: list[Contact], heights: list[Heights], closest: float, rows: tuple[int, ...]) -> list[Curve]:
    """Return the curve of each contact, up to the indentation of its highest summit by the flat at ``closest`` [m].

    Contacts with equal parameters share one, unless their ranges of heights over depths are very different.
    """
    ranges = [
        (max(own.edges[-1] - (closest - own.origin), own.scale) / contact.depth[0], own.scale / contact.depth[0])
        for contact, own in zip(contacts, heights, strict=True)
    ]
    groups: dict[tuple[bytes, int], list[int]] = {}
    for number, (contact, (_, width)) in enumerate(zip(contacts, ranges, strict=True)):
        magnitude = round(math.log(width) / _LOG_COMMON_RANGE) if 0.0 < width < math.inf else 0
        groups.setdefault((np.asarray(contact.params).tobytes(), magnitude), []).append(number)
    curves: dict[int, Curve] = {}
    for group in groups.values():
        deepest, width = max(ranges[number][0] for number in group), min(ranges[number][1] for number in group)
        curves |= dict.fromkeys(group, _curve(contacts[group[0]], deepest, width, rows))
    return [curves[number] for number in range(len(contacts))]


def curves_to_touch(contacts: list[Contact], fractions: Floats, rows: tuple[int, ...]) -> list[Curve]:
    """Return the curve of each contact with adhesion and one branch from detachment to first touch, on pieces that all
    share; equal parameters have one curve. Those of few asperities are as much less accurate.
    """
    keys = [np.asarray(contact.params).tobytes() for contact in contacts]
    distinct = dict(zip(keys, contacts, strict=True))
    sums = dict.fromkeys(keys, 0.0)
    for key, fraction in zip(keys, fractions.tolist(), strict=True):
        sums[key] += fraction
    shares = np.array(list(sums.values()))
    feet = [branch_ends(contact)[0][0] for contact in distinct.values()]

    def quantities(s: Floats) -> Floats:
        pairs = zip(feet, distinct.values(), strict=True)
        parts = [over_s(quantities_at(contact, foot + s * s, 1, rows), s, rows) for foot, contact in pairs]
        return np.concatenate(parts)

    rtol = np.outer(shares.max() / shares, rtol_of(rows)).ravel().clip(max=1.0)
    low, high, coefficients, errors = tabulate(quantities, (0.0, 1.0), rtol, 1.0, contacts[0])
    shape = low.size, len(distinct), len(rows)
    series = np.ascontiguousarray(coefficients.reshape(*shape, ORDER).swapaxes(0, 1))
    bounds = np.ascontiguousarray(errors.reshape(shape).swapaxes(0, 1))
    first, offsets = np.array([0, low.size]), 1.0 - np.array(feet)
    curves = {
        key: Curve(first, offsets[k : k + 1], AdaptiveTable(low, high, series[k], bounds[k]))
        for k, key in enumerate(distinct)
    }
    return [curves[key] for key in keys]


def _curve(contact: Contact, deepest: float, width: float, rows: tuple[int, ...]) -> Curve:
    """Tabulate up to the indentation ``deepest``, for heights of this width, both over the depth."""
    feet, tops = branch_ends(contact)
    adhesive = contact.kernels.adhesive
    last = max(deepest + float(adhesive), feet[-1] + 1.0 if adhesive else 0.0)
    tables = []
    for branch, (foot, top) in enumerate(zip(feet, [*tops, last], strict=True), start=1):

        def quantities(s: Floats, branch: int = branch, foot: float = foot) -> Floats:
            return over_s(quantities_at(contact, foot + s * s, branch, rows), s, rows)

        tables.append(tabulate(quantities, (0.0, math.sqrt(top - foot)), rtol_of(rows), width, contact))
    first = np.cumsum([0, *(table.low.size for table in tables)])
    merged = AdaptiveTable(*(np.concatenate(parts) for parts in zip(*tables, strict=True)))
    return Curve(first, float(adhesive) - np.array(feet), merged)


def rtol_of(rows: tuple[int, ...]) -> Floats:
    """Return the tolerance of the series of each row."""
    return np.array([_RTOL_STIFFNESS if row == STIFFNESS else _RTOL for row in rows])


def tabulate(
    function: Callable[[Floats], Floats],
    ends: tuple[float, float],
    rtol: Floats,
    width: float,
    contact: Contact,
) -> AdaptiveTable:
    """Tabulate quantities of a contact, or of several like it, s -> [row, s], between two s.

    ``width`` is that of the heights, over the depth. OutOfRange where the heights reach too far.
    """
    adhesive = contact.kernels.adhesive
    nearest = _FOLD if adhesive else math.sqrt(_NEGLIGIBLE_INDENTATION * width)
    first_edge = 1.0 if adhesive else math.sqrt(_FIRST_EDGE * width)

    def min_width(low: Floats, high: Floats) -> Floats:
        return np.where(low <= nearest, nearest, _ROUNDING * high)

    def weight(low: Floats, high: Floats, _: Floats) -> Floats:
        return (high - low) / high

    # On a piece that ends far higher than it begins, small values at its begin would be lost.
    begin, end = ends
    edges = [first_edge * _GROWTH**k for k in range(_MAX_EDGES)]
    if end > first_edge * _GROWTH**_MAX_EDGES:
        raise OutOfRange(
            f"the heights reach {end * end:.3g} times the natural depth of {contact.shape}; the expected law "
            f"goes up to {(first_edge * _GROWTH**_MAX_EDGES) ** 2:.3g} times, estimator 'sampled' has no such limit"
        )
    within = [begin, *(edge for edge in edges if begin < edge < end), end]
    return AdaptiveTable.of(function, np.array(within), rtol, min_width, weight)


def branch_ends(contact: Contact) -> tuple[list[float], list[float]]:
    """Return x where each stable branch begins, and where each but the last ends."""
    params = contact.params
    if not contact.kernels.branched or params.size < -layout.TOP_X:  # params of a punch hold one branch only
        return [0.0], []
    count = int(params[layout.COUNT])
    feet = np.maximum(params[layout.FOOT_X : layout.FOOT_X + count], 0.0).tolist()
    return feet, params[layout.TOP_X : layout.TOP_X + count - 1].tolist()


def quantities_at(contact: Contact, x: Floats, branch: int, rows: tuple[int, ...]) -> Floats:
    """Return the quantities over their natural scales at distances x to the onset, on a branch: [row, x]."""
    kernels, params = contact.kernels, contact.params
    if kernels.branched:
        state = apply(kernels.state_on_branch, x, float(branch), params)
    else:
        state = apply(kernels.state, x, params)
    radius, force, stiffness = apply_all(kernels.radius_force_stiffness, state, params)
    quantities = {
        FORCE: force,
        RADIUS: radius,
        AREA: radius * radius,
        STIFFNESS: stiffness,
        COUNT: np.where(radius > 0.0, 1.0, 0.0),
    }
    if ENERGY in rows:
        quantities[ENERGY] = apply(kernels.energy, state, params)
    return np.array([quantities[row] for row in rows])


def quantities_of(contact: Contact, indentation: Floats, branch: Ints, rows: tuple[int, ...]) -> Floats:
    """Return the quantities [SI] of contacts at indentations [m] on their branches: [row, contact].

    At a fold, where the stiffness is infinite, it is that beside it.
    """
    x = contact.reduced(indentation, contact.depth)
    if STIFFNESS in rows and contact.kernels.adhesive:
        x = np.maximum(x, _ABOVE_FOLD)
    found = np.empty((len(rows), x.size))
    for number in np.unique(branch).tolist():
        on = branch == number
        found[:, on] = quantities_at(contact, x[on], number, rows)
    return np.asarray(scales_of(contact, rows)[:, None] * found)


def over_s(quantities: Floats, s: Floats, rows: tuple[int, ...]) -> Floats:
    """Return quantities [row, s] as they are tabulated: the stiffness times 2 s."""
    return np.array(
        [2.0 * s * values if row == STIFFNESS else values for row, values in zip(rows, quantities, strict=True)]
    )
