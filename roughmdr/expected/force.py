"""The force alone of the expected law, by a rule over the shape parameters that was found for parameters nearby."""

from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.totals import ERROR, FORCE
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.compute import KERNEL_ERROR, as_ensemble, warnings_of
from roughmdr.expected.converge import converge_at_kinks
from roughmdr.expected.detached import PartialRule, sums_of
from roughmdr.expected.node import MeanProblem, QuadratureNode, set_up
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats, Ints


class ForceRule(NamedTuple):
    """Rules over the shape parameters, one for each that is random, by which a force was found."""

    rules: tuple[Rule, ...]
    smooth: bool
    """Whether they are those for smooth functions."""
    error: float
    """Error bound of the force over its largest value."""


class Changes(NamedTuple):
    """Where adhering asperities of one height make and lose contact, in the order of the path."""

    step: Ints
    """The steps after which they do."""
    control: Floats
    """The separation [m], or on a machine the position of the far end."""


class Force(NamedTuple):
    """The force of the expected law along a path."""

    force: Floats
    """[N]"""
    error: float
    """Error bound over the largest force."""
    changes: Changes
    """Populations of one height change there; where shapes are drawn, losing contact one by one, at first touch."""
    rule: ForceRule | None
    """The rule by which it was found; None where steps had rules of their own."""


@np.errstate(all="ignore")  # numbers that no float can hold are refused
def expected_force(
    source: Source, path: LoadingPath, effective_modulus: float, adhesion: Adhesion, rule: ForceRule | None = None
) -> Force:
    """Return the force of ``compute``; E* [Pa]. With a ``rule`` none is sought, and its error is taken for known.

    OutOfRange where a contact is not representable, or the error is too large.
    """
    alike = source.node_count(2) == source.node_count(1)
    if len(adhesion.candidates) > 1:
        coarse = as_ensemble(source, source.nodes(Rule.smooth(1))).columns
        validity = jkr_validity(source.shape_name, source.sigma, coarse, effective_modulus, adhesion)
        adhesion = adhesion.resolved(validity.jkr_error)
    problem, split = MeanProblem(source, path, effective_modulus, adhesion, (FORCE,)), None
    if alike:
        rule = ForceRule((Rule.smooth(1),), smooth=False, error=0.0)
    if rule is None:
        chosen, split = converge_at_kinks(problem, dissipating=False)
        rule, nodes = ForceRule(chosen.rules, chosen.smooth, chosen.error), chosen.nodes
    else:
        nodes = set_up(problem, *rule.rules)
    steps = list(range(path.separation.size))
    partial = PartialRule.of(problem, rule.rules, nodes) if rule.smooth else None
    total, _ = sums_of(problem, partial, nodes, steps, dissipating=False)
    if split is not None:
        for step in split.cuts:
            total[:, step] = split.total(step, dissipating=False)
    if not np.isfinite(total).all():
        raise OutOfRange("the expected law is not finite")
    largest = float(np.abs(total[FORCE]).max())
    error = KERNEL_ERROR + rule.error + (float(total[ERROR].max()) / largest if largest > 0.0 else 0.0)
    warnings_of(error, 0.0)
    changes = _changes(path, nodes if alike else nodes[:1], of_loss=alike)
    return Force(source.expected_count * total[FORCE], error, changes, rule if split is None else None)


def _changes(path: LoadingPath, nodes: list[QuadratureNode], *, of_loss: bool) -> Changes:
    """Return where nodes whose heights are all equal make contact and, if asked for, lose it."""
    found = list[tuple[int, float]]()
    for node in nodes:
        if node.heights.all_equal and node.contact.kernels.adhesive:
            touching = np.zeros(path.separation.size, dtype=np.int8)
            touching[node.in_contact.around(0.0).step] = 1
            made, lost = (np.flatnonzero(np.diff(touching) == sign).tolist() for sign in (1, -1))
            found += [(step, node.heights.origin - node.contact.onset) for step in made]
            found += [(step, node.heights.origin + node.contact.depth[0]) for step in lost if of_loss]
    ways = np.diff(path.separation)
    found.sort(key=lambda each: (each[0], ways[each[0]] * each[1]))
    return Changes(np.array([step for step, _ in found], dtype=np.int64), np.array([place for _, place in found]))
