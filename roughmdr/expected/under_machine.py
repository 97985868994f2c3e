"""The expected law of asperities whose flat hangs on a machine: that of a surface without end."""

from collections.abc import Iterable
from functools import partial

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation, Problem
from roughmdr.aggregate.preload import Specimen, to_preload
from roughmdr.aggregate.simulate import OF_MACHINE, simulate
from roughmdr.ensemble import Source
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.expected.compute import compute
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import FIXED_GRIPS, MachinePath
from roughmdr.loading.smooth_passage import separations_of
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import LOSSES

_CHANCE = 1e-9  # probability that an asperity is higher than where the search begins


def compute_under_machine(
    source: Source,
    path: MachinePath,
    *,
    effective_modulus: float,
    adhesion: Adhesion,
    variables: Iterable[str],
    interaction: Interaction | None = None,
) -> LoadSeparation:
    """Return the expected law along the path of a machine, with the separation; arguments and errors as ``compute``.

    Asperities of which nothing is drawn are their own mean. For others, SceneError for an energy that jumps lose: the
    jumps of a mean law are not those of patches.
    """
    names = list(variables)
    if source.all_alike:
        return simulate(Problem(source.ensemble(0, 0), effective_modulus, adhesion, interaction), path, names)
    if path.machine != FIXED_GRIPS and (lost := sorted(LOSSES.intersection(names))):
        raise SceneError(f"variables: {', '.join(lost)} of an expected law under a machine are not available")
    extreme = source.extremes(_CHANCE)
    first_touch = float(extreme.height.max()) + (adhesion.range if adhesion.cohesive else 0.0)
    clear = Problem(extreme, effective_modulus, adhesion).clear
    if not np.isfinite(clear):
        raise OutOfRange("the contact of asperities as extreme as there may be is not representable")
    clear = max(clear, first_touch)
    depth = source.sigma or float(extreme.columns.rise[0])

    of_means = partial(compute, source, effective_modulus=effective_modulus, adhesion=adhesion, interaction=interaction)

    def along(separation: Floats, names: list[str]) -> LoadSeparation:
        return of_means(LoadingPath.along(separation, unload=False, adhesive=path.adhesive), variables=names)

    def law(turns: Floats, separation: Floats) -> tuple[Floats, Floats]:
        found = along(np.concatenate([turns, separation]), ["force", "stiffness"]).variables
        force, stiffness = (found[name][turns.size :] for name in ("force", "stiffness"))
        return force, np.full_like(stiffness, np.nan) if path.adhesive else stiffness

    def under(path: MachinePath, names: list[str]) -> LoadSeparation:
        separation = path.demand
        if path.machine != FIXED_GRIPS:
            separation = separations_of(law, path.demand, path.machine, first_touch, clear, depth)
        flown = np.isinf(separation)
        separation = np.where(flown, clear, separation)
        found = along(separation, [name for name in names if name not in OF_MACHINE])
        own = {"separation": np.where(flown, np.nan, separation), "remote": path.demand}
        return found._replace(variables={**found.variables, **own}).only(names)

    if path.preload is not None:
        path = to_preload(path, Specimen(under, clear, depth, source.nominal_area, sticky=False))
    return under(path, names)
