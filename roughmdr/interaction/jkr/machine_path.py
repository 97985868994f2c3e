"""Adhesive contacts that feel each other, along a path of a machine: the totals at each step.

How pairs that overlap are taken depends on how close the flat comes, which depends on it in turn: first the lowest
separation is found, from the ends of the legs, and then all steps.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.close import Pairs
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.front import Front
from roughmdr.interaction.jkr.machine import Hanging
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Interaction
from roughmdr.loading.machine import DEAD_LOAD, Leg, Machine, MachinePath, legs_of

_MAX_ROUNDS, _MAX_FAILURES = 30, 3
_SETTLED = 1e-12  # of the natural depth, in the lowest separation, on which the others depend a hundred times less


class _Trial(NamedTuple):
    """A lowest separation that was assumed, and by how much that found is above."""

    lowest: float
    off: float


def solve_on_machine(
    ensemble: Ensemble,
    path: MachinePath,
    effective_modulus: float,
    work: float,
    interaction: Interaction,
    names: set[str],
    clear: float,
) -> Adhering:
    """Return adhesive contacts at the demands of a machine, whose flat comes from infinity; w [J/m2].

    A flat that a dead load pulls off is followed up to ``clear`` [m], or to where its last contact parts. Otherwise as
    ``path.solve_path``.
    """
    placed = Placed(ensemble, effective_modulus, interaction)
    machine, unit = _in_patch(path.machine, effective_modulus, placed.length)
    legs = legs_of(path.demand)
    front = Front(placed, effective_modulus, work, float(placed.height.max(initial=-math.inf)))
    front.bring_down(front.top - front.depth)

    def follow(legs: list[Leg], names: set[str]) -> tuple[Account, float, bool]:
        """Return the account of legs, their lowest separation, and whether there always was an equilibrium."""
        rises = any(leg.rises for leg in legs)
        account = Account(front, effective_modulus, ensemble.height.size, names, rises=rises)
        lossy = not {"dissipated_energy", "machine_dissipated_energy"}.isdisjoint(names)
        flat = Hanging(front, account, machine, unit, clear / placed.length, lossy=lossy)
        try:
            for leg in legs:
                flat.follow(leg)
        except NoEquilibriumError:
            account.lose_rest(path.demand.size)
            return account, flat.lowest, False
        return account, flat.lowest, True

    ends = [leg._replace(demand=leg.demand[-1:]) for leg in legs]
    before, failures = None, 0
    for _ in range(_MAX_ROUNDS):
        _, lowest, found = follow(ends, set())
        pairs, trial = front.pairs, _Trial(front.lowest, min(lowest, front.top) - front.lowest)
        failures = 0 if found else failures + 1
        if abs(trial.off) <= _SETTLED * front.depth if found else failures > _MAX_FAILURES:
            break
        deeper = trial.lowest - max(front.top - trial.lowest, front.depth)
        front.bring_down(_next(trial, before) if found else deeper)
        before = trial if found else None
        if found and _are_same(pairs, front.pairs):
            break
    return follow(legs, names)[0].result()


def _next(trial: _Trial, before: _Trial | None) -> float:
    """Return the next lowest separation to assume: that found, or by the secant where trials come nearer."""
    if before is None or not abs(trial.off) < 0.5 * abs(before.off):
        return trial.lowest + trial.off
    return trial.lowest - trial.off * (trial.lowest - before.lowest) / (trial.off - before.off)


def _are_same(pairs: Pairs, others: Pairs) -> bool:
    """Return whether the same pairs overlap as much."""
    return np.array_equal(pairs.members, others.members) and np.array_equal(pairs.share, others.share)


def _in_patch(machine: Machine, modulus: float, length: float) -> tuple[Machine, float]:
    """Return a machine in units of the patch, and the unit of its demand in SI."""
    force = math.pi * modulus * length * length
    if machine.is_dead_load:
        return DEAD_LOAD, force
    return Machine(1.0, machine.compliance * force / length), length
