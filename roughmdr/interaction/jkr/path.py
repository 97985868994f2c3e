"""Adhesive contacts that feel each other, along a path of the flat or of its machine: the totals and the jumps."""

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.close import Pairs
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.front import Front
from roughmdr.interaction.jkr.machine import Hanging, in_patch
from roughmdr.interaction.placed_asperities import Placed
from roughmdr.interaction.settings import Interaction
from roughmdr.loading.machine import MachinePath, legs_of
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, SharedProfile

_ABOVE = 1e-9  # of the side of the patch: from so far above first touch the flat comes at least
_MAX_ROUNDS = 20
_SAME = 1e-13  # of the natural depth, in the lowest separation of a path


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
    front = Front(placed, effective_modulus, work, float(separation.min()) / placed.length)
    rises = np.diff(separation, prepend=np.inf) > 0.0
    account = Account(front, effective_modulus, ensemble.height.size, names, rises=bool(rises.any()))
    state = front.parted(max(float(separation[0]) / placed.length, front.top + _ABOVE))
    try:
        for h, up in zip(separation.tolist(), rises.tolist(), strict=True):
            state, pieces = front.go(state, h / placed.length)
            for piece in pieces:
                account.pass_over(piece)
            account.stand(state, h, rises=up)
    except NoEquilibriumError:
        account.lose_rest(separation.size)
    return account.result()


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

    A flat that a dead load pulls off is followed up to ``clear`` [m], or to where its last contact parts. How pairs that
    overlap are taken depends on how close the flat comes: the path is followed again until both agree.
    """
    placed = Placed(ensemble, effective_modulus, interaction)
    machine, unit = in_patch(path.machine, effective_modulus, placed.length)
    legs = [leg._replace(demand=leg.demand / unit) for leg in legs_of(path.demand)]
    lossy = not {"dissipated_energy", "machine_dissipated_energy"}.isdisjoint(names)
    lowest = float(placed.height.max(initial=-np.inf))
    front = Front(placed, effective_modulus, work, lowest)
    for _ in range(_MAX_ROUNDS):
        rises = any(leg.rises for leg in legs)
        account = Account(front, effective_modulus, ensemble.height.size, names, rises=rises)
        flat, found = Hanging(front, account, machine, clear / placed.length, lossy=lossy), True
        try:
            for leg in legs:
                flat.follow(leg)
        except NoEquilibriumError:
            found = False
            account.lose_rest(path.demand.size)
        if lowest - flat.lowest <= _SAME * front.depth if not found else abs(lowest - flat.lowest) <= _SAME * front.depth:
            break
        lowest = min(flat.lowest, front.top)
        if not found:
            lowest -= max(front.top - lowest, front.depth)
        pairs = front.pairs
        front.bring_down(lowest)
        if found and _are_same(pairs, front.pairs):
            break
    return account.result()


def _are_same(pairs: Pairs, others: Pairs) -> bool:
    """Return whether the same pairs overlap as much."""
    return np.array_equal(pairs.members, others.members) and np.array_equal(pairs.share, others.share)


def prepare(shape: str) -> None:
    """Compile all that adhesive contacts of a shape need, before several threads or a clock need it."""
    kind = SHAPES[shape]
    example = kind(**kind.example())
    shared = example if isinstance(example, SharedProfile) else None
    parameters = {} if shared else {name: np.full(3, float(value)) for name, value in example.parameters.items()}
    place = np.array([0.0, 1.0, 3.0])
    ensemble = Ensemble(shape, np.zeros(3), parameters, None, {"x": place, "y": place}, {"patch": 10.0}, shared)
    solve_path(ensemble, np.zeros(1), 1.0, 1e-6, Interaction(), set())
