"""The law of an ensemble along a path of the flat, or of the machine that moves it."""

from collections.abc import Callable, Iterable

import numpy as np

from roughmdr.aggregate.compute import compute
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.mean_field import ForceAndStiffness, coupling_in, of_independent, shift
from roughmdr.aggregate.preload import Specimen, to_preload
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.under_machine import separations_of
from roughmdr.errors import OutOfRange
from roughmdr.loading import steady_passage
from roughmdr.loading.machine import FIXED_GRIPS, Jump, Machine, MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import LOSSES

OF_MACHINE = {"separation", "remote"}
"""Variables that the machine gives."""
_OF_ERROR = 0.1  # allowed error of the force of the machine, over that asked for of coupled contacts


def simulate(problem: Problem, path: LoadingPath | MachinePath, variables: Iterable[str]) -> LoadSeparation:
    """Return the law of an ensemble along a path. Under a machine it has the separation as a variable too.

    The separation is NaN where a dead load has pulled the flat off. Errors as ``compute``.
    """
    names = list(variables)
    if isinstance(path, LoadingPath):
        return compute(problem, path, names)
    problem.check_asked([name for name in names if name not in OF_MACHINE])
    ensemble = problem.ensemble
    clear = problem.clear if ensemble.height.size else 0.0

    def under(path: MachinePath, names: list[str]) -> LoadSeparation:
        of_contacts = [name for name in names if name not in OF_MACHINE]
        if problem.interaction is not None and problem.asked_adhesion.work > 0.0 and path.machine != FIXED_GRIPS:
            from roughmdr.aggregate.coupled import law_on_machine

            law, separation = law_on_machine(problem, path, of_contacts, clear)
            return with_place(law, separation, path).only(names)
        lossy = not LOSSES.isdisjoint(names)
        separation, jumps = _separations(problem, path, jumps=lossy)
        way = np.where(np.isinf(separation), clear, separation)
        law = with_place(compute(problem, _way(way, path), of_contacts), separation, path)
        if jumps and lossy:
            lost = machine_loss(
                path.machine, jumps, way, clear, lambda h, names: compute(problem, _way(h, path), names)
            )
            variables = {name: law.variables[name] + lost for name in LOSSES.intersection(names)}
            law = law._replace(variables=law.variables | variables)
        return law.only(names)

    if path.preload is not None:
        if not ensemble.height.size:
            raise OutOfRange("path: without asperities no preload is reached")
        path = to_preload(path, Specimen(under, clear, problem.depth, ensemble.nominal_area, problem.paired))
    return under(path, names)


def with_place(law: LoadSeparation, separation: Floats, path: MachinePath) -> LoadSeparation:
    """Return the law with the separation [m] at each step, inf where there is none, and the position of the machine."""
    place = {"separation": np.where(np.isinf(separation), np.nan, separation), "remote": path.demand}
    return law._replace(variables=law.variables | place)


def _way(separation: Floats, path: MachinePath) -> LoadingPath:
    """Return the path of the flat that a machine moves."""
    return LoadingPath.along(separation, unload=False, adhesive=path.adhesive)


def _separations(problem: Problem, path: MachinePath, *, jumps: bool) -> tuple[Floats, list[Jump]]:
    """Return the separation at each step of a machine, and its jumps; inf where a dead load has pulled the flat off.

    Asperities that feel each other must not adhere.
    """
    if path.machine == FIXED_GRIPS:
        return path.demand, []
    height, interaction = problem.ensemble.height, problem.interaction

    def independent(machine: Machine) -> tuple[Floats, list[Jump]]:
        return separations_of(problem, machine, path.demand, jumps=jumps)

    if interaction is None or not height.size:
        return independent(path.machine)
    if interaction.model == "mean_field":
        coupling = coupling_in(problem)
        if path.machine.is_dead_load:
            return np.asarray(independent(path.machine)[0] + coupling * path.demand), []  # the force is known
        return _under_mean_field(of_independent(problem), path, coupling), []
    from roughmdr.aggregate.coupled import response_of_coupled

    law, error = response_of_coupled(problem), _OF_ERROR * interaction.error
    given = path.demand, path.machine, float(height[0]), problem.depth, error
    return steady_passage.separations_of(law, *given), []


def _under_mean_field(independent: ForceAndStiffness, path: MachinePath, coupling: float) -> Floats:
    """Return the separation at each step of a machine, from the law of independent asperities and c [m/N].

    A mean field c in series with a spring 1/k is a softer spring: F = F0(h + c F) with h = X + F/k is
    F0(X + (c + 1/k) F).
    """
    found = shift(independent, path.demand, coupling + path.machine.compliance)
    return np.asarray(path.demand + path.machine.compliance * found.force)


def machine_loss(
    machine: Machine,
    jumps: list[Jump],
    separation: Floats,
    clear: float,
    along: Callable[[Floats, list[str]], LoadSeparation],
) -> Floats:
    """Return the energy [J] that the machine loses up to each step, of the path with these separations [m].

    In a jump, at one demand, the energy of contacts and machine falls. Contacts that are made or parted meanwhile lose
    a part of it, as under fixed grips; the rest sets the flat in motion and is lost by the machine.

    A flat that a dead load pulls off is followed up to ``clear`` [m], where no contact is left. ``along`` returns the
    law along separations [m].
    """
    step = np.array([jump.step for jump in jumps])
    demand = np.array([jump.demand for jump in jumps])
    limits = np.array([[jump.before, jump.after] for jump in jumps])
    limits[np.isinf(limits)] = clear
    position = np.repeat(step, 2)  # each jump comes before its step
    whole = np.insert(separation, position, limits.ravel())
    first = np.searchsorted(position, np.arange(separation.size), side="right") + np.arange(separation.size)
    at = np.setdiff1d(np.arange(whole.size), first).reshape(-1, 2)
    found = along(whole, ["force", "energy", "dissipated_energy"]).variables
    energy = found["energy"] + found["dissipated_energy"]
    before, after = at.T
    lost = (
        energy[before] - energy[after] + (machine.energy(limits[:, 0], demand) - machine.energy(limits[:, 1], demand))
    )
    return np.cumsum(np.bincount(step, lost, separation.size))
