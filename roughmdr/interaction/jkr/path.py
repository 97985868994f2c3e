"""Adhesive contacts that feel each other, along a path of the flat: the totals at each separation, and the jumps."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction import close
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import State, alone, energy
from roughmdr.interaction.jkr.followed import Followed
from roughmdr.interaction.jkr.jumps import Avalanche
from roughmdr.interaction.jkr.lone import MOST_SLIDE
from roughmdr.interaction.jkr.tension import Tension, slope
from roughmdr.interaction.settings import Interaction
from roughmdr.interaction.totals import Overlap, Step
from roughmdr.loading.pull_off import PullOff
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, SharedProfile

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
    followed = Followed(ensemble, effective_modulus, work, interaction, float(separation.min()))
    length, state = followed.placed.length, followed.begin(float(separation[0]))
    unit = effective_modulus * length**3
    steps, avalanches, radius, dissipated = list[Step](), list[Avalanche](), np.zeros(ensemble.height.size), 0.0
    closest, lost, parted = int(np.argmin(separation)), False, False
    tension = Tension() if (np.diff(separation) > 0.0).any() else None
    for number, h in enumerate((separation / length).tolist()):
        try:
            if not lost:
                state, found, tension = followed.to(state, h, tension)
                for one in found:
                    dissipated += one.dissipated * unit
                    avalanches.append(Avalanche(one.separation * length, one.size, one.dissipated * unit))
        except NoEquilibriumError:
            lost = True
        if lost:
            steps.append(Step(error=math.inf))
            continue
        steps.append(_totals(followed, state, effective_modulus, dissipated, names))
        parted |= number > 0 and separation[number] > separation[number - 1] and not state.inside.any()
        if number == closest:
            kept = followed.placed.kept[: state.t.size]
            radius[kept] = np.where(state.inside, state.contacts.radius, 0.0) * length
    pull_off, visits = _pull_off(tension, parted, effective_modulus, length), state.t.size * len(steps)
    return Adhering(steps, radius, visits, avalanches, pull_off, followed.crowding())


def _pull_off(tension: Tension | None, parted: bool, modulus: float, length: float) -> PullOff:
    """Return the largest tension in SI; NaN where no unloading ends with all contacts parted."""
    if tension is None or not parted:
        return PullOff()
    if tension.force == 0.0:
        return PullOff(0.0)
    area = math.pi * length * length * tension.radius_squares
    force = math.pi * modulus * length * length * tension.force
    return PullOff(force, length * tension.separation, float(tension.contacts), area)


def _totals(followed: Followed, state: State, modulus: float, dissipated: float, names: set[str]) -> Step:
    """Return the totals [SI] of a state."""
    problem, length = followed.problem, followed.placed.length
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


def prepare(shape: str) -> None:
    """Compile all that adhesive contacts of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    shared = example if isinstance(example, SharedProfile) else None
    parameters = {} if shared else {name: np.full(3, float(value)) for name, value in example.parameters.items()}
    place = np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble(shape, np.zeros(3), parameters, None, {"x": place, "y": place}, {"patch": 10.0}, shared)
    solve_path(ensemble, np.zeros(1), 1.0, 1e-6, Interaction(), set())
