"""Adhesive contacts that feel each other, along a path of a machine: the totals at each step."""

import math

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.front import Front
from roughmdr.interaction.jkr.machine import Hanging
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Interaction
from roughmdr.loading.machine import DEAD_LOAD, Machine, MachinePath, legs_of


def solve_on_machine(
    ensemble: Ensemble,
    path: MachinePath,
    effective_modulus: float,
    work: float,
    interaction: Interaction,
    names: set[str],
    clear: float,
    reach: float = 0.0,
) -> Adhering:
    """Return adhesive contacts at the demands of a machine, whose flat comes from infinity; w [J/m2].

    A flat that a dead load pulls off is followed up to ``clear`` [m], or to where its last contact parts. Otherwise as
    ``path.solve_path``.
    """
    placed = Placed(ensemble, effective_modulus, interaction)
    machine, unit = _in_patch(path.machine, effective_modulus, placed.length)
    legs, front = legs_of(path.demand), Front(placed, effective_modulus, work)
    rises = any(leg.rises for leg in legs)
    account = Account(front, effective_modulus, ensemble.height.size, names, rises=rises, reach=reach)
    lossy = not {"dissipated_energy", "machine_dissipated_energy"}.isdisjoint(names)
    flat = Hanging(front, account, machine, unit, clear / placed.length, lossy=lossy)
    try:
        for leg in legs:
            flat.follow(leg)
    except NoEquilibriumError:
        account.lose_rest(path.demand.size)
    return account.result()


def _in_patch(machine: Machine, modulus: float, length: float) -> tuple[Machine, float]:
    """Return a machine in units of the patch, and the unit of its demand in SI."""
    force = math.pi * modulus * length * length
    if machine.is_dead_load:
        return DEAD_LOAD, force
    return Machine(1.0, machine.compliance * force / length), length
