"""The totals of adhesive contacts along a path, in SI: those at each step, the avalanches and the largest tension."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction import close
from roughmdr.interaction.conductance import Punches, total_conductance
from roughmdr.interaction.jkr.equilibrium import State, alone, energy
from roughmdr.interaction.jkr.front import Front, Piece
from roughmdr.interaction.jkr.jumps import Avalanche
from roughmdr.interaction.jkr.lone import MOST_SLIDE
from roughmdr.interaction.jkr.tension import LargestTension, slope
from roughmdr.interaction.totals import Step, of_all, total
from roughmdr.loading.pull_off import PullOff
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import format_quantity

_SOLVER_ERROR = 1e-11  # error of the equilibria, over the sum of all loads
_STRETCH = 3.0 * 4.0 ** (-4.0 / 3.0)  # stretch at which a paraboloid detaches, over its natural depth


class Adhering(NamedTuple):
    """Adhesive contacts along a path."""

    steps: list[Step]
    separation: Floats
    """[m] at each step; inf where a dead load has pulled the flat off, NaN where there is no equilibrium."""
    radius: Floats
    """The contact radius [m] of each asperity where the flat is closest, or at the step asked for."""
    force: Floats
    """The force [N] of each there."""
    visits: int
    avalanches: list[Avalanche]
    """In SI."""
    pull_off: PullOff
    crowded: str
    """A warning where contacts overlap as soon as they are made; empty where they do not."""


class Account:
    """The totals of the contacts of a front so far.

    Radius and force of each are kept where the flat is closest, or at step number ``at``. ``reach`` is the distance
    from which contacts may jump on, over their stretch where they detach; 0 where that is not asked for.
    """

    def __init__(
        self, front: Front, names: set[str], *, rises: bool, at: int | None = None, reach: float = 0.0
    ) -> None:
        self._front, self._names, self._length = front, names, front.length
        self.energy_unit = front.modulus * front.length**3
        """Unit of energies reduced by the patch [J]."""
        self._steps, self._separation, self._avalanches = list[Step](), list[float](), list[Avalanche]()
        self._radius, self._force = np.zeros((2, front.total))
        self._at, self._closest, self._reach = at, math.inf, _STRETCH * reach
        self._tension = LargestTension() if rises else None
        self.dissipated = self.machine_dissipated = 0.0
        """By the avalanches, and by the jumps of the machine beside them [J]."""
        self._parted = False

    @property
    def avalanches(self) -> tuple[Avalanche, ...]:
        """The avalanches so far, in SI."""
        return tuple(self._avalanches)

    def begin(self, dissipated: float, avalanches: tuple[Avalanche, ...]) -> None:
        """Begin with what was dissipated before [J], and the avalanches."""
        self.dissipated, self._avalanches = dissipated, list(avalanches)

    def pass_over(self, piece: Piece) -> None:
        """Add a piece of the way: its avalanche, and its tension where the flat rises."""
        if self._tension is not None and piece.end.separation > piece.begin.separation:
            self._tension.pass_over(piece)
        if piece.avalanche is not None:
            separation, size, dissipated = piece.avalanche
            self.dissipated += dissipated * self.energy_unit
            self._avalanches.append(Avalanche(separation * self._length, size, dissipated * self.energy_unit))

    def lose_rest(self, total: int) -> None:
        """Add steps without an equilibrium, up to a number of them."""
        rest = total - len(self._steps)
        self._steps += [Step(error=math.inf)] * rest
        self._separation += [math.nan] * rest

    def stand(self, state: State, separation: float, *, rises: bool) -> None:
        """Add a step at a separation [m], to which the flat has risen or come down."""
        self._steps.append(self._totals(state, flown=math.isinf(separation)))
        self._separation.append(separation)
        self._parted |= rises and not state.inside.any()
        closer = state.separation < self._closest
        self._closest = min(state.separation, self._closest)
        if closer if self._at is None else len(self._steps) - 1 == self._at:
            self._radius, self._force = of_all(self._front, state.inside, state.contacts.radius, state.load)

    def result(self) -> Adhering:
        """Return all of it."""
        separation, visits = np.array(self._separation), self._front.problem.natural.size * len(self._steps)
        return Adhering(
            self._steps,
            separation,
            self._radius,
            self._force,
            visits,
            self._avalanches,
            self._pull_off(),
            self._crowded(),
        )

    def _totals(self, state: State, *, flown: bool) -> Step:
        front, problem, on = self._front, self._front.problem, state.inside
        lost, by_machine = self.dissipated + self.machine_dissipated, self.machine_dissipated
        step = total(front, on, state.contacts.radius, state.load, problem.near.pairs, self._names)
        doubted, held = self._pull_offs(state) if self._reach > 0.0 and not flown else (0.0, 0.0)
        if not on.any():
            return Step(dissipated=lost, by_machine=by_machine, doubted=doubted)
        stiffness = conductance = 0.0
        if "stiffness" in self._names:
            stiffness = front.force_unit / front.length * -slope(*alone(problem, state))
        if "conductance_radius" in self._names:
            conductance = front.length * self._conductance(state)
            if math.isnan(conductance):
                return Step(error=math.inf)
        tilt = np.hypot(*(state.field[1:3, on] + state.outer[1:3, on]))
        slides = tilt * state.contacts.lift[on] > MOST_SLIDE * state.contacts.radius[on]
        return step._replace(
            stiffness=stiffness,
            error=step.error * (_SOLVER_ERROR + problem.coupling.error),
            lost=int(np.count_nonzero(slides)),
            energy=self.energy_unit * energy(problem, state) if "energy" in self._names else 0.0,
            dissipated=lost,
            by_machine=by_machine,
            conductance=conductance,
            doubted=doubted,
            held=held,
        )

    def _conductance(self, state: State) -> float:
        """Return the conductance radius of the contacts as they are, whatever adhesion does to their stiffness."""
        problem, state = alone(self._front.problem, state)
        slid = -state.contacts.lift * (state.field[1:3] + state.outer[1:3])
        both = problem.coupling, problem.coupling
        punches = Punches(state.contacts.radius, slid, *both, state.overlap.pairs, problem.order)
        return total_conductance(punches, self._front.interaction.error)

    def _pull_off(self) -> PullOff:
        """Return the largest tension in SI; NaN where no unloading ends with all contacts parted."""
        if self._tension is None or not self._parted:
            return PullOff()
        length, tension = self._length, self._tension.found()
        if tension.force == 0.0:
            return PullOff(0.0)
        area = math.pi * length * length * tension.radius_squares
        return PullOff(
            self._front.force_unit * tension.force, length * tension.separation, float(tension.contacts), area
        )

    def _pull_offs(self, state: State) -> tuple[float, float]:
        """Return the sums of 3/2 pi w R of those that may have jumped on or overlap, and of other contacts.

        R is that of the paraboloid that jumps on with as large a contact.
        """
        front, count = self._front, state.t.size
        overlapping = np.zeros(count, np.bool_)
        close.mark_overlaps(front.problem.near.pairs, np.where(state.inside, state.contacts.radius, 0.0), overlapping)
        alone = 1.5 * math.pi * np.sqrt(front.work * front.made**3 / (2.0 * math.pi))
        gap, inside = front.height - state.separation, np.zeros(alone.size, np.bool_)
        gap[:count], inside[:count] = state.gap, state.inside
        doubted = ~inside & (gap > -self._reach * front.natural)
        doubted[:count] |= overlapping
        unit = front.modulus * self._length**2
        return unit * math.fsum(alone[doubted].tolist()), unit * math.fsum(alone[inside & ~doubted].tolist())

    def _crowded(self) -> str:
        """Return the warning about contacts that overlap as soon as they are made."""
        pairs = self._front.problem.near.pairs
        made = self._front.made[: self._front.problem.natural.size]
        overlapping = pairs.apart[:, 2] < made[pairs.members].sum(axis=1)
        if not overlapping.any():
            return ""
        length, count = self._length, int(np.count_nonzero(overlapping))
        radius, apart = (format_quantity(length * float(np.median(each)), "m") for each in
                         (made[pairs.members[overlapping]], pairs.apart[overlapping, 2]))  # fmt: skip
        return (
            f"contacts overlap as soon as they are made (pairs: {count}): jump-on radius {radius}, distance {apart} in "
            "the median; how contacts merge is not in their coupling"
        )
