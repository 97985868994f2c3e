"""The law of an ensemble along a path of the flat, or of the machine that moves it."""

from collections.abc import Iterable

import numpy as np

from roughmdr.aggregate.compute import compute
from roughmdr.aggregate.detachment import clear_separation
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.machine_loss import machine_loss
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.under_machine import Jump, separations_of
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading import smooth_passage
from roughmdr.loading.machine import MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats


def simulate(
    ensemble: Ensemble,
    path: LoadingPath | MachinePath,
    *,
    effective_modulus: float,
    adhesion: Adhesion,
    variables: Iterable[str],
    interaction: Interaction | None = None,
) -> LoadSeparation:
    """Return the law of an ensemble along a path; E* [Pa]. Under a machine it has the separation as a variable too.

    That is NaN where a dead load has pulled the flat off. Errors as ``compute``.
    """
    names = list(variables)
    if isinstance(path, LoadingPath) or (interaction is not None and adhesion.work > 0.0):
        return compute(
            ensemble,
            path,
            effective_modulus=effective_modulus,
            adhesion=adhesion,
            variables=names,
            interaction=interaction,
        )
    lossy = not {"dissipated_energy", "machine_dissipated_energy"}.isdisjoint(names)
    separation, jumps = _separations(ensemble, path, effective_modulus, adhesion, interaction, jumps=lossy)
    flown, clear = np.isinf(separation), clear_separation(ensemble, effective_modulus, adhesion)
    separation = np.where(flown, clear, separation)

    def along(separation: Floats, names: list[str]) -> LoadSeparation:
        return compute(
            ensemble,
            LoadingPath.along(separation, unload=False, adhesive=path.adhesive),
            effective_modulus=effective_modulus,
            adhesion=adhesion,
            variables=names,
            interaction=interaction,
        )

    law = along(separation, [name for name in names if name != "separation"])
    variables = {**law.variables, "separation": np.where(flown, np.nan, separation)}
    if jumps:
        lost = machine_loss(path.machine, jumps, separation, clear, along)
        losing = {"dissipated_energy", "machine_dissipated_energy"}.intersection(names)
        variables |= {name: variables[name] + lost for name in losing}
    return law._replace(variables=variables)


def _separations(
    ensemble: Ensemble,
    path: MachinePath,
    effective_modulus: float,
    adhesion: Adhesion,
    interaction: Interaction | None,
    *,
    jumps: bool,
) -> tuple[Floats, list[Jump]]:
    """Return the separation at each step of a machine, and its jumps; inf where a dead load has pulled the flat off."""
    columns = ensemble.nondimensional()
    validity = jkr_validity(ensemble.shape, ensemble.spread, columns, effective_modulus, adhesion)
    adhesion = adhesion.resolved(validity.jkr_error)
    if interaction is None or not ensemble.height.size:
        kernels = choose(ensemble.shape, adhesion, columns.params)
        return separations_of(
            kernels, ensemble.height, columns, effective_modulus, adhesion, path.machine, path.demand, jumps=jumps
        )

    def law(turns: Floats, separation: Floats) -> tuple[Floats, Floats]:
        found = compute(
            ensemble,
            LoadingPath.along(separation, unload=False, adhesive=False),
            effective_modulus=effective_modulus,
            adhesion=adhesion,
            variables=["force", "stiffness"],
            interaction=interaction,
        )
        return found.variables["force"], found.variables["stiffness"]

    highest = float(ensemble.height[0])
    depth = ensemble.spread or float(columns.rise[0])
    return smooth_passage.separations_of(law, path.demand, path.machine, highest, highest, depth), []
