"""The force and the contact radius of each asperity of an ensemble at one step of a path."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.compute import check_asked, compute
from roughmdr.aggregate.mean_field import coupling_in
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats

if TYPE_CHECKING:
    from roughmdr.interaction.jkr.account import Adhering
    from roughmdr.interaction.solve import Coupled


class EachContact(NamedTuple):
    """The contact of each asperity, in the order of the ensemble; zeros for those that have none."""

    force: Floats
    """P [N]."""
    radius: Floats
    """a [m]; 0 also where surfaces attract each other and do not touch."""
    adhesion: Adhesion
    """The model that was used, "jkr" or "dugdale"."""

    @property
    def active(self) -> NDArray[np.bool_]:
        """Which asperities touch the flat, or are attracted by it."""
        return np.asarray((self.radius > 0.0) | (self.force != 0.0))


def contacts_at(
    ensemble: Ensemble,
    separation: Floats,
    step: int,
    *,
    effective_modulus: float,
    adhesion: Adhesion,
    interaction: Interaction | None = None,
) -> EachContact:
    """Return the contacts of an ensemble at a step of a path of separations [m], which comes from infinity; E* [Pa].

    Their forces add up to that of the law. Errors as ``compute``; OutOfRange also where there is no equilibrium.
    """
    check_asked(ensemble, [], adhesion, interaction)
    columns = ensemble.nondimensional()
    adhesion = adhesion.resolved(
        jkr_validity(ensemble.shape, ensemble.spread, columns, effective_modulus, adhesion).jkr_error
    )
    if interaction is not None and interaction.model == "pairwise":
        force, radius = _coupled(ensemble, separation, step, effective_modulus, adhesion.work, interaction)
        return EachContact(force, radius, adhesion)
    path = _turning_points(separation[: step + 1])
    if coupling := coupling_in(ensemble, interaction, effective_modulus):  # no memory: it goes without adhesion
        law = compute(
            ensemble,
            LoadingPath.along(path[-1:], unload=False, adhesive=False),
            effective_modulus=effective_modulus,
            adhesion=adhesion,
            variables=["force"],
            interaction=interaction,
        )
        path = path[-1:] + coupling * law.variables["force"]
    return EachContact(*_independent(ensemble, columns, path, effective_modulus, adhesion), adhesion)


def _turning_points(separation: Floats) -> Floats:
    """Return the first separation of a path, those where it turns back, and the last: all that contacts remember."""
    moved = separation[np.append(True, np.diff(separation) != 0.0)]
    rises = np.diff(moved) > 0.0
    kept = np.concatenate([[True], rises[1:] != rises[:-1], np.full(min(rises.size, 1), True)])
    return np.asarray(moved[kept])


def _independent(
    ensemble: Ensemble, columns: Columns, separation: Floats, effective_modulus: float, adhesion: Adhesion
) -> tuple[Floats, Floats]:
    """Return force and radius of each asperity at the end of a path, by the sum over that asperity alone."""
    path = LoadingPath.along(separation, unload=False, adhesive=adhesion.work > 0.0)
    kernels = choose(ensemble.shape, adhesion, columns.params)
    force, radius = np.zeros_like(ensemble.height), np.zeros_like(ensemble.height)
    rows, shared = {totals.FORCE, totals.RADIUS}, ensemble.shared_profile is not None
    for i in np.flatnonzero(ensemble.height >= separation.min() - adhesion.range).tolist():
        one = slice(i, i + 1)
        alone = Columns(columns.width[one], columns.rise[one], columns.params if shared else columns.params[one])
        total, _, _ = loop.sum_over_asperities(
            kernels, ensemble.height[one], alone, effective_modulus, adhesion, path.separation, path.memory, rows
        )
        force[i], radius[i] = total[totals.FORCE, -1], total[totals.RADIUS, -1]
    return force, radius


def _coupled(
    ensemble: Ensemble,
    separation: Floats,
    step: int,
    effective_modulus: float,
    work: float,
    interaction: Interaction,
) -> tuple[Floats, Floats]:
    """Return force and radius of each asperity at a step, by the solution of all together along the path."""
    names, path = set[str](), separation[: step + 1]
    along: Adhering | Coupled
    if work > 0.0:
        from roughmdr.interaction.jkr.path import solve_path as solve_adhering

        along = solve_adhering(ensemble, path, effective_modulus, work, interaction, names, at=step)
    else:
        from roughmdr.interaction.solve import solve_path

        along = solve_path(ensemble, path, effective_modulus, interaction, names, at=step)
    solved, force, radius = along.steps[step], along.force, along.radius
    if not np.isfinite(solved.error):
        raise OutOfRange(f"there is no equilibrium of the contacts at step {step}, separation {separation[step]:g} m")
    return force, radius
