"""The highest asperities of an ensemble, adhering and feeling each other, followed as the flat moves."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange
from roughmdr.interaction.contacts import Asperities
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import below_all
from roughmdr.interaction.jkr import coincident
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.choose import jkr_kernels
from roughmdr.interaction.jkr.equilibrium import Drive, Problem, State, evaluate
from roughmdr.interaction.jkr.events import advance
from roughmdr.interaction.jkr.interface import JkrKernels
from roughmdr.interaction.jkr.jumps import Avalanche, avalanche
from roughmdr.interaction.jkr.lone import Surface
from roughmdr.interaction.jkr.tension import Tension, largest_between
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Interaction
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import format_quantity

_GROWTH = 1.3  # of the number of asperities that are looked at, where one that was left out may touch
_MARGIN = 0.25  # of the natural depth, within which asperities out of contact are looked at
_CLEAR = 0.1  # of the margin that asperities outside the window must keep
_MOST_AVALANCHES = 10  # in a step, over the number of asperities near contact: more lead nowhere
_LARGEST_WINDOW, _SMALL_WINDOW = 1.5, 50  # asperities that may be in it over those that need to be, and some


class Followed:
    """Those asperities, in units of the patch; ``lowest`` [m] is the lowest separation that the flat comes to.

    OutOfRange where a scale is not representable.
    """

    def __init__(
        self, ensemble: Ensemble, effective_modulus: float, work: float, interaction: Interaction, lowest: float
    ) -> None:
        self.placed = placed = Placed(ensemble, effective_modulus, interaction)
        self._kernels = jkr_kernels(placed.law)
        self._work = work / effective_modulus / placed.length
        if not (self._work > 0.0 and math.isfinite(self._work)):
            raise OutOfRange(f"work over modulus is {work / effective_modulus:g} m; it is not representable")
        self._asperities = placed.asperities(placed.height.size)
        self._natural, self._made = _lone_scales(self._kernels, self._asperities, self._work)
        self._lowest = lowest / placed.length
        reach = self._lowest - float(self._natural.max(initial=0.0))
        self._take(int(np.searchsorted(-placed.height, -reach, side="right")))

    def _take(self, count: int) -> None:
        """Have the highest asperities."""
        placed, kernels, interaction = self.placed, self._kernels, self.placed.interaction
        count, self.next_height = min(count, placed.height.size), -math.inf
        if count < placed.height.size:
            self.next_height = float(placed.height[count])
        at, few = placed.at[:count], Asperities(*(each[:count] for each in self._asperities))
        x, y = np.ascontiguousarray(at.T)
        coupling = Dense(x, y, placed.patch, interaction.boundary == "periodic")
        depth = np.maximum(few.height - self._lowest, 0.0)
        bound = np.array([_radius(kernels, few, i, float(depth[i]), self._work) for i in range(count)]).reshape(count)
        pairs = coincident.find(at, bound, placed.sides)
        coincident.take_out(pairs, coupling.matrices)
        self.problem = Problem(kernels, few, coupling, pairs, interaction.order, self._work, self._natural[:count])
        self.kept = np.arange(0)
        self.window = self.problem.part(self.kept)

    def _extend(self, state: State) -> State:
        """Return the state with more asperities, none of which is in contact."""
        self._take(math.ceil(_GROWTH * state.t.size) + 1)
        more = self.problem.natural.size - state.t.size
        inside = np.append(state.inside, np.zeros(more, np.bool_))
        t, load = (np.append(each, np.zeros(more)) for each in (state.t, state.load))
        new = evaluate(self.problem, inside, t, load, state.separation, none(self.problem))
        return new._replace(factors=state.factors)

    def begin(self, separation: float) -> State:
        """Return the state out of contact, at a separation [m] or just above first touch."""
        heights = self.problem.asperities.height
        first = max(separation / self.placed.length, float(heights.max(initial=-math.inf)) + 1e-9)
        nothing, none_inside = np.zeros(heights.size), np.zeros(heights.size, np.bool_)
        return evaluate(self.problem, none_inside, nothing, nothing.copy(), first, none(self.problem))

    def to(
        self, state: State, h: float, tension: Tension | None = None
    ) -> tuple[State, list[Avalanche], Tension | None]:
        """Return the state at a separation, the avalanches before it, and the largest tension if one is given.

        NoEquilibriumError where there is none.
        """
        new, found, largest = self._advance(state, h, tension)
        while not self._complete(new):
            state = self._extend(state)
            new, found, largest = self._advance(state, h, tension)
        return new, found, largest

    def _advance(
        self, state: State, h: float, tension: Tension | None
    ) -> tuple[State, list[Avalanche], Tension | None]:
        """Return the state at a separation, the avalanches before it, and the largest tension if one is given.

        Only asperities near contact are looked at meanwhile.
        """
        problem, begun = self.problem, tension
        margin = _MARGIN * float(problem.natural.max(initial=0.0))
        while True:
            near = state.gap + max(state.separation - h, 0.0) > -margin
            self._look_at(np.flatnonzero(near | state.inside))
            few, kept = self.window, self.kept
            part = evaluate(few, state.inside[kept], state.t[kept], state.load[kept], state.separation, none(few))
            part = part._replace(factors=state.factors)
            found, tension = list[Avalanche](), begun
            while True:
                before = part
                part, event = advance(few, part, Drive(h - part.separation, none(few)))
                if tension is not None and part.separation > before.separation:
                    ends = event is not None and event.kind == "fold"
                    tension = largest_between(few, before, part, tension, fold=ends)
                if event is None:
                    break
                part, one = avalanche(few, part, event)
                found.append(one)
                if len(found) > _MOST_AVALANCHES * (kept.size + 1):
                    raise NoEquilibriumError
            inside, t, load = np.zeros_like(state.inside), np.zeros_like(state.t), np.zeros_like(state.load)
            inside[kept], t[kept], load[kept] = part.inside, part.t, part.load
            new = evaluate(problem, inside, t, load, part.separation, none(problem))._replace(factors=part.factors)
            beyond = new.gap.copy()
            beyond[kept] = -math.inf
            if not (beyond > -_CLEAR * margin).any():
                return new, found, tension
            margin *= 4.0

    def _look_at(self, needed: NDArray[np.int64]) -> None:
        """Have the asperities that are needed, and not many more, in the window."""
        held = np.isin(needed, self.kept).all()
        if not held or self.kept.size > _LARGEST_WINDOW * needed.size + _SMALL_WINDOW:
            self.kept, self.window = needed, self.problem.part(needed)

    def _complete(self, state: State) -> bool:
        """Return whether no asperity that was left out can touch."""
        if not state.inside.any():
            return True
        return not self.next_height - state.separation > min(below_all(state.potential), 0.0)

    def crowding(self) -> str:
        """Return the warning about contacts that overlap as soon as they are made."""
        pairs, made = self.problem.pairs, self._made[: self.problem.natural.size]
        overlapping = pairs.apart[:, 2] < made[pairs.members].sum(axis=1)
        if not overlapping.any():
            return ""
        length, count = self.placed.length, int(np.count_nonzero(overlapping))
        radius, apart = (format_quantity(length * float(np.median(each)), "m") for each in
                         (made[pairs.members[overlapping]], pairs.apart[overlapping, 2]))  # fmt: skip
        return (
            f"contacts overlap as soon as they are made ({count} pairs): jump-on radius {radius}, distance {apart} in "
            "the median; how contacts merge is not in their coupling"
        )


def _lone_scales(kernels: JkrKernels, asperities: Asperities, work: float) -> tuple[Floats, Floats]:
    """Return the stretch at the edge of each contact as it is made alone, and its radius."""
    made = np.array([_radius(kernels, asperities, i, 0.0, work) for i in range(asperities.height.size)])
    if not ((made > 0.0) & np.isfinite(made)).all():
        raise OutOfRange("the contact of an asperity under adhesion is not representable")
    return np.sqrt(2.0 * math.pi * work * made), made


def _radius(kernels: JkrKernels, asperities: Asperities, i: int, depth: float, work: float) -> float:
    """Return the radius of a contact alone as it is made at an indentation."""
    size = float(asperities.size[i])
    if kernels.pinned:
        return size
    t = kernels.next_state(0.0, True, Surface(depth), work, i, asperities)
    return size * kernels.terms(t, kernels.params_of(asperities.params, i))[0]


def none(problem: Problem) -> Floats:
    """Return an outer field of none."""
    return np.zeros((5, problem.natural.size))
