"""Adhesive contacts that feel each other, along a path of the flat: the totals at each separation, and the jumps."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange
from roughmdr.interaction import close
from roughmdr.interaction.contacts import Asperities
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import below_all
from roughmdr.interaction.jkr import coincident
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.choose import jkr_kernels
from roughmdr.interaction.jkr.equilibrium import Drive, Problem, State, alone, energy, evaluate
from roughmdr.interaction.jkr.events import advance
from roughmdr.interaction.jkr.interface import JkrKernels
from roughmdr.interaction.jkr.jumps import Avalanche, avalanche
from roughmdr.interaction.jkr.lone import MOST_SLIDE, Surface
from roughmdr.interaction.jkr.tension import Tension, largest_between, slope
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Interaction
from roughmdr.interaction.totals import Overlap, Step
from roughmdr.loading.pull_off import PullOff
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import format_quantity
from roughmdr.shapes import SHAPES, SharedProfile

_GROWTH = 1.3  # of the number of asperities that are looked at, where one that was left out may touch
_MARGIN = 0.25  # of the natural depth, within which asperities out of contact are looked at
_CLEAR = 0.1  # of the margin that asperities outside the window must keep
_MOST_AVALANCHES = 10  # in a step, over the number of asperities near contact: more lead nowhere
_LARGEST_WINDOW, _SMALL_WINDOW = 1.5, 50  # asperities that may be in it over those that need to be, and some
_SOLVER_ERROR = 1e-11  # of all loads


class Adhering(NamedTuple):
    """Adhesive contacts along a path."""

    steps: list[Step]
    radius: Floats
    """The contact radius [m] of each asperity where the flat is closest."""
    visits: int
    avalanches: list[Avalanche]
    """In SI."""
    pull_off: PullOff
    crowded: str
    """A warning where contacts overlap as soon as they are made; empty where they do not."""


def solve_path(
    ensemble: Ensemble,
    separation: Floats,
    effective_modulus: float,
    work: float,
    interaction: Interaction,
    names: set[str],
) -> Adhering:
    """Return adhesive contacts at separations [m] of a flat that comes from infinity; w [J/m2].

    The stiffness and the energy are computed where ``names`` asks for them. Errors as ``interaction.solve``.
    """
    placed = Placed(ensemble, effective_modulus, interaction)
    length = placed.length
    lowest = float(separation.min()) / length
    whole = placed.height.size
    kernels = jkr_kernels(placed.law)
    weight = work / effective_modulus / length
    if not (weight > 0.0 and math.isfinite(weight)):
        raise OutOfRange(f"work over modulus is {work / effective_modulus:g} m; it is not representable")
    asperities = placed.asperities(whole)
    natural, made = _lone_scales(kernels, asperities, weight)
    path = _Path(placed, kernels, asperities, natural, made, weight, lowest)
    return path.follow(separation, ensemble.height.size, effective_modulus, names)


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


class _Path:
    """The highest asperities of an ensemble, along a path."""

    def __init__(
        self,
        placed: Placed,
        kernels: JkrKernels,
        asperities: Asperities,
        natural: Floats,
        made: Floats,
        work: float,
        lowest: float,
    ) -> None:
        self.placed, self._kernels, self._asperities = placed, kernels, asperities
        self._natural, self._made, self._work, self._lowest = natural, made, work, lowest
        reach = lowest - float(natural.max(initial=0.0))
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

    def follow(self, separation: Floats, total: int, modulus: float, names: set[str]) -> Adhering:
        """Return the contacts at separations [m]."""
        problem, length = self.problem, self.placed.length
        count = problem.asperities.height.size
        first = max(float(separation[0]) / length, float(problem.asperities.height.max(initial=-math.inf)) + 1e-9)
        state = evaluate(problem, np.zeros(count, np.bool_), np.zeros(count), np.zeros(count), first, none(problem))
        unit = modulus * length**3
        steps, avalanches, radius, dissipated = list[Step](), list[Avalanche](), np.zeros(total), 0.0
        closest, lost = int(np.argmin(separation)), False
        parted = False
        tension = Tension() if (np.diff(separation) > 0.0).any() else None
        for number, h in enumerate((separation / length).tolist()):
            try:
                if not lost:
                    new, found, largest = self._advance(state, h, tension)
                    while not self._complete(new):
                        state = self._extend(state)
                        new, found, largest = self._advance(state, h, tension)
                    state, tension = new, largest
                    for one in found:
                        dissipated += one.dissipated * unit
                        avalanches.append(Avalanche(one.separation * length, one.size, one.dissipated * unit))
            except NoEquilibriumError:
                lost = True
            if lost:
                steps.append(Step(error=math.inf))
                continue
            steps.append(self._totals(state, modulus, dissipated, names))
            parted |= number > 0 and separation[number] > separation[number - 1] and not state.inside.any()
            if number == closest:
                radius[self.placed.kept[: state.t.size]] = np.where(state.inside, state.contacts.radius, 0.0) * length
        pull_off, visits = self._pull_off(tension, parted, modulus), state.t.size * len(steps)
        return Adhering(steps, radius, visits, avalanches, pull_off, self._crowding())

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

    def _pull_off(self, tension: Tension | None, parted: bool, modulus: float) -> PullOff:
        """Return the largest tension in SI; NaN where no unloading ends with all contacts parted."""
        length = self.placed.length
        if tension is None or not parted:
            return PullOff()
        if tension.force == 0.0:
            return PullOff(0.0)
        area = math.pi * length * length * tension.radius_squares
        force = math.pi * modulus * length * length * tension.force
        return PullOff(force, length * tension.separation, float(tension.contacts), area)

    def _complete(self, state: State) -> bool:
        """Return whether no asperity that was left out can touch."""
        if not state.inside.any():
            return True
        return not self.next_height - state.separation > min(below_all(state.potential), 0.0)

    def _crowding(self) -> str:
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

    def _totals(self, state: State, modulus: float, dissipated: float, names: set[str]) -> Step:
        problem, length = self.problem, self.placed.length
        if not state.inside.any():
            return Step(dissipated=dissipated)
        on = np.flatnonzero(state.inside)
        radius, load = state.contacts.radius[on], state.load[on]
        unit = math.pi * modulus * length * length
        stiffness = 0.0
        if "stiffness" in names:
            stiffness = -slope(*alone(problem, state))
        overlapping = np.zeros(state.t.size, np.bool_)
        close.mark_overlaps(problem.pairs, np.where(state.inside, state.contacts.radius, 0.0), overlapping)
        sizes = math.fsum(np.abs(load).tolist())
        share = float(np.abs(state.load[overlapping]).sum()) / sizes if sizes > 0.0 else 0.0
        tilt = np.hypot(*(state.field[1:3, on] + state.outer[1:3, on]))
        return Step(
            unit * math.fsum(load.tolist()),
            length * math.fsum(radius.tolist()),
            math.pi * length * length * math.fsum((radius * radius).tolist()),
            unit / length * stiffness,
            on.size,
            unit * sizes * (_SOLVER_ERROR + problem.coupling.error),
            Overlap(int(overlapping.sum()), share),
            int(np.count_nonzero(tilt * state.contacts.lift[on] > MOST_SLIDE * radius)),
            modulus * length**3 * energy(problem, state) if "energy" in names else 0.0,
            dissipated,
        )


def none(problem: Problem) -> Floats:
    """Return an outer field of none."""
    return np.zeros((5, problem.natural.size))


def prepare(shape: str) -> None:
    """Compile all that adhesive contacts of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    shared = example if isinstance(example, SharedProfile) else None
    parameters = {} if shared else {name: np.full(3, float(value)) for name, value in example.parameters.items()}
    place = np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble(shape, np.zeros(3), parameters, None, {"x": place, "y": place}, {"patch": 10.0}, shared)
    solve_path(ensemble, np.zeros(1), 1.0, 1e-6, Interaction(), set())
