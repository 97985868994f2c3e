"""Coupled asperities along a path of the flat: who can touch, the equilibrium at each separation, and the totals.

Without adhesion contacts have no memory: each separation is solved once, where the flat first comes to it, from the
contacts at the one before. What comes later on a path changes nothing.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction import close
from roughmdr.interaction.conductance import Punches, total_conductance
from roughmdr.interaction.contacts import coupled_kernels
from roughmdr.interaction.coupling import Coupling
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import Periodic
from roughmdr.interaction.mesh import Mesh
from roughmdr.interaction.newton import Equilibrium, State, System, solve, total_stiffness
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Boundary, Interaction
from roughmdr.interaction.totals import Step, of_all, total
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.underway import each_step
from roughmdr.shapes import SHAPES

DENSE_UP_TO: dict[Boundary, int] = {"periodic": 150, "free": 1500}
"""Number of asperities up to which pairs are summed one by one: where both take as long
(``pipelines/study.py coupling``)."""
_MESH_ERROR, _SOLVER_ERROR = 0.3, 0.6  # shares of the error asked for
_TANGENT_ERROR = 1e-3  # error of the mesh for the steps, each of which leaves a few per cent
_GROWTH = 1.3  # growth of the number of asperities that can touch, so that a few separations share one
_ROUGH_ERROR = 1e-2  # relative error of the force until all asperities that can touch are taken
_FAILURES = 3  # separations without an equilibrium, one after the other, below which none is looked for


class Coupled(NamedTuple):
    """Coupled asperities along a path."""

    steps: list[Step]
    radius: Floats
    """The contact radius [m] of each asperity where the flat is closest, or at the step asked for."""
    force: Floats
    """The force [N] of each there."""
    visits: int


class Candidates(Placed):
    """The highest asperities of an ensemble: all that can touch, and some more."""

    def __init__(self, ensemble: Ensemble, effective_modulus: float, interaction: Interaction) -> None:
        super().__init__(ensemble, effective_modulus, interaction)
        self.kernels = coupled_kernels(self.kernels_alone)
        self.system = self._system(0)

    @property
    def count(self) -> int:
        """Number of asperities that can touch."""
        return int(self.system.asperities.height.size)

    def _system(self, count: int) -> System:
        """Return the ``count`` highest asperities, coupled."""
        asperities = self.asperities(count)
        at, periodic = self.at[:count], self.interaction.boundary == "periodic"
        x, y = np.ascontiguousarray(at.T)
        coupling: Coupling
        tangent: Coupling
        if count <= DENSE_UP_TO[self.interaction.boundary]:
            coupling = tangent = Dense(x, y, self.patch, periodic)
        else:
            error = _MESH_ERROR * self.interaction.error
            coupling = Mesh(x, y, self.patch, periodic, error)
            tangent = Mesh(x, y, self.patch, periodic, _TANGENT_ERROR) if error < _TANGENT_ERROR else coupling
        return System(self.kernels, asperities, coupling, tangent, at, self.sides, self.interaction.order)

    def extend(self, lowest: float) -> bool:
        """Take asperities down to a height [side of the patch], and some more; whether that changed anything."""
        needed = int(np.searchsorted(-self.height, -lowest, side="right"))
        if needed <= self.count:
            return False
        target = max(DENSE_UP_TO[self.interaction.boundary], math.ceil(_GROWTH * needed))
        self.system = self._system(min(target, self.height.size))
        return True


class Flat:
    """A flat that goes from one separation to the next over coupled asperities, E* [Pa]; errors as ``solve_path``.

    Stiffness, conductance and ``CROWDING`` where ``names`` asks for them.
    """

    def __init__(self, ensemble: Ensemble, effective_modulus: float, interaction: Interaction, names: set[str]) -> None:
        self.candidates = Candidates(ensemble, effective_modulus, interaction)
        self._names = names
        self._steps = dict[float, Step]()
        self._last, self._x, self._rate = math.inf, np.empty(0), np.empty(0)
        self._failures, self._lowest = 0, -math.inf
        self.visits = 0

    def go(self, separation: float) -> tuple[Step, State | None]:
        """Return the totals at a separation [m], and the contacts: None where they are not found anew."""
        h = separation / self.candidates.length
        if h in self._steps:
            return self._steps[h], None
        if h <= self._lowest:
            return Step(error=math.inf), None
        found = _settle(self.candidates, h, self._last, self._x, self._rate)
        self.visits += self.candidates.count
        self._steps[h] = step = _totals(self.candidates, found, h, self._names)
        if not math.isfinite(found.error):
            self._failures += 1
            self._lowest = h if self._failures == _FAILURES else self._lowest
            return step, None
        x, before = found.state.x, self._x
        known = math.isfinite(self._last)
        self._rate = (x[: before.size] - before) / (self._last - h) if known else np.full(before.size, np.nan)
        self._x, self._last, self._failures = x, h, 0
        return step, found.state


def solve_path(
    ensemble: Ensemble,
    separation: Floats,
    effective_modulus: float,
    interaction: Interaction,
    names: set[str],
    at: int | None = None,
) -> Coupled:
    """Return coupled asperities at separations [m]; stiffness, conductance and crowding where ``names`` asks for them.

    Each contact is told where the flat is closest, or at step number ``at``. The ensemble has positions. SceneError
    where two asperities have one position; OutOfRange where a contact is not representable.
    """
    flat = Flat(ensemble, effective_modulus, interaction, names)
    told, steps, state = math.inf if at is None else separation[at], list[Step](), None
    for h in each_step(separation.tolist()):
        step, found = flat.go(h)
        steps.append(step)
        if found is not None and (h < told if at is None else h == told):
            state, told = found, h
    radius, force = np.zeros((2, ensemble.height.size))
    if state is not None:
        contacts = state.contacts
        radius, force = of_all(flat.candidates, contacts.load > 0.0, contacts.radius, contacts.load)
    return Coupled(steps, radius, force, flat.visits)


def _settle(candidates: Candidates, h: float, last: float, x: Floats, moved: Floats) -> Equilibrium:
    """Return the equilibrium at a separation, with all asperities that can touch."""
    asked = _SOLVER_ERROR * candidates.interaction.error
    candidates.extend(h)
    complete = candidates.count == candidates.height.size
    while True:
        guess = candidates.system.asperities.height - h
        if x.size:
            rate = np.where(np.isfinite(moved), moved, 1.0) if moved.size else np.ones(x.size)
            rate = np.concatenate([rate, np.ones(x.size - rate.size)])
            advanced = x + rate * (last - h) if math.isfinite(last) else x
            lag = float(np.mean(advanced - guess[: x.size]))
            guess = np.concatenate([advanced, guess[x.size :] + min(lag, 0.0)])
        found = solve(candidates.system, guess, h, asked if complete else max(asked, _ROUGH_ERROR))
        if not math.isfinite(found.error) or (complete and candidates.count == candidates.height.size):
            return found
        load, lift = found.state.contacts.load, found.state.contacts.lift
        least = candidates.system.coupling.least_displacement(load) if load.any() else 0.0
        apart = load == 0.0
        highest_lift = -float(lift[apart].min(initial=0.0))
        extended = candidates.extend(h + min(least, 0.0) - highest_lift)
        if complete and not extended:
            return found
        complete = not extended
        x, moved, last = found.state.x, np.empty(0), math.inf


def _totals(candidates: Candidates, found: Equilibrium, h: float, names: set[str]) -> Step:
    """Return the totals of an equilibrium in SI."""
    if not math.isfinite(found.error):
        return Step(error=math.inf)
    state, contacts, system = found.state, found.state.contacts, candidates.system
    touching = contacts.load > 0.0
    if not touching.any():
        return Step()
    step = total(candidates, touching, contacts.radius, contacts.load, state.pairs, names, contacts.punch)
    stiffness = conductance = 0.0
    if "stiffness" in names:
        stiffness = math.pi * candidates.modulus * candidates.length * total_stiffness(system, state, h)
    if "conductance_radius" in names:
        conductance = candidates.length * total_conductance(_punches(system, state), candidates.interaction.error)
    if math.isnan(stiffness + conductance):
        return Step(error=math.inf)
    error = step.error * (found.error + system.coupling.error)
    return step._replace(stiffness=stiffness, error=error, lost=state.lost, conductance=conductance)


def _punches(system: System, state: State) -> Punches:
    """Return the contacts as punches that stay level."""
    contacts, pairs = state.contacts, state.pairs._replace(share=np.zeros_like(state.pairs.share))
    radius = np.where(contacts.load > 0.0, contacts.radius, 0.0)
    close.update_shares(pairs, radius)
    return Punches(radius, -contacts.slide * state.slopes, system.coupling, system.tangent, pairs, system.order)


def prepare(shape: str) -> None:
    """Compile all that the asperities of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    height, place = np.array([2e-3, 1e-3, 0.0]), np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble.alike(example, height, {"x": place, "y": place}, 10.0)
    asked = Interaction(model="pairwise")
    solve_path(ensemble, np.zeros(1), 1.0, asked, {"stiffness", "conductance_radius"})
    mesh = Mesh(place / 10.0, place / 10.0, Periodic.of(1.0), True, asked.error)
    mesh.field(height)
    mesh.of_moments(height, height, height)
