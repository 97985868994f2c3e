"""Coupled asperities along a path of the flat: who can touch, the equilibrium at each separation, and the totals.

Without adhesion contacts have no memory: each separation is solved once, from the largest down, from the contacts at
the one before.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.interaction import close
from roughmdr.interaction.buried import buried
from roughmdr.interaction.contacts import Asperities, coupled_kernels
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.green import Periodic
from roughmdr.interaction.mesh import Mesh
from roughmdr.interaction.newton import Coupling, Equilibrium, State, System, solve, total_stiffness
from roughmdr.interaction.placed import sides_of
from roughmdr.interaction.settings import DEFAULT_ERROR, Boundary, Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns, Kernels, Material
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, SharedProfile

DENSE_UP_TO: dict[Boundary, int] = {"periodic": 150, "free": 1500}
"""Number of asperities up to which pairs are summed one by one: where both take as long (``pipelines/coupling.py``)."""
_MESH_ERROR, _SOLVER_ERROR = 0.3, 0.6  # of the error asked for
_TANGENT_ERROR = 1e-3  # of the mesh for the steps, each of which leaves a few per cent
_GROWTH = 1.3  # of the number of asperities that can touch, so that a few separations have the same
_ROUGH_ERROR = 1e-2  # of the force, until all asperities that can touch are taken
_FAILURES = 3  # separations without an equilibrium, one after the other, below which none is looked for
_SMALLEST = np.finfo(np.float64).tiny


class Overlap(NamedTuple):
    """Contacts that overlap a neighbour's."""

    contacts: int
    share: float
    """Of the force."""


class Step(NamedTuple):
    """The totals at one separation, in SI."""

    force: float = 0.0
    radius_sum: float = 0.0
    area: float = 0.0
    stiffness: float = 0.0
    contacts: int = 0
    error: float = 0.0
    """About that of the force [N]; inf where there is no equilibrium."""
    overlap: Overlap = Overlap(0, 0.0)
    lost: int = 0
    """Number of contacts that are no discs."""


class Coupled(NamedTuple):
    """Coupled asperities along a path."""

    steps: list[Step]
    radius: Floats
    """The contact radius [m] of each asperity where the flat is closest."""
    visits: int


class Candidates:
    """The highest asperities of an ensemble: all that can touch, and some more."""

    def __init__(self, ensemble: Ensemble, effective_modulus: float, interaction: Interaction) -> None:
        at = np.column_stack([ensemble.positions[name] for name in ("x", "y")])
        at -= at.min(axis=0)
        sides = sides_of(ensemble)
        if interaction.boundary == "free" or sides is None:
            whole = float(np.ptp(at, axis=0).max())
            sides = (whole, whole) if whole > 0.0 else (1.0, 1.0)
        self.length, self.interaction = sides[0], interaction
        self.patch = Periodic.of(sides[1] / sides[0])
        _check_apart(ensemble, at / self.length, self.sides)
        hidden = buried(ensemble, at, None if self.sides is None else self.sides * self.length)
        self.kept = np.flatnonzero(~hidden)
        """The numbers of the asperities that are not buried."""
        ensemble = ensemble.taken(self.kept)
        columns = ensemble.nondimensional()
        law = choose(ensemble.shape, Adhesion(), columns.params)
        self.kernels = coupled_kernels(law)
        self.at = at[self.kept] / self.length
        self.height = ensemble.height / self.length
        self._columns, self._material = columns, Material(effective_modulus, 0.0, math.inf)
        self._natural = _natural_scales(self.kernels, columns, self._material, self.height.size)
        self.system = self._system(0)

    @property
    def sides(self) -> Floats | None:
        """Sides of the patch that repeats."""
        return np.array([1.0, self.patch.side_y]) if self.interaction.boundary == "periodic" else None

    @property
    def count(self) -> int:
        """Number of asperities that can touch."""
        return int(self.system.asperities.height.size)

    def _system(self, count: int) -> System:
        """Return the ``count`` highest asperities, coupled."""
        depth, size = self._natural
        params = self.kernels.prepare(self._material, self._columns, 0, max(count, 1), 0.0)
        asperities = Asperities(self.height[:count], depth[:count] / self.length, size[:count] / self.length, params)
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


def _natural_scales(kernels: Kernels, columns: Columns, material: Material, count: int) -> tuple[Floats, Floats]:
    """Return natural depths and radii [m]; OutOfRange where one is not representable."""
    params = kernels.prepare(material, columns, 0, count, 0.0)
    found = np.empty((2, count))
    for i in range(count):
        own = kernels.params_of(params, i)
        (depth, _), size, _, _ = kernels.scales(material.effective_modulus, 0.0, columns.width[i], columns.rise[i], own)
        found[:, i] = depth, size
    if not ((found >= _SMALLEST) & np.isfinite(found)).all():
        raise OutOfRange("the contact of an asperity is not representable")
    return found[0], found[1]


def _check_apart(ensemble: Ensemble, at: Floats, sides: Floats | None) -> None:
    """Raise SceneError where two asperities have the same position; ``at`` over the side of the patch."""
    wrapped = at if sides is None else at - sides * np.floor(at / sides)
    order = np.lexsort(wrapped.T)
    same = (np.diff(wrapped[order], axis=0) == 0.0).all(axis=1)
    if same.any():
        first = int(order[np.argmax(same)])
        x, y = (float(ensemble.positions[name][first]) for name in ("x", "y"))
        raise SceneError(
            f"ensemble: two asperities have the same position, x = {x:.6g} m, y = {y:.6g} m; "
            "interaction needs them apart"
        )


def solve_path(
    ensemble: Ensemble, separation: Floats, effective_modulus: float, interaction: Interaction, stiffness: bool
) -> Coupled:
    """Return coupled asperities at separations [m]; ``stiffness`` only where it is asked for.

    The ensemble has positions. SceneError where two asperities have one position; OutOfRange where a contact is not
    representable.
    """
    candidates = Candidates(ensemble, effective_modulus, interaction)
    length = candidates.length
    distinct, index = np.unique(-separation, return_inverse=True)
    steps, visits, x, moved = list[Step](), 0, np.empty(0), np.empty(0)
    last = math.inf
    state: State | None = None
    failures = 0
    for h in (-distinct / length).tolist():
        if failures == _FAILURES:
            steps.append(Step(error=math.inf))
            continue
        found = _settle(candidates, h, last, x, moved)
        visits += candidates.count
        steps.append(_totals(candidates, found, h, length, effective_modulus, stiffness))
        failures += 1
        if math.isfinite(found.error):
            state, before, failures = found.state, x, 0
            x = state.x
            rate = (x[: before.size] - before) / (last - h) if math.isfinite(last) else np.full(before.size, np.nan)
            moved, last = rate, h
    radius = np.zeros_like(ensemble.height)
    if state is not None:
        touching = state.contacts.load > 0.0
        radius[candidates.kept[: state.x.size]] = np.where(touching, state.contacts.radius, 0.0) * length
    return Coupled([steps[i] for i in index.ravel()], radius, visits)


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


def _totals(
    candidates: Candidates, found: Equilibrium, h: float, length: float, modulus: float, stiffness: bool
) -> Step:
    """Return the totals of an equilibrium in SI."""
    if not math.isfinite(found.error):
        return Step(error=math.inf)
    contacts, pairs = found.state.contacts, found.state.pairs
    touching = contacts.load > 0.0
    if not touching.any():
        return Step()
    overlapping = np.zeros(touching.size, dtype=np.bool_)
    close.mark_overlaps(pairs, np.where(touching, contacts.radius, 0.0), overlapping)
    load = math.fsum(contacts.load.tolist())
    force = math.pi * modulus * length * length * load
    overlap = Overlap(int(overlapping.sum()), float(contacts.load[overlapping].sum()) / load)
    rigidity = total_stiffness(candidates.system, found.state, h) if stiffness else 0.0
    if math.isnan(rigidity):
        return Step(error=math.inf)
    return Step(
        force,
        length * math.fsum(contacts.radius[touching].tolist()),
        math.pi * length * length * math.fsum((contacts.radius[touching] ** 2).tolist()),
        math.pi * modulus * length * rigidity,
        int(touching.sum()),
        force * (found.error + candidates.system.coupling.error),
        overlap,
        found.state.lost,
    )


def prepare(shape: str) -> None:
    """Compile all that the asperities of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    shared = example if isinstance(example, SharedProfile) else None
    parameters = {} if shared else {name: np.full(3, float(value)) for name, value in example.parameters.items()}
    height, place = np.array([2e-3, 1e-3, 0.0]), np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble(shape, height, parameters, None, {"x": place, "y": place}, {"patch": 10.0}, shared)
    solve_path(ensemble, np.zeros(1), 1.0, Interaction(), stiffness=True)
    mesh = Mesh(place / 10.0, place / 10.0, Periodic.of(1.0), True, DEFAULT_ERROR)
    mesh.field(height)
    mesh.of_moments(height, height, height)
