"""The asperities that adhesive contacts are made of, in units of the patch, and the way of the flat over them."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange
from roughmdr.interaction.contacts import coupled_kernels
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import below_all
from roughmdr.interaction.interface import Asperities
from roughmdr.interaction.jkr import coincident, contacts, lone
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, evaluate
from roughmdr.interaction.jkr.events import Event, advance
from roughmdr.interaction.jkr.interface import JkrKernels
from roughmdr.interaction.jkr.jumps import Avalanche, avalanche
from roughmdr.interaction.jkr.lone import Surface
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.kernels.interface import Kernels
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once, specialise

_GROWTH = 1.3  # number of asperities that are looked at, over the one before, where more may touch
_FURTHER = 1.0  # way down, over the depth of the flat, after which pairs that may overlap are looked for again
_MARGIN = 0.25  # of the natural depth, within which asperities out of contact are looked at
_CLEAR = 0.1  # of the margin that asperities outside the window must keep
_MOST_AVALANCHES = 10  # in a step, over the number of asperities near contact: more lead nowhere
_LARGEST_WINDOW, _SMALL_WINDOW = 1.5, 50  # asperities that may be in it over those that need to be, and some


class Piece(NamedTuple):
    """A part of the way of the flat on which no contact is made or lost, with the avalanche at its end."""

    problem: PairProblem
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
    """The highest asperities of an ensemble, as many as a flat may have touched where it has been."""

    def __init__(self, placed: Placed, effective_modulus: float, work: float) -> None:
        self.placed, self._kernels = placed, jkr_kernels(placed.law)
        self.work = work / effective_modulus / placed.length
        """Work of adhesion over E* and the side of the patch."""
        if not (self.work > 0.0 and math.isfinite(self.work)):
            raise OutOfRange(f"work over modulus is {work / effective_modulus:g} m; it is not representable")
        self._asperities = placed.asperities(placed.height.size)
        self.natural, self.made = _lone_scales(self._kernels, self._asperities, self.work)
        self._lowest = math.inf  # separation down to which the pairs are known that may overlap
        self._coupling: Dense | None = None
        self._take(0)

    @property
    def top(self) -> float:
        """The height of the highest asperity."""
        return float(self.placed.height.max(initial=-math.inf))

    @property
    def depth(self) -> float:
        """The largest natural depth."""
        return float(self.natural.max(initial=0.0))

    def _bring_down(self, state: State, h: float) -> State:
        """Have the asperities that a flat at h may touch, and the pairs that may overlap; return the state with all."""
        needed = int(np.searchsorted(-self.placed.height, self.depth - h, side="right"))
        have, nearer = self.problem.natural.size, h < self._lowest
        if nearer:
            self._lowest = h - _FURTHER * max(self.top - h, self.depth)
        if nearer or have < needed:
            self._take(have if have >= needed else math.ceil(_GROWTH * needed))
        return self._extended(state)

    def _take(self, count: int) -> None:
        """Have the highest asperities."""
        placed, kernels, interaction = self.placed, self._kernels, self.placed.interaction
        count, self.next_height = min(count, placed.height.size), -math.inf
        if count < placed.height.size:
            self.next_height = float(placed.height[count])
        at, few = placed.at[:count], Asperities(*(each[:count] for each in self._asperities))
        x, y = np.ascontiguousarray(at.T)
        coupling = self._coupling = Dense(x, y, placed.patch, interaction.boundary == "periodic", self._coupling)
        natural, reach = self.natural[:count], np.empty((2, count))
        kernels.flanks(np.arange(count), self._lowest, natural, few, reach)
        near = coincident.Near(kernels, few, natural, coincident.find(at, reach[0], placed.sides))
        self.problem = PairProblem(kernels, few, coupling, near, interaction.order, self.work, natural)
        self.kept = np.arange(0)
        self.window = self.problem.part(self.kept)

    def _extended(self, state: State) -> State:
        """Return the state with all asperities there are now, the last of which are not in contact."""
        more = self.problem.natural.size - state.t.size
        if not more:
            return state
        inside = np.append(state.inside, np.zeros(more, np.bool_))
        t, load = (np.append(each, np.zeros(more)) for each in (state.t, state.load))
        new = evaluate(self.problem, inside, t, load, state.separation, none(self.problem))
        return new._replace(factors=state.factors)

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

    def go(self, state: State, h: float) -> tuple[State, list[Piece]]:
        """Return the state at a separation, and the way to it.

        NoEquilibriumError where no equilibrium is found.
        """
        state = self._bring_down(state, h)
        new, pieces = self._advance(state, h)
        while not self._complete(new):
            self._take(math.ceil(_GROWTH * state.t.size) + 1)
            state = self._extended(state)
            new, pieces = self._advance(state, h)
        return new, pieces

    def _advance(self, state: State, h: float) -> tuple[State, list[Piece]]:
        """Return the state at a separation, and the way to it; only asperities near contact are looked at meanwhile."""
        margin = _MARGIN * float(self.problem.natural.max(initial=0.0))
        while True:
            near = state.gap + max(state.separation - h, 0.0) > -margin
            self._look_at(np.flatnonzero(near | state.inside))
            few, kept, pieces = self.window, self.kept, list[Piece]()
            part = evaluate(few, state.inside[kept], state.t[kept], state.load[kept], state.separation, none(few))
            part, event = part._replace(factors=state.factors), None
            while not pieces or event is not None:
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
    made = np.array([_radius(kernels, asperities, i, work) for i in range(asperities.height.size)])
    if not ((made > 0.0) & np.isfinite(made)).all():
        raise OutOfRange("the contact of an asperity under adhesion is not representable")
    return np.sqrt(2.0 * math.pi * work * made), made


def _radius(kernels: JkrKernels, asperities: Asperities, i: int, work: float) -> float:
    """Return the radius of a contact alone as it is made."""
    size = float(asperities.size[i])
    if kernels.pinned:
        return size
    t = kernels.next_state(0.0, True, Surface(0.0), work, i, asperities)
    return size * kernels.terms(t, kernels.params_of(asperities.params, i))[0]


def none(problem: PairProblem) -> Floats:
    """Return an outer field of none."""
    return np.zeros((5, problem.natural.size))


@once
def jkr_kernels(kernels: Kernels) -> JkrKernels:
    """Return the kernels of a shape without adhesion with those of its adhesive contacts, compiled."""
    coupled = coupled_kernels(kernels)
    whole = JkrKernels(f"jkr_{coupled.name}")
    vars(whole).update(vars(coupled) | {"__name__": whole.__name__})
    profile = isinstance(kernels, ProfileKernels)
    whole.pinned, whole.flat = coupled.pinned, coupled.flat
    parts: dict[str, Callable[..., object]] = {
        "strain": contacts.strain_of_profile if profile else contacts.strain_of_power,
        "held": contacts.held,
        "lift": contacts.lift,
        "slide": contacts.slide,
        "fill": contacts.fill,
        "flanks": coincident.flanks,
        "edge": lone.edge,
        "next_state": lone.next_state,
        "lone_load": lone.lone_load,
    }
    for name, part in parts.items():
        vars(whole)[name] = specialise(part, whole)
    return whole
