"""The asperities that adhesive contacts are made of, in units of the patch, and the way of the flat over them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange
from roughmdr.interaction import close
from roughmdr.interaction.contacts import coupled_kernels, with_parts
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import below_all
from roughmdr.interaction.interface import Asperities, CoupledKernels
from roughmdr.interaction.jkr import coincident, contacts, lone
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, among, evaluate, no_field, part_of
from roughmdr.interaction.jkr.events import Event, advance
from roughmdr.interaction.jkr.jumps import Avalanche, Recurrence, avalanche
from roughmdr.interaction.jkr.lone import Surface
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.interface import Kernels
from roughmdr.kernels.profile.interface import ProfileKernels
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import once

_GROWTH = 1.3  # number of asperities that are looked at, over the one before, where more may touch
_FURTHER = 1.0  # way down, over the depth of the flat, after which pairs that may overlap are looked for again
_MARGIN = 0.25  # distance to contact, over the natural depth, within which asperities are looked at
_CLEAR = 0.1  # share of the margin that asperities outside the window must keep
_MOST_AVALANCHES = 10  # most avalanches in a step, over the number of asperities near contact
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


class Front(Placed):
    """The highest asperities of an ensemble, as many as a flat may have touched where it has been; w [J/m2]."""

    def __init__(self, ensemble: Ensemble, effective_modulus: float, work: float, interaction: Interaction) -> None:
        super().__init__(ensemble, effective_modulus, interaction)
        self._kernels = jkr_kernels(self.kernels_alone)
        self.work = work / effective_modulus / self.length
        """Work of adhesion over E* and the side of the patch."""
        if not (self.work > 0.0 and math.isfinite(self.work)):
            raise OutOfRange(f"work over modulus is {work / effective_modulus:g} m; it is not representable")
        self._asperities = self.asperities(self.height.size)
        self.natural, self.made = _lone_scales(self._kernels, self._asperities, self.work)
        self._lowest = math.inf  # separation down to which the pairs are known that may overlap
        self._coupling: Dense | None = None
        self._take(0)

    @property
    def top(self) -> float:
        """The height of the highest asperity."""
        return float(self.height.max(initial=-math.inf))

    @property
    def deepest(self) -> float:
        """The largest natural depth of an adhesive contact."""
        return float(self.natural.max(initial=0.0))

    def _bring_down(self, state: State, h: float) -> State:
        """Have the asperities that a flat at h may touch, and the pairs that may overlap; return the state with all."""
        needed = int(np.searchsorted(-self.height, self.deepest - h, side="right"))
        have, nearer = self.problem.natural.size, h < self._lowest
        if nearer:
            self._lowest = h - _FURTHER * max(self.top - h, self.deepest)
        if nearer or have < needed:
            self._take(have if have >= needed else math.ceil(_GROWTH * needed))
        return self._with_all(state)

    def _take(self, count: int) -> None:
        """Have the highest asperities."""
        kernels, interaction, count = self._kernels, self.interaction, min(count, self.height.size)
        self.next_height = float(self.height[count]) if count < self.height.size else -math.inf
        at, few = self.at[:count], Asperities(*(each[:count] for each in self._asperities))
        x, y = np.ascontiguousarray(at.T)
        coupling = self._coupling = Dense(x, y, self.patch, interaction.boundary == "periodic", self._coupling)
        natural, reach = self.natural[:count], np.empty((2, count))
        kernels.flanks(np.arange(count), self._lowest, natural, few, reach)
        near = coincident.Near(kernels, few, natural, close.find_pairs(at, reach[0], self.sides, growth=1.0))
        self.problem = PairProblem(kernels, few, coupling, near, interaction.order, self.work, natural)
        self.near_contact = np.arange(0)
        self.window = self.problem.part(self.near_contact)

    def parted(self, separation: float) -> State:
        """Return the asperities without contact."""
        nothing = np.zeros(self.problem.natural.size)
        return evaluate(self.problem, nothing > 0.0, nothing, nothing, separation, no_field(self.problem))

    def whole(self, kept: NDArray[np.int64], part: State) -> State:
        """Return the state of all asperities, of which some are near contact."""
        return among(self.problem, kept, part)

    def _with_all(self, state: State) -> State:
        """Return the state with all asperities there are now, the last of which are not in contact."""
        known = state.t.size
        return state if known == self.problem.natural.size else self.whole(np.arange(known), state)

    def go(self, state: State, h: float) -> tuple[State, list[Piece]]:
        """Return the state at a separation, and the way to it.

        NoEquilibriumError where no equilibrium is found.
        """
        state = self._bring_down(state, h)
        new, pieces = self._advance(state, h)
        while not self._complete(new):
            self._take(math.ceil(_GROWTH * state.t.size) + 1)
            state = self._with_all(state)
            new, pieces = self._advance(state, h)
        return new, pieces

    def _advance(self, state: State, h: float) -> tuple[State, list[Piece]]:
        """Return the state at a separation, and the way to it; only asperities near contact are looked at meanwhile."""
        margin = _MARGIN * float(self.problem.natural.max(initial=0.0))
        while True:
            near = state.gap + max(state.separation - h, 0.0) > -margin
            self._look_at(np.flatnonzero(near | state.inside))
            few, kept, pieces = self.window, self.near_contact, list[Piece]()
            part, event, met = part_of(few, kept, state), None, Recurrence()
            while not pieces or event is not None:
                end, event = advance(few, part, Drive(h - part.separation, no_field(few)))
                if event is not None:
                    met.note(event, end)
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
        held = np.isin(needed, self.near_contact).all()
        if not held or self.near_contact.size > _LARGEST_WINDOW * needed.size + _SMALL_WINDOW:
            self.near_contact, self.window = needed, self.problem.part(needed)

    def _complete(self, state: State) -> bool:
        """Return whether no asperity that was left out can touch."""
        if not state.inside.any():
            return True
        return not self.next_height - state.separation > min(below_all(state.potential), 0.0)


def _lone_scales(kernels: CoupledKernels, asperities: Asperities, work: float) -> tuple[Floats, Floats]:
    """Return the stretch at the edge of each contact as it is made alone, and its radius."""
    made = np.array([_radius(kernels, asperities, i, work) for i in range(asperities.height.size)])
    if not ((made > 0.0) & np.isfinite(made)).all():
        raise OutOfRange("the contact of an asperity under adhesion is not representable")
    return np.sqrt(2.0 * math.pi * work * made), made


def _radius(kernels: CoupledKernels, asperities: Asperities, i: int, work: float) -> float:
    """Return the radius of a contact alone as it is made."""
    size = float(asperities.size[i])
    if kernels.pinned:
        return size
    t = kernels.next_state(0.0, True, Surface(0.0), work, i, asperities)
    return size * kernels.terms(t, kernels.params_of(asperities.params, i))[0]


@once
def jkr_kernels(kernels: Kernels) -> CoupledKernels:
    """Return the kernels of a shape without adhesion with those of its adhesive contacts, compiled."""
    strain = contacts.strain_of_profile if isinstance(kernels, ProfileKernels) else contacts.strain_of_power
    common = (
        contacts.held,
        contacts.lift,
        contacts.slide,
        contacts.fill,
        coincident.flanks,
        lone.edge,
        lone.next_state,
        lone.lone_load,
    )
    parts = {"strain": strain} | {each.__name__: each for each in common}
    coupled = coupled_kernels(kernels)
    return with_parts(coupled, f"jkr_{coupled.name}", parts)
