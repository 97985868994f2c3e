"""The law of an ensemble along a path of the flat, or of the machine that moves it."""

from collections.abc import Iterable

import numpy as np

from roughmdr.aggregate.compute import compute
from roughmdr.aggregate.detachment import clear_separation
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.machine_loss import machine_loss
from roughmdr.aggregate.preload import Specimen, to_preload
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.under_machine import separations_of
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.interaction.placed import check_placed
from roughmdr.interaction.settings import Interaction, reason_against_adhesion
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.loading import smooth_passage
from roughmdr.loading.machine import FIXED_GRIPS, Jump, MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats

OF_MACHINE = {"separation", "remote"}
"""Variables that the machine gives."""
_LOSSES = {"dissipated_energy", "machine_dissipated_energy"}


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

    def along(path: LoadingPath, names: list[str]) -> LoadSeparation:
        return compute(
            ensemble,
            path,
            effective_modulus=effective_modulus,
            adhesion=adhesion,
            variables=names,
            interaction=interaction,
        )

    if isinstance(path, LoadingPath):
        return along(path, names)
    if interaction is not None:
        check_placed(ensemble, interaction)
        if reason := reason_against_adhesion(interaction, adhesion):
            raise SceneError(f"interaction {reason}")
    clear = clear_separation(ensemble, effective_modulus, adhesion) if ensemble.height.size else 0.0

    def under(path: MachinePath, names: list[str]) -> LoadSeparation:
        lossy = not _LOSSES.isdisjoint(names)
        separation, jumps = _separations(ensemble, path, effective_modulus, adhesion, interaction, jumps=lossy)
        flown = np.isinf(separation)
        separation = np.where(flown, clear, separation)
        law = along(_way(separation, path), [name for name in names if name not in OF_MACHINE])
        variables = {**law.variables, "separation": np.where(flown, np.nan, separation), "remote": path.demand}
        if jumps and lossy:
            lost = machine_loss(path.machine, jumps, separation, clear, lambda h, names: along(_way(h, path), names))
            variables |= {name: variables[name] + lost for name in _LOSSES.intersection(names)}
        return law._replace(variables=variables).only(names)

    if path.preload is not None:
        if not ensemble.height.size:
            raise OutOfRange("path: without asperities no preload is reached")
        depth = ensemble.spread or float(ensemble.nondimensional().rise[0])
        coupled = interaction is not None and interaction.model == "pairwise"
        path = to_preload(path, Specimen(under, clear, depth, ensemble.nominal_area, coupled))
    return under(path, names)


def _way(separation: Floats, path: MachinePath) -> LoadingPath:
    """Return the path of the flat that a machine moves."""
    return LoadingPath.along(separation, unload=False, adhesive=path.adhesive)


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
    if path.machine == FIXED_GRIPS:
        return path.demand, []
    columns = ensemble.nondimensional()
    validity = jkr_validity(ensemble.shape, ensemble.spread, columns, effective_modulus, adhesion)
    adhesion = adhesion.resolved(validity.jkr_error)
    alone = interaction is None or not ensemble.height.size
    if alone or adhesion.work > 0.0:
        kernels = choose(ensemble.shape, adhesion, columns.params)
        found = separations_of(
            kernels, ensemble.height, columns, effective_modulus, adhesion, path.machine, path.demand, jumps=jumps
        )
        if alone or interaction is None:
            return found
        from roughmdr.interaction.jkr.machine import separations_of as of_coupled

        lowest = min(float(found[0].min()), float(ensemble.height[0]))  # as far as independent ones let the flat come
        material = effective_modulus, adhesion.work
        return of_coupled(ensemble, path.machine, path.demand, material, interaction, lowest)

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
