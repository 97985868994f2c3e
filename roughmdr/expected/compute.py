"""The expected load-separation law: contacts integrated over the heights and over the shape parameters.

Over the heights two tables are multiplied, of one contact and of the density; over the parameters Gauss's rule is used
in their normal scores, of increasing order until the result no longer changes.
"""

import math
from collections.abc import Callable, Iterable

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.aggregate.mean_field import Shift, couple, coupling_of, mean_inverse_distance, shift
from roughmdr.aggregate.tabor import JkrValidity, jkr_validity
from roughmdr.aggregate.totals import (
    AREA,
    CONDUCTANCE,
    COUNT,
    DISSIPATED,
    ERROR,
    FORCE,
    MACHINE,
    RADIUS,
    STIFFNESS,
    TOTAL_INDEX,
)
from roughmdr.asperity.validity import ValidityLimits
from roughmdr.ensemble import Ensemble, Source
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.converge import FIRST_ORDER, WARNED_ERROR, converge, converge_at_kinks
from roughmdr.expected.node import MeanProblem, QuadratureNode, moved, set_up, totals_of, undecided_of
from roughmdr.expected.pull_off import pull_off_of
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.staircase import no_memory
from roughmdr.model_error.interaction import FEW, error_of_few, poisson_overlap
from roughmdr.model_error.parts import Assumptions, Yielding
from roughmdr.model_error.refusal import Givens, crowd_warnings
from roughmdr.numerics.arguments import Floats

_MAX_ERROR = 0.1  # error, over the largest force, above which the law is refused
KERNEL_ERROR = 1e-12
"""Relative error of the force of a contact, to which the kernels are tested."""
_HEAVY_TAIL = 0.05  # tail index below which the heights left out bear a negligible force


@np.errstate(all="ignore")  # numbers that no float can hold are refused at the end
def compute(
    source: Source,
    path: LoadingPath,
    *,
    effective_modulus: float,
    adhesion: Adhesion,
    variables: Iterable[str],
    interaction: Interaction | None = None,
) -> LoadSeparation:
    """Return the expected law of the asperities of a source along a path; E* [Pa]. An interaction is a mean field.

    ``numerical_error`` is the error bound of the force, by what the integrals leave out and by how much it changes with
    the number of nodes. OutOfRange where the contact of an asperity is not representable.
    """
    names, steps = list(variables), path.separation.size
    rows, unjudged = _rows(names)
    dissipating = any(TOTAL_INDEX[name] == DISSIPATED for name in names)
    coarse = as_ensemble(source, source.nodes(Rule.smooth(FIRST_ORDER)))
    validity = jkr_validity(source.shape_name, source.sigma, coarse.columns, effective_modulus, adhesion)
    problem = MeanProblem(source, path, effective_modulus, adhesion.resolved(validity.jkr_error), rows, unjudged)
    found = _shift(problem, interaction)
    if found is not None:
        rows = rows if STIFFNESS in rows else (*rows, STIFFNESS)
        along = LoadingPath(found.separation, no_memory(found.separation))
        problem = problem._replace(path=along, rows=rows)
    separation = problem.path.separation
    chosen, split = converge_at_kinks(problem, dissipating=dissipating)
    nodes, error_of_others = chosen.nodes, chosen.error_of_others
    total, products = chosen.sums(problem, nodes, dissipating=dissipating)
    if split is not None:
        for step in split.cuts:
            total[:, step] = split.total(step, dissipating=dissipating)
    if COUNT in rows and COUNT not in unjudged and (most := total[COUNT].max()) > 0.0:
        error_of_others = max(error_of_others, float(undecided_of(nodes, steps).max() / most))
    count = source.expected_count
    total *= count
    total[CONDUCTANCE] = total[RADIUS]
    if found is not None:
        couple(total, found)
    largest = float(np.abs(total[FORCE]).max())
    closest = float(separation.min())
    total[ERROR] += (chosen.error + KERNEL_ERROR) * largest + count * _tail_force(nodes, closest)
    if total[ERROR].max() == math.inf:
        raise OutOfRange(
            f"the mean force of these {source.shape_name}s is not known to have a bound: too many of them "
            "are too high or too large (their distribution has too heavy a tail)"
        )
    if not np.isfinite(total).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {problem.kernels.name} with effective modulus "
            f"{effective_modulus:g} Pa, {problem.adhesion}, separation down to {closest:g} m"
        )
    limits = as_ensemble(source, source.nodes(*chosen.rules)).validity_limits
    largest_radii = _largest_radii(nodes, closest, count)
    law = law_of_means(problem._replace(path=path), names, total, largest_radii, limits, validity, interaction)
    warnings = warnings_of(float(total[ERROR].max()) / largest if largest > 0.0 else 0.0, error_of_others)
    pull_off = pull_off_of(problem, split, chosen, total[FORCE])
    return law._replace(visits=products, warnings=(*warnings, *law.warnings), pull_off=pull_off)


def law_of_means(
    problem: MeanProblem,
    names: list[str],
    total: Floats,
    radii: Floats,
    limits: Callable[[Floats], ValidityLimits],
    validity: JkrValidity,
    interaction: Interaction | None = None,
    *,
    yielding: Yielding | None = None,
) -> LoadSeparation:
    """Return the law along the path from totals of all asperities [row, step], with the error of the model.

    ``radii`` [m] are the largest of each node, whose ``limits`` of validity are the asperities'.
    """
    source, adhesion, area = problem.source, problem.adhesion, problem.source.nominal_area
    nominal_area = math.nan if area is None else area
    work, largest = adhesion.work, float(radii.max(initial=0.0))
    givens = Givens(problem.effective_modulus, work, source.sigma, nominal_area, largest)
    equal_radii = np.sqrt(total[AREA].max(keepdims=True) / math.pi)  # one contact in place of all alike
    overlap = poisson_overlap(equal_radii, nominal_area)
    contacts = float(total[COUNT].max())
    jkr_error = contacts * validity.contact_error if adhesion.model == "jkr" and contacts > 0.0 else 0.0
    assumptions = Assumptions(
        limits(radii),
        jkr_error,
        origin="summits" if source.of_surface else "asperities",
        overlap=overlap,
        neighbours_error=_neighbours_error(source, total) if interaction is None else None,
        yielding=yielding,
    )
    crowded = crowd_warnings(assumptions.neighbours_error, total[AREA] / nominal_area)
    law = LoadSeparation.of(
        total, names, problem.path.separation, givens, assumptions, 0, validity.tabor, adhesion.model
    )
    return law._replace(warnings=tuple(crowded))


def _neighbours_error(source: Source, total: Floats) -> Floats | None:
    """Return the error that few asperities at random make as independent ones, at each step; None of many."""
    count, area = source.expected_count, source.nominal_area
    if source.goes_on or count > FEW or area is None:
        return None
    contacts, side = total[COUNT], math.sqrt(area)
    return error_of_few(total[AREA], contacts, contacts * (1.0 - 1.0 / count), mean_inverse_distance(side, side))


def _shift(problem: MeanProblem, interaction: Interaction | None) -> Shift | None:
    """Return where the asperities have the force that they have under their mean field; None where there is none.

    The rule over the shape parameters is that of independent asperities on the same path.
    """
    source, modulus = problem.source, problem.effective_modulus
    if interaction is None or source.nominal_area is None:
        return None
    coupling = coupling_of(interaction, modulus, source.sides, source.exclusion_distance)
    if coupling == 0.0:
        return None
    problem = problem._replace(rows=(FORCE, STIFFNESS), unjudged=())
    chosen, count = converge(problem, None, dissipating=False), source.expected_count

    def independent(separation: Floats) -> tuple[Floats, Floats]:
        along = LoadingPath(separation, no_memory(separation))
        deeper = separation.min() < problem.path.separation.min()
        nodes = set_up(problem._replace(path=along), *chosen.rules) if deeper else moved(chosen.nodes, along)
        total, _ = totals_of(nodes, separation, problem.rows, list(range(separation.size)))
        return count * total[FORCE], count * total[STIFFNESS]

    return shift(independent, problem.path.separation, coupling)


@np.errstate(all="ignore")  # its numbers are not used
def prepare(
    source: Source, path: LoadingPath, *, effective_modulus: float, adhesion: Adhesion, variables: Iterable[str]
) -> None:
    """Compile what the expected law needs, by one node; OutOfRange where its contact is not representable."""
    rows, _ = _rows(variables)
    for model in adhesion.candidates:
        problem = MeanProblem(source, path, effective_modulus, adhesion._replace(model=model), rows)
        totals_of(set_up(problem, Rule.smooth(1)), path.separation, rows, [0])


def _rows(variables: Iterable[str]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the totals that are integrated over the heights, and those of them that only the model error needs.

    They are the force, the area, the count and all others that are asked for but the energy lost in jumps; for the
    conductance the radii.
    """
    rows = (RADIUS if TOTAL_INDEX[name] == CONDUCTANCE else TOTAL_INDEX[name] for name in variables)
    asked = [FORCE, *(row for row in rows if row not in (DISSIPATED, MACHINE))]
    asked.sort(key=lambda row: row == STIFFNESS)  # which is not judged: rows that are come first
    needed = (AREA, COUNT)
    return tuple(dict.fromkeys([*asked, *needed])), tuple(row for row in needed if row not in asked)


def warnings_of(error: float, error_of_others: float) -> tuple[str, ...]:
    """Warn of errors of the force and of other variables, over their largest; OutOfRange where they are too large."""
    if not error <= _MAX_ERROR:
        raise OutOfRange(
            f"the expected law of these asperities is right only to {error:.1g} of its largest force: the "
            "integrals over the heights and shape parameters do not converge; estimator 'stratified' or 'sampled' has "
            "no such limit"
        )
    if not error_of_others <= _MAX_ERROR:
        raise OutOfRange(
            f"the force of the expected law of these asperities is right to {error:.1g} of its largest, but another "
            f"variable only to {error_of_others:.1g} of its own, as where it has no mean, or where the flat ends next "
            "to a pole of the density of heights: ask for the force alone, or for estimator 'stratified' or 'sampled'"
        )
    if error > WARNED_ERROR:
        return (
            f"an expected law that is right only to {error:.1g} of its largest force, other variables perhaps to less: "
            "estimator 'stratified' or 'sampled' has no such limit",
        )
    if error_of_others > WARNED_ERROR:
        return (
            f"an expected law whose force is right to {error:.1g} of its largest, but other variables only to "
            f"{error_of_others:.1g} of theirs: estimator 'stratified' or 'sampled' has no such limit",
        )
    return ()


def as_ensemble(source: Source, nodes: Nodes) -> Ensemble:
    """Return the nodes as if they were asperities."""
    heights = np.zeros(nodes.weights.size)
    return Ensemble(source.shape_name, heights, nodes.parameters, shared_profile=source.shared_profile)


def _largest_radii(nodes: list[QuadratureNode], closest: float, count: float) -> Floats:
    """Return the contact radius [m] of the highest summit of each node, of ``count`` in all, at ``closest`` [m]."""
    depths = [np.array([node.heights.highest(count * node.fraction) - closest]) for node in nodes]
    pairs = zip(nodes, depths, strict=True)
    return np.array([node.contact.at_indentation(depth)["contact_radius"][0] for node, depth in pairs])


def _tail_force(nodes: list[QuadratureNode], closest: float) -> float:
    """Return the mean force [N] per asperity of the heights above the last edge, which are left out, at ``closest``
    [m].

    inf where that mean has no bound.
    """
    left_out = 0.0
    for fraction, contact, heights in ((node.fraction, node.contact, node.heights) for node in nodes):
        edge = np.array([heights.high[-1] - (closest - heights.origin)])
        if heights.tail.xi > _HEAVY_TAIL and edge[0] > 0.0:
            top = contact.at_indentation(edge)
            force, growth = abs(float(top["force"][0])), float((top["stiffness"] * edge / top["force"])[0])
            left_out += fraction * force * heights.tail.over_edge(growth)
    return left_out
