"""The expected load-separation law: contacts integrated over the heights, and over the shape parameters.

Over the heights by tables that know where contact begins and ends; over the parameters by Gauss's rule in their normal
scores, of ever higher order until nothing changes any more.
"""

import math
from collections.abc import Iterable

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.totals import COUNT, DISSIPATED, ERROR, FORCE, TOTAL_INDEX
from roughmdr.ensemble import Ensemble, Source
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.converge import DOUBTFUL, FIRST_ORDER, converge
from roughmdr.expected.kinks import Parted
from roughmdr.expected.node import Node, Problem, dissipated_of, set_up, totals_of, undecided_of
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats

_WORTHLESS = 0.1  # of the largest force: an error that is refused
_KERNEL_ERROR = 1e-12  # of the force of a contact, as the kernels are tested
_HEAVY = 0.05  # index of a tail: of lighter ones all is borne by their lowest heights


@np.errstate(all="ignore")  # what no float can hold is refused at the end
def compute(
    source: Source, path: LoadingPath, *, effective_modulus: float, adhesion: Adhesion, variables: Iterable[str]
) -> LoadSeparation:
    """The expected law of the asperities of a source along a route; E* [Pa].

    ``numerical_error`` is how far the force may be off by what the integrals leave out, and by how much it changes with
    the number of nodes. OutOfRange where the contact of an asperity is not representable.
    """
    names, steps = list(variables), path.separation.size
    rows, dissipating = _rows(names), any(TOTAL_INDEX[name] == DISSIPATED for name in names)
    coarse = _stand_ins(source, source.nodes(Rule.smooth(FIRST_ORDER)))
    reach = jkr_validity(source.shape_name, source.sigma, coarse.nondimensional(), effective_modulus, adhesion)
    asked = Problem(source, path, effective_modulus, adhesion.resolved(reach.jkr_error), rows)
    parted = Parted.of(asked)
    rule, nodes, doubt, doubt_of_others = converge(asked, parted, dissipating=dissipating)
    total, products = totals_of(nodes, path.separation, rows, list(range(steps)))
    if dissipating:
        total[DISSIPATED] = dissipated_of(nodes, steps)
    if parted is not None:
        for step in parted.cuts:
            total[:, step] = parted.total(step, dissipating=dissipating)
    if COUNT in rows and (most := total[COUNT].max()) > 0.0:
        doubt_of_others = max(doubt_of_others, float(undecided_of(nodes, steps).max() / most))
    count = source.expected_count
    total *= count
    largest = float(np.abs(total[FORCE]).max())
    closest = float(path.separation.min())
    total[ERROR] += (doubt + _KERNEL_ERROR) * largest + count * _beyond(nodes, closest)
    if total[ERROR].max() == math.inf:
        raise OutOfRange(
            f"the mean force of these {asked.source.shape_name}s is not known to have a bound: too many of them "
            "are too high or too large (their distribution has too heavy a tail)"
        )
    if not np.isfinite(total).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {asked.law.name} with "
            f"effective modulus {effective_modulus:g} Pa, "
            f"{asked.adhesion}, separation down to {closest:g} m"
        )
    extremes = _stand_ins(source, source.nodes(rule)).validity_limits(_reached(nodes, closest, count))
    law = LoadSeparation.of(total, names, source.nominal_area, extremes, products, reach.tabor, asked.adhesion.model)
    return law._replace(doubts=_doubts(law.numerical_error, doubt_of_others))


@np.errstate(all="ignore")  # nothing is made of its numbers
def prepare(
    source: Source, path: LoadingPath, *, effective_modulus: float, adhesion: Adhesion, variables: Iterable[str]
) -> None:
    """Compile what the expected law needs, by one node; OutOfRange where its contact is not representable."""
    rows = _rows(variables)
    for model in adhesion.candidates:
        asked = Problem(source, path, effective_modulus, adhesion._replace(model=model), rows)
        totals_of(set_up(asked, Rule.smooth(1)), path.separation, rows, [0])


def _rows(variables: Iterable[str]) -> tuple[int, ...]:
    """What is integrated over the heights: the force and what is asked for, but for the losses, which have jumps."""
    return tuple(dict.fromkeys([FORCE, *(TOTAL_INDEX[name] for name in variables if TOTAL_INDEX[name] != DISSIPATED)]))


def _doubts(error: float, error_of_others: float) -> tuple[str, ...]:
    """Warn of errors over the largest force, and of other variables; OutOfRange where nothing is right."""
    if not error <= _WORTHLESS:
        raise OutOfRange(
            f"the expected law of these asperities is right only to {error:.1g} of its largest force: the "
            "integrals over the heights and shape parameters do not converge; estimator 'stratified' or 'sampled' has "
            "no such limit"
        )
    if not error_of_others <= _WORTHLESS:
        raise OutOfRange(
            f"the force of the expected law of these asperities is right to {error:.1g} of its largest, but another "
            f"variable only to {error_of_others:.1g} of its own, as where it has no mean, or where the flat ends next "
            "to a pole of the density of heights: ask for the force alone, or for estimator 'stratified' or 'sampled'"
        )
    if error > DOUBTFUL:
        return (
            f"an expected law that is right only to {error:.1g} of its largest force, other variables perhaps to less: "
            "estimator 'stratified' or 'sampled' has no such limit",
        )
    if error_of_others > DOUBTFUL:
        return (
            f"an expected law whose force is right to {error:.1g} of its largest, but other variables only to "
            f"{error_of_others:.1g} of theirs: estimator 'stratified' or 'sampled' has no such limit",
        )
    return ()


def _stand_ins(source: Source, nodes: Nodes) -> Ensemble:
    """The nodes as if they were asperities."""
    return Ensemble(
        source.shape_name, np.zeros(nodes.weights.size), nodes.parameters, shared_profile=source.shared_profile
    )


def _reached(nodes: list[Node], closest: float, count: float) -> Floats:
    """The contact radius [m] of the highest summit of each node, of ``count`` in all, under the flat at ``closest``."""
    depths = [node.heights.highest(count * node.share) - closest for node in nodes]
    pairs = zip(nodes, depths, strict=True)
    return np.array([node.contact.at_indentation(np.array([depth]))["contact_radius"][0] for node, depth in pairs])


def _beyond(nodes: list[Node], closest: float) -> float:
    """The force [N] on the heights that are left out above, of an asperity, with the flat at ``closest`` [m].

    inf where their mean force has no bound.
    """
    lost = 0.0
    for share, contact, heights in ((node.share, node.contact, node.heights) for node in nodes):
        edge = np.array([heights.high[-1] - (closest - heights.origin)])
        if heights.tail.xi > _HEAVY and edge[0] > 0.0:
            top = contact.at_indentation(edge)
            force, growth = abs(float(top["force"][0])), float((top["stiffness"] * edge / top["force"])[0])
            lost += share * force * heights.tail.over_edge(growth)
    return lost
