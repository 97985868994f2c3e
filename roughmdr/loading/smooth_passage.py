"""The separations of a flat on a machine where the force of all contacts together is smooth in the separation.

On each leg the demand of the flat (``machine.py``) is known at some separations with its slope, and between them by a
cubic. Each demand of the machine is looked for in the first interval, in the sense of the leg, in which the cubic
reaches it; there the law is computed next, for all steps of a leg at once, until nothing moves any more.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange, TooMuchContact
from roughmdr.loading.machine import Leg, Machine, legs_of
from roughmdr.numerics.arguments import Floats

_POINTS = 32  # intervals of a leg at first
_MAX_ROUNDS, _MAX_EXTENSIONS, _MAX_HALVINGS = 30, 200, 8
_GROWTH, _BEYOND = 1.4, 1.05  # largest step down, over the last one and over that by the slope
_RTOL = 1e-13  # length of the last move, over the distance to first touch
_BISECTIONS = 50
_FIRST = 2.0**-6  # depth below first touch at which the flat is tried first, over the depth scale

ForceAndStiffness = Callable[[Floats, Floats], tuple[Floats, Floats]]
"""(turning points [m] of the flat before, separations [m] after them, in one sense) -> force [N], stiffness [N/m].

The stiffness is -dF/dh, NaN where it is not known, as in a mean law, in which contacts are made and lost everywhere.
"""


class Table(NamedTuple):
    """The demand at separations in the order in which the leg goes through them."""

    h: Floats
    demand: Floats
    """Demand, with its sign reversed on legs that rise, so that it falls along the leg."""
    slope: Floats
    """Change of the demand per distance along the leg [1/m]."""


def separations_of(
    law: ForceAndStiffness, demand: Floats, machine: Machine, first_touch: float, clear: float, depth: float
) -> Floats:
    """Return the separation [m] at each demand of a machine whose flat comes from afar; inf where it has flown off.

    At ``first_touch`` [m] and above no contact is made, at ``clear`` [m] and above none is left; ``depth`` [m] is of
    the order of a usual indentation. OutOfRange where no equilibrium is found.
    """
    separation, h = np.empty(demand.size), np.inf
    turns: list[float] = []
    for leg in legs_of(demand):
        parted = h >= clear
        turns = [] if parted else [*turns, h]
        filled = _without_contact(leg, machine, first_touch) if parted else np.full(leg.demand.size, np.nan)
        rest = np.isnan(filled)
        if rest.any():
            search, begin = _Search(law, machine, np.array(turns), leg.rises), first_touch if parted else h
            filled[rest] = search.passages(leg.demand[rest], begin, clear if leg.rises else begin - _FIRST * depth)
        separation[leg.first : leg.first + leg.demand.size] = filled
        h = float(filled[-1])
    return separation


def _without_contact(leg: Leg, machine: Machine, first_touch: float) -> Floats:
    """Return the separations of a flat as long as it meets no contact; NaN where it does."""
    if machine.is_dead_load:
        return np.where((leg.demand > 0.0) | leg.rises, np.inf, np.nan)
    return np.where((leg.demand > first_touch) | leg.rises, leg.demand, np.nan)


class _Search:
    """A leg on which passages are sought."""

    def __init__(self, law: ForceAndStiffness, machine: Machine, turns: Floats, rises: bool) -> None:
        self._law, self._machine, self._turns, self._rises = law, machine, turns, rises

    def passages(self, demand: Floats, begin: float, end: float) -> Floats:
        """Return the separations of a leg from ``begin`` [m]; ``end`` is a first guess of where it ends."""
        sign = -1.0 if self._rises else 1.0
        target = sign * demand
        table = self._to_end(float(target[-1]), begin, end)
        flown = np.zeros(target.size, dtype=np.bool_)
        h = np.full(target.size, np.nan)
        for _ in range(_MAX_ROUNDS):
            before = h
            h, flown = _first_passages(table, target)
            if flown.any():  # all contacts are lost, or nearly all
                h = np.where(flown, np.where(demand > 0.0, np.inf, end) if self._machine.is_dead_load else demand, h)
            moved = ~flown & ~(np.abs(h - before) <= _RTOL * np.abs(h - begin) + 4.0 * np.spacing(np.abs(h)))
            new = np.setdiff1d(h[~flown & moved], table.h)
            if not new.size:
                return h
            table = self._with(table, new)
        raise OutOfRange("path: the separations under the machine do not converge")

    def _to_end(self, last: float, begin: float, end: float) -> Table:
        """Return the law from the begin to where the last demand is passed, or all contacts are lost."""
        table = self._with(None, np.linspace(begin, end, _POINTS + 1))
        if self._rises:
            return table
        step = begin - end
        for _ in range(_MAX_EXTENSIONS):
            excess, low = float(table.demand[-1]) - last, float(table.h[-1])
            if excess <= 0.0:
                return table
            fall = -float(table.slope[-1])
            step = min(_GROWTH * step, _BEYOND * excess / fall) if fall > 0.0 else _GROWTH * step
            table, step = self._extended(table, low, max(step, _POINTS * float(np.spacing(abs(low)))))
        raise OutOfRange("path: the load is out of reach of these contacts")

    def _extended(self, table: Table, low: float, step: float) -> tuple[Table, float]:
        """Return the table with separations down to a step below the lowest, or less if that is too much contact."""
        for _ in range(_MAX_HALVINGS):
            try:
                return self._with(table, np.linspace(low, low - step, _POINTS // 4 + 1)[1:]), step
            except TooMuchContact as error:
                refused, step = error, 0.5 * step
        raise refused

    def _with(self, table: Table | None, h: Floats) -> Table:
        """Return the table with more separations."""
        h = np.sort(h) if self._rises else np.sort(h)[::-1]
        force, stiffness = self._law(self._turns, h)
        demand, slope = self._machine.demand(h, force), self._machine.slope(stiffness)
        sign = -1.0 if self._rises else 1.0
        new = Table(h, sign * demand, -slope)
        if table is not None:
            order = np.argsort(sign * -np.concatenate([table.h, h]), kind="stable")
            new = Table(*(np.concatenate(pair)[order] for pair in zip(table, new, strict=True)))
        if np.isnan(slope).any():
            new = new._replace(slope=np.gradient(new.demand, np.abs(new.h - new.h[0]), edge_order=2))
        return new


def _first_passages(table: Table, target: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the separations where the table first falls to each target, and which targets it does not reach."""
    lowest = np.minimum(_lowest(table), np.minimum(table.demand[:-1], table.demand[1:]))
    reached = np.minimum.accumulate(np.append(table.demand[0], lowest))
    first = np.searchsorted(-reached, -target, side="left")
    flown = first >= reached.size
    interval = np.clip(first - 1, 0, table.h.size - 2)
    low, high = np.zeros(target.size), np.ones(target.size)
    parts = np.linspace(0.0, 1.0, 9)[1:]
    for part in parts[::-1]:  # the first part of the interval in which it is reached
        high = np.where(_cubic(table, interval, part) <= target, part, high)
    low = high - 0.125
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        passed = _cubic(table, interval, middle) <= target
        low, high = np.where(passed, low, middle), np.where(passed, middle, high)
    h = table.h[interval] + high * (table.h[interval + 1] - table.h[interval])
    return np.where(first == 0, table.h[0], h), flown


def _cubic(table: Table, interval: NDArray[np.int64], part: Floats | float) -> Floats:
    """Return the cubic of Hermite in intervals, at parts of them."""
    width = np.abs(table.h[interval + 1] - table.h[interval])
    y0, y1 = table.demand[interval], table.demand[interval + 1]
    d0, d1 = width * table.slope[interval], width * table.slope[interval + 1]
    t = np.asarray(part)
    rise = y1 - y0
    return np.asarray(y0 + t * (d0 + t * ((3.0 * rise - 2.0 * d0 - d1) + t * (d0 + d1 - 2.0 * rise))))


def _lowest(table: Table) -> Floats:
    """Return the lowest values of the cubics at a few points of each interval."""
    interval = np.arange(table.h.size - 1)
    return np.asarray(np.min([_cubic(table, interval, part) for part in np.linspace(0.125, 1.0, 8)], axis=0))
