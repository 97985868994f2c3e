"""The energy that a machine loses in its jumps, beyond that which contacts lose on the same way under fixed grips.

In a jump at one demand of the machine the energy of the contacts and of the machine falls. A part of that is lost by
contacts that are made or parted on the way; the rest sets the flat in motion, and the machine loses it.
"""

from collections.abc import Callable

import numpy as np

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.loading.machine import Jump, Machine
from roughmdr.numerics.arguments import Floats


def machine_loss(
    machine: Machine,
    jumps: list[Jump],
    separation: Floats,
    clear: float,
    along: Callable[[Floats, list[str]], LoadSeparation],
) -> Floats:
    """Return the energy [J] lost by the machine up to each step, of the path with these separations [m].

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
