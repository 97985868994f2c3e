"""Loads behind the spring of a machine, and their derivatives, from those at given separations.

The spring yields to a load, the separation changes by as much, and with it the load again: a change p_i at given
separations becomes dF_i = p_i + c sum_j (dF_i/dh_j) dF_j, with the compliance c. Contacts that adhere remember where
the flat turned, so that a load depends on its own separation and on those of the turns before.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

_FIRM = 0.5  # least 1 - c dF/dh at which loads are found by iteration: near 0 the contacts jump
_EXACT = 1e-11  # change of a load, over the largest, after which iterations end
_ITERATIONS = 8


class Spring(NamedTuple):
    """Changes of loads with the separations that the spring makes, over the changes of loads that stretch it."""

    load: Floats
    """Load [step] at which they were found [N or Pa]."""
    own: Floats
    """By the separation of the step itself: [step]."""
    turns: list[NDArray[np.bool_]]
    """The steps [step] of each turn, where the control stays the same."""
    by_turns: Floats
    """By the separation of each turn before: [step, turn]."""

    @classmethod
    def of(
        cls, control: Floats, load: Floats, compliance: float, slope: Callable[[NDArray[np.bool_]], Floats]
    ) -> "Spring":
        """Return them along a control [m]; ``slope`` gives dF/dh of all loads as the separations of some steps change.

        ``compliance`` is that of the spring, dh over the change of a load.
        """
        turns = _turns(control)
        others = ~np.any(turns, axis=0) if turns else np.ones(control.size, dtype=np.bool_)
        own, by_turns = compliance * slope(others), np.zeros((control.size, len(turns)))
        for number, turn in enumerate(turns):
            change = compliance * slope(turn)
            own[turn] = change[turn]
            by_turns[:, number] = np.where(turn, 0.0, change)
        return cls(load, own, turns, by_turns)

    def yielded(self, change: Floats) -> Floats:
        """Return what changes [step, ...] of the loads at given separations become; 0 where the contacts jump."""
        each = np.reshape(1.0 - self.own, (-1,) + (1,) * (change.ndim - 1))
        each, whole = np.where(each > 0.0, each, np.inf), change
        for turn, slope in zip(self.turns, self.by_turns.T, strict=True):
            whole = whole + np.multiply.outer(slope, (whole[turn] / each[turn]).mean(axis=0))
        return np.asarray(whole / each)

    def found(self, first: Floats, bearing: Callable[[Floats], Floats]) -> Floats | None:
        """Return the load that the contacts have where the spring bears it; None where that is not certain.

        ``bearing`` gives the load of the contacts where the spring bears another, ``first`` where it bears ``load``.
        """
        load, excess = self.load, first - self.load
        for _ in range(_ITERATIONS if (1.0 - self.own > _FIRM).all() else 0):
            load = load + self.yielded(excess)
            excess = bearing(load) - load
            if not np.abs(excess).max() > _EXACT * np.abs(load).max():
                return load if np.isfinite(excess).all() else None
        return None


def _turns(control: Floats) -> list[NDArray[np.bool_]]:
    """Return the steps at which the control turns, for each turn."""
    way = np.sign(np.diff(control))
    moving = np.flatnonzero(way)
    turned = way[moving[1:]] != way[moving[:-1]]
    steps = np.arange(control.size)
    ends = zip(moving[:-1][turned] + 1, moving[1:][turned], strict=True)
    return [(first <= steps) & (steps <= last) for first, last in ends]
