"""The law of an ensemble along a path of separations: which totals the asked variables need."""

import math
from collections.abc import Callable, Iterable

import numpy as np

from roughmdr.aggregate import loop, totals
from roughmdr.aggregate.detachment import detachments
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.loop import sum_over_asperities
from roughmdr.aggregate.mean_field import couple, coupling_in, of_independent, shift
from roughmdr.aggregate.neighbours_error import are_few, neighbours_error
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.sampling import sample_of
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.totals import AREA, COUNT, FORCE
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, locate, prepare as prepare_pull_off, unloadings
from roughmdr.loading.staircase import no_memory
from roughmdr.model_error.interaction import overlap_share, poisson_overlap
from roughmdr.model_error.parts import Assumptions, Yielding
from roughmdr.model_error.refusal import Givens, crowd_warnings
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES

_UNCOUPLED_HILLS = (
    "hills of a map grow into each other where they are not coupled, and count the same surface more than once: "
    'ask for [interaction] model = "pairwise"'
)


def compute(problem: Problem, path: LoadingPath, variables: Iterable[str]) -> LoadSeparation:
    """Return the law of an ensemble along a path.

    SceneError where a variable needs a nominal area and there is none, or where the ensemble lacks positions or the
    patch that the interaction needs, OutOfRange where the contact of an asperity is not representable, or where the
    contacts have more area than the patch.
    """
    names = list(variables)
    problem.check_asked(names)
    if problem.paired:
        from roughmdr.aggregate.coupled import law_of_coupled

        return law_of_coupled(problem, path, names)
    rows = rows_for(problem, names)

    def radius_at(separation: float) -> Floats:
        there = LoadingPath.along(np.array([separation]), unload=False, adhesive=problem.adhesion.work > 0.0)
        _, (radius, _), _ = problem.sums(there, {totals.AREA})
        return np.asarray(radius)

    if coupling := coupling_in(problem):
        found = shift(of_independent(problem), path.separation, coupling)
        shifted = LoadingPath(found.separation, no_memory(found.separation))
        total, closest, visits = problem.sums(shifted, rows | {totals.STIFFNESS})
        couple(total, found)
    else:
        total, closest, visits = problem.sums(path, rows)
    factor = 1.0 - coupling * float(total[totals.STIFFNESS, np.argmin(path.separation)]) if coupling else 1.0
    result = law_of_totals(problem, path, names, total, closest, radius_at, factor=factor)
    return result._replace(visits=visits, pull_off=pull_off_of(problem, path, total[totals.FORCE]))


def rows_for(problem: Problem, names: list[str]) -> set[int]:
    """Return the rows of the totals that variables and the model error need."""
    rows = {totals.ERROR, totals.FORCE, totals.AREA, *(totals.TOTAL_INDEX[name] for name in names)}
    return rows | ({totals.COUNT} if are_few(problem.ensemble) else set())


def law_of_totals(
    problem: Problem,
    path: LoadingPath,
    names: list[str],
    total: Floats,
    closest: Floats,
    radius_at: Callable[[float], Floats],
    *,
    factor: float = 1.0,
    yielding: Yielding | None = None,
) -> LoadSeparation:
    """Return the law of independent contacts from their totals [row, step], with the error of the model.

    ``closest`` has the radius [m] and the force [N] of each asperity where the flat is closest, [2, asperity];
    ``radius_at`` as for ``neighbours_error``, ``factor`` for ``sample_of``. OutOfRange as ``compute``.
    """
    ensemble, adhesion, validity = problem.ensemble, problem.adhesion, problem.validity
    radius, force = closest
    total[totals.AREA] *= ensemble.area_share
    area = math.nan if ensemble.nominal_area is None else ensemble.nominal_area
    largest = float(radius.max(initial=0.0))
    givens = Givens(problem.effective_modulus, adhesion.work, ensemble.spread, area, largest)
    assumptions = Assumptions(
        ensemble.validity_limits(radius),
        np.count_nonzero(radius) * validity.contact_error if adhesion.model == "jkr" and radius.any() else 0.0,
        ensemble.resolution_error,
        ensemble.border_error,
        ensemble.origin,
        _overlap(ensemble, radius),
        neighbours_error=neighbours_error(ensemble, path, total, radius_at) if problem.interaction is None else None,
        yielding=yielding,
    )
    result = LoadSeparation.of(total, names, path.separation, givens, assumptions, 0, validity.tabor, adhesion.model)
    crowded = crowd_warnings(assumptions.neighbours_error, total[totals.AREA] / area)
    warnings = (*ensemble.warnings, *([_UNCOUPLED_HILLS] if ensemble.origin == "hills" else []), *crowded)
    return result._replace(warnings=warnings, **sample_of(ensemble, force, radius, factor))


def _overlap(ensemble: Ensemble, radius: Floats) -> float:
    """Return the share of contacts that overlap a neighbour, from their radii [m].

    It is NaN where it is not known, and for hills, which are parts of one surface.
    """
    if ensemble.origin == "hills":
        return math.nan
    touching = radius > 0.0
    contact_radius = radius[touching]
    if not contact_radius.size:
        return 0.0
    if {"x", "y"} <= ensemble.positions.keys():
        x, y = (ensemble.positions[name][touching] for name in ("x", "y"))
        return overlap_share(x, y, contact_radius)
    if ensemble.nominal_area is None:
        return math.nan
    return poisson_overlap(contact_radius, ensemble.nominal_area)


def prepare(
    shape: str,
    adhesion: Adhesion,
    interaction: Interaction | None = None,
    variables: Iterable[str] = (),
    *,
    unload: bool = True,
) -> None:
    """Compile the sum for a shape, an adhesion model, an interaction and variables, on paths that ``unload`` or not,
    before several threads or a clock need it.
    """
    if interaction is not None and interaction.model == "pairwise":
        from roughmdr.interaction.solve import prepare as prepare_coupled

        if adhesion.work > 0.0:
            from roughmdr.interaction.jkr.path import prepare as prepare_adhering

            prepare_adhering(shape)
        else:
            prepare_coupled(shape)
    kind = SHAPES[shape]
    example = kind(**kind.example())
    width, rise, params = (np.asarray(part, dtype=np.float64)[None] for part in example.nondimensional())
    columns = Columns(width, rise, params)
    rows = {totals.TOTAL_INDEX[name] for name in variables}
    for model in adhesion.candidates if interaction is None or interaction.model != "pairwise" else ():
        one = Adhesion(float(adhesion.work > 0.0), model, 1.0)
        kernels = choose(shape, one, params)
        loop.sum_over_asperities(kernels, np.zeros(1), columns, 1.0, one, np.zeros(1), no_memory(np.zeros(1)), rows)
        if kernels.adhesive and unload:
            detachments(kernels, columns, 1.0, one)
            prepare_pull_off()
    if adhesion.work > 0.0:
        jkr_validity(shape, 0.0, columns, 1.0, adhesion._replace(work=1.0, strength=1.0))


def pull_off_of(problem: Problem, path: LoadingPath, force: Floats) -> PullOff:
    """Return the pull-off along a path, given the force [N] at its steps.

    NaN where no unloading ends with all contacts parted: there, and only there, the force is exactly 0.
    """
    rises = unloadings(path.separation, force)
    if not any(rise.force[-1] == 0.0 for rise in rises):
        return PullOff()
    adhesion = problem.adhesion
    count = int(np.count_nonzero(problem.ensemble.height >= float(path.separation.min()) - adhesion.range))
    if not (problem.kernels.adhesive and count):
        return WITHOUT_TENSION
    top, few, depths = problem.top(count)

    def sums(along: LoadingPath, rows: set[int]) -> Floats:
        own = problem.kernels, top, few, problem.effective_modulus, adhesion
        return sum_over_asperities(*own, along.separation, along.memory, rows)[0]

    found = locate(rises, lambda along: sums(along, {FORCE})[FORCE], np.sort(top + depths))
    if found is None:
        return WITHOUT_TENSION
    there = sums(found.path, {COUNT, AREA})[:, -1]
    return PullOff(found.force, float(found.path.separation[-1]), float(there[COUNT]), float(there[AREA]))
