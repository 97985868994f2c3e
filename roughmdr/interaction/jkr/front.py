"""The asperities that adhesive contacts are made of, in units of the patch, and the way of the flat over them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange
from roughmdr.interaction import close
from roughmdr.interaction.contacts import Asperities
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import below_all
from roughmdr.interaction.jkr import coincident
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.choose import jkr_kernels
from roughmdr.interaction.jkr.equilibrium import Drive, Problem, State, evaluate
from roughmdr.interaction.jkr.events import Event, advance
from roughmdr.interaction.jkr.interface import JkrKernels
from roughmdr.interaction.jkr.jumps import Avalanche, avalanche, settled
from roughmdr.interaction.jkr.lone import Surface
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.numerics.arguments import Floats

_LONGEST = 0.5  # way on which pairs that overlap stay as they are where the flat rises, over its depth
_NEAR = 1e-6  # of the natural depth: where an event happens, and where the flat stands for the pairs that overlap then
_MOST_WAYS = 10_000  # to one separation: more lead nowhere
_AT_REST = 1e-9  # residual over the natural depth of contacts for which the same pairs overlap as before
_GROWTH = 1.3  # of the number of asperities that are looked at, where one that was left out may touch
_MARGIN = 0.25  # of the natural depth, within which asperities out of contact are looked at
_CLEAR = 0.1  # of the margin that asperities outside the window must keep
_MOST_AVALANCHES = 10  # in a step, over the number of asperities near contact: more lead nowhere
_LARGEST_WINDOW, _SMALL_WINDOW = 1.5, 50  # asperities that may be in it over those that need to be, and some


class Piece(NamedTuple):
    """A part of the way of the flat on which no contact is made or lost, with the avalanche at its end."""

    problem: Problem
    """The asperities near contact."""
    kept: NDArray[np.int64]
    """Their numbers among all."""
    begin: State
    end: State
    event: Event | None
    """That which ends it; None at the end of the way."""
    avalanche: Avalanche | None
    rest: State
    """The state after the avalanche; the end where there is none."""


class Front:
    """The highest asperities of an ensemble, where the flat is."""

    def __init__(self, placed: Placed, effective_modulus: float, work: float) -> None:
        self.placed, self._kernels = placed, jkr_kernels(placed.law)
        self.work = work / effective_modulus / placed.length
        """Work of adhesion over E* and the side of the patch."""
        if not (self.work > 0.0 and math.isfinite(self.work)):
            raise OutOfRange(f"work over modulus is {work / effective_modulus:g} m; it is not representable")
        self._asperities = placed.asperities(placed.height.size)
        self._natural, self.made = _lone_scales(self._kernels, self._asperities, self.work)
        self._dense: Dense | None = None
        self.problem: Problem
        self.stand_at(self.top)

    @property
    def top(self) -> float:
        """The height of the highest asperity."""
        return float(self.placed.height.max(initial=-math.inf))

    @property
    def depth(self) -> float:
        """The largest natural depth."""
        return float(self._natural.max(initial=0.0))

    def stand_at(self, h: float) -> None:
        """Have the asperities that a flat may touch at a separation, and the pairs that overlap there."""
        self._stands = h
        needed = int(np.searchsorted(-self.placed.height, self.depth - h, side="right"))
        have = 0 if self._dense is None else self.problem.natural.size
        self._take(have if have >= needed else math.ceil(_GROWTH * needed))

    def _take(self, count: int) -> None:
        """Have the highest asperities."""
        placed, interaction = self.placed, self.placed.interaction
        count, self.next_height = min(count, placed.height.size), -math.inf
        if count < placed.height.size:
            self.next_height = float(placed.height[count])
        at, few = placed.at[:count], Asperities(*(each[:count] for each in self._asperities))
        pairs = coincident.find(at, self._bound(few), placed.sides)
        if self._dense is None or self.problem.natural.size != count:
            x, y = np.ascontiguousarray(at.T)
            self._dense = Dense(x, y, placed.patch, interaction.boundary == "periodic")
        elif coincident.are_same(pairs, self.problem.pairs):
            return
        coupling, natural = coincident.without(pairs, self._dense), self._natural[:count]
        self.problem = Problem(self._kernels, few, coupling, pairs, interaction.order, self.work, natural)
        self.kept = np.arange(0)
        self.window = self.problem.part(self.kept)

    def _bound(self, asperities: Asperities) -> Floats:
        """Return the radii of contacts alone under the flat as it stands, at least those with which they are made."""
        depth, bound = asperities.height - self._stands, self.made[: asperities.height.size].copy()
        for i in np.flatnonzero(depth > 0.0).tolist():
            bound[i] = _radius(self._kernels, asperities, i, float(depth[i]), self.work)
        return bound

    def _fitted(self, state: State) -> State:
        """Return the state among all asperities there are now, the last of which are not in contact."""
        more = self.problem.natural.size - state.t.size
        if not more:
            return state
        inside = np.append(state.inside, np.zeros(more, np.bool_))
        t, load = (np.append(each, np.zeros(more)) for each in (state.t, state.load))
        new = evaluate(self.problem, inside, t, load, state.separation, none(self.problem))
        return new._replace(factors=state.factors)

    def _settled(self, state: State, pairs: close.Pairs, h: float) -> tuple[State, list[Piece]]:
        """Return the state with those pairs overlapping that do so where the flat stands at h, and what jumps then.

        Before, ``pairs`` overlapped.
        """
        self.stand_at(h)
        begin, problem = self._fitted(state), self.problem
        if coincident.are_same(pairs, problem.pairs) or not begin.inside.any():
            return begin, []
        known = np.append(state.potential, begin.potential[state.t.size :])
        rest, one = settled(problem, begin._replace(potential=known))
        bare = [each._replace(factors=None) for each in (begin, rest)]
        event = Event("fold", int(np.argmax(begin.inside)), upwards=True)
        piece = Piece(problem, np.arange(begin.t.size), bare[0], bare[0], event, one, bare[1])
        return rest, [piece] if one.size else []

    def parted(self, separation: float) -> State:
        """Return the asperities without contact."""
        count = self.problem.natural.size
        nothing = np.zeros(count)
        return evaluate(self.problem, np.zeros(count, np.bool_), nothing, nothing, separation, none(self.problem))

    def whole(self, kept: NDArray[np.int64], part: State) -> State:
        """Return the state of all asperities, of which some are near contact."""
        count = self.problem.natural.size
        inside, t, load = np.zeros(count, np.bool_), np.zeros(count), np.zeros(count)
        inside[kept], t[kept], load[kept] = part.inside, part.t, part.load
        new = evaluate(self.problem, inside, t, load, part.separation, none(self.problem))
        return new._replace(factors=part.factors)

    def stopped(self, kept: NDArray[np.int64], part: State) -> State:
        """Return the state of all where the flat stops within a piece, with the pairs that overlap there."""
        self.stand_at(part.separation)
        new = self.whole(kept, part)
        return new if new.error <= _AT_REST or not new.inside.any() else settled(self.problem, new)[0]

    def go(self, state: State, h: float) -> tuple[State, list[Piece]]:
        """Return the state at a separation, and the way to it.

        NoEquilibriumError where no equilibrium is found.
        """
        state, pieces = self._towards(state, h)
        for _ in range(_MOST_WAYS):
            if state.separation == h:
                return state, pieces
            state, more = self._towards(state, h)
            pieces += more
        raise NoEquilibriumError

    def _towards(self, state: State, h: float) -> tuple[State, list[Piece]]:
        """Go towards a separation; where other pairs overlap there, no farther than to an event.

        Without one, pairs overlap all along as at the lower end of the way.
        """
        begin, target, pairs = state.separation, h, self.problem.pairs
        if h > begin and pairs.members.size and state.inside.any():
            target = min(h, begin + _LONGEST * max(self.depth, self.top - begin))
        self.stand_at(max(begin, target))
        above = self.problem.pairs
        self.stand_at(min(begin, target))
        same = coincident.are_same(above, self.problem.pairs)
        new, pieces = self._tried(state, pairs, target, to_event=not same)
        if not same and new.separation != target and abs(new.separation - begin) < abs(target - begin):
            return self._to_event(state, pairs, target, new.separation)
        if target > begin:
            new, after = self._settled(new, self.problem.pairs, target)
            pieces += after
        return new, pieces

    def _to_event(self, state: State, pairs: close.Pairs, h: float, at: float) -> tuple[State, list[Piece]]:
        """Go to the first event on the way to a separation, with the pairs that overlap there; it is ``at`` or near it.

        If it is not found there the state before it is returned.
        """
        begin, low, high = state.separation, state.separation, h
        near = max(_NEAR * self.depth, 8.0 * float(np.spacing(max(abs(begin), abs(self.top)))))
        while abs(high - low) > near:
            self.stand_at(at)
            new, pieces = self._tried(state, pairs, h, to_event=True)
            found = new.separation
            if abs(found - at) <= near:
                return new, pieces
            low, high = (at, high) if abs(found - begin) > abs(at - begin) else (low, at)
            at = found if min(low, high) < found < max(low, high) else low + 0.5 * (high - low)
        self.stand_at(low)
        return self._tried(state, pairs, low if low != begin else high, to_event=True)

    def _tried(self, state: State, pairs: close.Pairs, h: float, *, to_event: bool) -> tuple[State, list[Piece]]:
        """Return the state at a separation or at the first event, and the way there; before, ``pairs`` overlapped."""
        state, before = self._settled(state, pairs, self._stands)
        if before and to_event:
            return state, before
        new, pieces = self._advance(state, h, to_event=to_event)
        while not self._complete(new):
            self._take(math.ceil(_GROWTH * state.t.size) + 1)
            state = self._fitted(state)
            new, pieces = self._advance(state, h, to_event=to_event)
        return new, [*before, *pieces]

    def _advance(self, state: State, h: float, *, to_event: bool) -> tuple[State, list[Piece]]:
        """Return the state at a separation or at the first event, and the way there.

        Only asperities near contact are looked at meanwhile.
        """
        margin = _MARGIN * float(self.problem.natural.max(initial=0.0))
        while True:
            near = state.gap + max(state.separation - h, 0.0) > -margin
            self._look_at(np.flatnonzero(near | state.inside))
            few, kept, pieces = self.window, self.kept, list[Piece]()
            part = evaluate(few, state.inside[kept], state.t[kept], state.load[kept], state.separation, none(few))
            part, event = part._replace(factors=state.factors), None
            while not pieces or (event is not None and not to_event):
                end, event = advance(few, part, Drive(h - part.separation, none(few)))
                rest, one = (end, None) if event is None else avalanche(few, end, event)
                bare = [each._replace(factors=None) for each in (part, end, rest)]  # a long way has many, each large
                pieces.append(Piece(few, kept, bare[0], bare[1], event, one, bare[2]))
                part = rest
                if len(pieces) > _MOST_AVALANCHES * (kept.size + 1) + 1:
                    raise NoEquilibriumError
            new = self.whole(kept, part)
            beyond = new.gap.copy()
            beyond[kept] = -math.inf
            if not (beyond > -_CLEAR * margin).any():
                return new, pieces
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
