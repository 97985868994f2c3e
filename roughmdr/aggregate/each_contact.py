"""The force and the contact radius of each asperity of an ensemble at one step of a path."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.compute import compute
from roughmdr.aggregate.mean_field import coupling_in
from roughmdr.aggregate.problem import Problem
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Columns
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import turning_points
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


def contacts_at(problem: Problem, separation: Floats, step: int) -> EachContact:
    """Return the contacts of an ensemble at a step of a path of separations [m], which comes from infinity.

    Their forces add up to that of the law. Errors as ``compute``; OutOfRange also where there is no equilibrium.
    """
    problem.check_asked([])
    if problem.paired:
        return EachContact(*_coupled(problem, separation, step), problem.adhesion)
    path = turning_points(separation[: step + 1])
    if coupling := coupling_in(problem):  # the mean field is for contacts without adhesion, which have no memory
        law = compute(problem, LoadingPath.along(path[-1:], unload=False, adhesive=False), ["force"])
        path = path[-1:] + coupling * law.variables["force"]
    return EachContact(*_independent(problem, path), problem.adhesion)


def _independent(problem: Problem, separation: Floats) -> tuple[Floats, Floats]:
    """Return force and radius of each asperity at the end of a path, by the sum over that asperity alone."""
    adhesion, height, columns = problem.adhesion, problem.ensemble.height, problem.ensemble.columns
    path = LoadingPath.along(separation, unload=False, adhesive=adhesion.work > 0.0)
    if separation.size == 1:  # the sum over all has them
        _, (radius, force), _ = problem.sums(path, {totals.AREA})
        return force, radius
    force, radius = np.zeros_like(height), np.zeros_like(height)
    rows, shared = {totals.FORCE, totals.RADIUS}, problem.ensemble.shared_profile is not None
    for i in np.flatnonzero(height >= separation.min() - adhesion.range).tolist():
        one = slice(i, i + 1)
        alone = Columns(columns.width[one], columns.rise[one], columns.params if shared else columns.params[one])
        own = problem.kernels, height[one], alone, problem.effective_modulus, adhesion
        total, _, _ = loop.sum_over_asperities(*own, path.separation, path.memory, rows)
        force[i], radius[i] = total[totals.FORCE, -1], total[totals.RADIUS, -1]
    return force, radius


def _coupled(problem: Problem, separation: Floats, step: int) -> tuple[Floats, Floats]:
    """Return force and radius of each asperity at a step, by the solution of all together along the path."""
    assert problem.interaction is not None
    names, path = set[str](), separation[: step + 1]
    along: Adhering | Coupled
    if problem.asked_adhesion.work > 0.0:
        along = problem.descent.along(path, names, at=step)
    else:
        from roughmdr.interaction.solve import solve_path

        along = solve_path(problem.ensemble, path, problem.effective_modulus, problem.interaction, names, at=step)
    solved, force, radius = along.steps[step], along.force, along.radius
    if not np.isfinite(solved.error):
        raise OutOfRange(f"there is no equilibrium of the contacts at step {step}, separation {separation[step]:g} m")
    return force, radius
