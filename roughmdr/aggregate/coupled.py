"""The law of asperities that feel each other in pairs, from the same totals as that of independent ones."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import totals
from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.sampling import evening, sample_of
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import SceneError
from roughmdr.interaction.placed import border_warnings
from roughmdr.interaction.settings import Interaction
from roughmdr.interaction.totals import CROWDING
from roughmdr.loading.machine import MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import PullOff
from roughmdr.model_error.conductance import coupled_conductance_error
from roughmdr.model_error.coupling import (
    HILLS_MARKED_FRACTION,
    MARKED_FRACTION,
    MARKED_SHARE,
    adhesive_hills_error,
    coupling_error,
    summits_error,
)
from roughmdr.model_error.parts import Assumptions
from roughmdr.model_error.refusal import Givens
from roughmdr.numerics.arguments import Floats

if TYPE_CHECKING:
    from roughmdr.interaction.jkr.account import Adhering
    from roughmdr.interaction.solve import Coupled
    from roughmdr.interaction.totals import Step

UNAVAILABLE = ("energy", "dissipated_energy")
_NEIGHBOURHOOD = 7  # number of a point of a hexagonal lattice and its neighbours


class CoupledTotals(NamedTuple):
    """Totals along a path."""

    total: Floats
    """[row, step] in SI; NaN at a step without an equilibrium."""
    radius: Floats
    """The contact radius [m] of each asperity where the flat is closest."""
    force: Floats
    """The force [N] of each there, from the coupling in pairs even where the totals are from a grid."""
    visits: int
    error: Floats
    """The estimated error of the force that the coupling leaves [1], over the steps."""
    conductance_error: Floats
    """Error of the conductance by the coupling [1], over the steps."""
    fraction: Floats
    """Contact fraction where the contacts are [1], over the steps; NaN where it is not known."""
    overlap_count: int
    """Number of contacts that overlap a neighbour, at the closest approach with an equilibrium."""
    overlap_share: float
    """Share of the force that they bear there [1]; NaN for hills, which are parts of one surface."""
    marked: int
    """Number of steps without an equilibrium, not at rest to the error asked for, or with too much overlap or contact.
    """
    grid_points: int = 0
    """Points of the grid of boundary elements that gave these totals; 0 where contacts are coupled in pairs."""
    warnings: tuple[str, ...] = ()
    pull_off: PullOff = PullOff()
    avalanches: tuple[int, ...] | None = None
    """Sizes of the avalanches; None without adhesion."""


def law_of_coupled(problem: Problem, path: LoadingPath, names: list[str]) -> LoadSeparation:
    """Return the law of asperities that feel each other in pairs; SceneError for a variable that is not available."""
    judged, reach = _judged(problem.ensemble, names), _reach(problem)
    return _law(problem, sum_coupled(problem, path.separation, judged, reach), path.separation, names)


def law_on_machine(
    problem: Problem, path: MachinePath, names: list[str], clear: float
) -> tuple[LoadSeparation, Floats]:
    """Return the law of adhesive asperities that feel each other in pairs, on a machine, and the separations [m].

    Separations are inf where a dead load has pulled the flat off; the law is computed at ``clear`` [m] or higher there.
    """
    from roughmdr.interaction.jkr.machine import solve_on_machine

    assert problem.interaction is not None
    judged, work = set(_judged(problem.ensemble, names)), problem.asked_adhesion.work
    given = problem.ensemble, path, problem.effective_modulus, work, problem.interaction
    along = solve_on_machine(*given, judged, clear, _reach(problem))
    found = _adhering(problem.ensemble, along.separation, problem.interaction, along)
    return _law(problem, found, along.separation, names), along.separation


def _reach(problem: Problem) -> float:
    """Return the range of attraction that the error of hills needs; 0 for other asperities."""
    return problem.validity.reach if problem.ensemble.origin == "hills" else 0.0


def _judged(ensemble: Ensemble, names: list[str]) -> list[str]:
    """Return the variables, with those that their error needs too; the error of hills needs none."""
    return names if ensemble.origin == "hills" else [*names, CROWDING]


def _law(problem: Problem, found: CoupledTotals, separation: Floats, names: list[str]) -> LoadSeparation:
    """Return the law with these totals at separations [m]."""
    ensemble, validity = problem.ensemble, problem.validity
    work, spread, effective_modulus = problem.asked_adhesion.work, ensemble.spread, problem.effective_modulus
    area = math.nan if ensemble.nominal_area is None else ensemble.nominal_area
    givens = Givens(effective_modulus, work, spread, area, float(found.radius.max(initial=0.0)))
    assumptions = Assumptions(
        ensemble.validity_limits(found.radius),
        np.count_nonzero(found.radius) * validity.contact_error if work > 0.0 else 0.0,
        resolution_error=ensemble.resolution_error,
        border_error=ensemble.border_error,
        origin=ensemble.origin,
        overlap=found.overlap_share,
        coupling_error=found.error,
        conductance_error=found.conductance_error,
        contact_fraction=None if ensemble.axis is None else found.fraction,
    )
    model = "jkr" if work > 0.0 else "none"
    result = LoadSeparation.of(found.total, names, separation, givens, assumptions, found.visits, validity.tabor, model)
    if found.avalanches is not None:
        result = result._replace(
            pull_off=found.pull_off,
            avalanche_count=float(len(found.avalanches)),
            avalanche_size_max=float(max(found.avalanches, default=0)),
        )
    repeats = problem.interaction is not None and problem.interaction.boundary == "periodic"
    sample = sample_of(ensemble, found.force, found.radius, evening(ensemble, found.radius) if repeats else 1.0)
    return result._replace(
        warnings=(*ensemble.warnings, *found.warnings, *border_warnings(ensemble, found.radius)),
        overlap_count=float(found.overlap_count),
        marked_steps=float(found.marked),
        grid_points=float(found.grid_points),
        **sample,
    )


def sum_coupled(problem: Problem, separation: Floats, names: list[str], reach: float = 0.0) -> CoupledTotals:
    """Return totals at separations [m], ``reach`` as ``Account``; SceneError for a variable that is not available."""
    interaction, work = problem.interaction, problem.asked_adhesion.work
    assert interaction is not None
    ensemble, effective_modulus = problem.ensemble, problem.effective_modulus
    if work > 0.0:
        adhering = problem.descent.along(separation, set(names), reach=reach)
        return _adhering(ensemble, separation, interaction, adhering)
    from roughmdr.interaction.solve import solve_path

    if asked := [name for name in names if name in UNAVAILABLE]:
        raise SceneError(f"variables: {', '.join(asked)} with interaction 'pairwise' need adhesion")
    coupled = solve_path(ensemble, separation, effective_modulus, interaction, set(names))
    found = _found(ensemble, separation, interaction, coupled, adhesive=False)
    if found.marked and interaction.beyond == "boundary_elements":
        return _on_grid(found, ensemble, separation, effective_modulus, names)
    return found


def response_of_coupled(problem: Problem) -> Callable[[float], tuple[float, float]]:
    """Return force [N] and stiffness [N/m] of contacts without adhesion as a function of the separation [m], which is
    asked for one after the other; NaN where there is no equilibrium.
    """
    from roughmdr.interaction.solve import Flat

    ensemble, interaction = problem.ensemble, problem.interaction
    assert interaction is not None
    flat = Flat(ensemble, problem.effective_modulus, interaction, {"stiffness"})

    def law(h: float) -> tuple[float, float]:
        if interaction.beyond == "boundary_elements":
            total = sum_coupled(problem, np.array([h]), ["stiffness"]).total
        else:
            total, _ = _totals([flat.go(h)[0]], ensemble)
        return float(total[totals.FORCE, 0]), float(total[totals.STIFFNESS, 0])

    return law


def _adhering(ensemble: Ensemble, separation: Floats, interaction: Interaction, along: "Adhering") -> CoupledTotals:
    """Return the totals of adhesive contacts along a path."""
    found = _found(ensemble, separation, interaction, along, adhesive=True)
    error = found.error
    if ensemble.origin == "hills":
        largest = float(np.nanmax(np.abs(found.total[totals.FORCE]), initial=0.0))
        doubted, held = np.array([(step.doubted, step.held) for step in along.steps]).reshape(-1, 2).T
        error = np.minimum(error + adhesive_hills_error(doubted, held, largest), 1.0)
    return found._replace(
        error=error,
        warnings=(along.crowded,) if along.crowded else (),
        pull_off=along.pull_off,
        avalanches=tuple(each.size for each in along.avalanches),
    )


def _found(
    ensemble: Ensemble, separation: Floats, interaction: Interaction, along: "Coupled | Adhering", *, adhesive: bool
) -> CoupledTotals:
    """Return the totals of contacts that are coupled in pairs along a path."""
    steps = along.steps
    total, solved = _totals(steps, ensemble)
    share = np.array([step.overlap.share for step in steps])
    fraction = _fraction(total, steps, ensemble)
    hills = ensemble.origin == "hills"
    beyond = (fraction > HILLS_MARKED_FRACTION) if hills else (share > MARKED_SHARE) | (fraction > MARKED_FRACTION)
    beyond |= [step.lost > 0 for step in steps]
    largest = np.nanmax(np.abs(total[totals.FORCE]), initial=0.0) if adhesive else total[totals.FORCE]
    beyond |= total[totals.ERROR] > interaction.error * largest  # contacts that did not come to rest
    near = np.array([step.overlap.crowding for step in steps])
    error = coupling_error(np.nan_to_num(fraction), near, ensemble, interaction.order)
    of_conductance = coupled_conductance_error(np.nan_to_num(fraction), share, ensemble, interaction.order)
    if interaction.boundary == "free" and ensemble.origin == "asperities" and ensemble.height.size == 1:
        error, of_conductance = np.zeros_like(error), np.zeros_like(of_conductance)  # it feels nobody
    closest = steps[int(np.argmin(np.where(solved, separation, np.inf)))].overlap
    marked = int(np.sum(beyond | ~solved))
    overlap = math.nan if hills else closest.share
    visits, contacts = along.visits, closest.contacts
    errors = error, of_conductance, fraction
    return CoupledTotals(total, along.radius, along.force, visits, *errors, contacts, overlap, marked)


def _fraction(total: Floats, steps: "list[Step]", ensemble: Ensemble) -> Floats:
    """Return the contact fraction at each step; NaN where it is not known.

    Under a flat it is that of the patch. A curved body crowds the contacts under its apex: there it is that of the disc
    on which they are as widely spread, of at least the area of so many asperities, or of one with its neighbours: few
    may happen to be near to each other. One alone feels no other.
    """
    area, count = math.nan if ensemble.nominal_area is None else ensemble.nominal_area, total[totals.COUNT]
    if ensemble.axis is None:
        return np.asarray(total[totals.AREA] / area)
    crowded = np.fmax(
        [step.spread_area for step in steps], np.maximum(count, _NEIGHBOURHOOD) * (area / ensemble.height.size)
    )
    return np.asarray(total[totals.AREA] / np.where(count > 1.0, np.minimum(crowded, area), area))


def _totals(steps: "list[Step]", ensemble: Ensemble) -> tuple[Floats, NDArray[np.bool_]]:
    """Return totals [row, step], and which steps have an equilibrium: NaN where there is none.

    A step whose contact area exceeds the patch has none.
    """
    total = np.zeros((totals.ROWS, len(steps)))
    for row, values in (
        (totals.FORCE, [step.force for step in steps]),
        (totals.RADIUS, [step.radius_sum for step in steps]),
        (totals.AREA, [ensemble.area_share * step.area for step in steps]),
        (totals.STIFFNESS, [step.stiffness for step in steps]),
        (totals.COUNT, [step.contacts for step in steps]),
        (totals.ERROR, [step.error for step in steps]),
        (totals.ENERGY, [step.energy for step in steps]),
        (totals.DISSIPATED, [step.dissipated for step in steps]),
        (totals.MACHINE, [step.by_machine for step in steps]),
        (totals.CONDUCTANCE, [step.conductance for step in steps]),
        (totals.NOMINAL, [step.nominal_radius for step in steps]),
    ):
        total[row] = values
    solved = np.isfinite(total[totals.ERROR])
    if ensemble.nominal_area is not None:
        solved &= total[totals.AREA] <= ensemble.nominal_area
    total[:, ~solved] = np.nan
    return total, solved


def _on_grid(
    pairwise: CoupledTotals, ensemble: Ensemble, separation: Floats, effective_modulus: float, names: list[str]
) -> CoupledTotals:
    """Return the totals of the whole path by boundary elements, instead of by contacts coupled in pairs."""
    from roughmdr.elements.half_space import STIFFNESS_ERROR
    from roughmdr.elements.path import solve_on_grid
    from roughmdr.elements.surface import POINTS, grid_shape, surface_of_asperities

    surface = surface_of_asperities(ensemble, float(separation.min()), periodic=True)
    shape = grid_shape(surface.sides, POINTS)
    stiffness = not {"stiffness", "conductance_radius"}.isdisjoint(names)
    found = solve_on_grid(surface, separation, effective_modulus, shape, stiffness=stiffness)
    total, solved = _totals(found.steps, ensemble)
    total[totals.CONDUCTANCE] = 0.5 * total[totals.STIFFNESS] / effective_modulus
    nx, ny = found.shape
    warning = (
        f"computed by boundary elements on a grid of {nx} x {ny} points: realisations of which steps were marked, as "
        'interaction.beyond = "boundary_elements" asks; their contacts are connected patches'
    )
    fraction = np.nan_to_num(total[totals.AREA]) / (ensemble.nominal_area or math.inf)
    error = summits_error(fraction, ensemble.origin)
    return pairwise._replace(
        total=total,
        error=error,
        conductance_error=error + STIFFNESS_ERROR,
        marked=int(np.sum(~solved)),
        grid_points=nx * ny,
        warnings=(warning,),
    )
