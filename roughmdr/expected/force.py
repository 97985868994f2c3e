"""The force alone of the expected law, by a rule over the shape parameters that was found for parameters nearby."""

import math
from collections import Counter
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.totals import ERROR, FORCE, RADIUS, STIFFNESS
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.compute import KERNEL_ERROR, as_ensemble, warnings_of
from roughmdr.expected.converge import converge_at_kinks
from roughmdr.expected.curve import branch_ends, quantities_at
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
    """The separation [m] there; of a fitted law the measured control."""
    let_go: Floats
    """Stretch [m] at which springs at the edge of a contact let go as it is lost, 0 where it is made; NaN under an
    attraction with a range."""


class Force(NamedTuple):
    """The force of the expected law along a path."""

    force: Floats
    """[N]; of a fitted law of pressures [Pa]."""
    error: float
    """Error bound over the largest force."""
    changes: Changes
    """Where populations of one height make and lose contact; not known of a mean law on a machine."""
    rule: ForceRule | None
    """The rule by which it was found; None where steps had rules of their own."""


class Slopes(NamedTuple):
    """Derivatives of the force at given separations, off the jumps."""

    stiffness: Floats
    """With respect to minus the separation [N/m]."""
    modulus: Floats
    """With respect to the logarithm of E* [N]."""
    work: Floats
    """With respect to the logarithm of the work of adhesion [N]."""


@np.errstate(all="ignore")  # numbers that no float can hold are refused
def expected_force(
    source: Source, path: LoadingPath, effective_modulus: float, adhesion: Adhesion, rule: ForceRule | None = None
) -> Force:
    """Return the force of ``compute``; E* [Pa]. With a ``rule`` none is sought, and its error is taken for known.

    OutOfRange where a contact is not representable, or the error is too large.
    """
    adhesion = _resolved(source, effective_modulus, adhesion)
    total, nodes, rule, split = _sums(MeanProblem(source, path, effective_modulus, adhesion, (FORCE,)), rule)
    largest = float(np.abs(total[FORCE]).max())
    error = KERNEL_ERROR + rule.error + (float(total[ERROR].max()) / largest if largest > 0.0 else 0.0)
    warnings_of(error, 0.0)
    changes = _changes(path, nodes, alike=_are_alike(source))
    return Force(source.expected_count * total[FORCE], error, changes, None if split else rule)


@np.errstate(all="ignore")
def expected_slopes(
    source: Source, path: LoadingPath, effective_modulus: float, adhesion: Adhesion, rule: ForceRule | None = None
) -> Slopes | None:
    """Return the derivatives of ``expected_force``; None where other numbers matter as well: under an attraction with a
    range, and under JKR where contacts are lost one by one.

    At a given separation the force is homogeneous of degree one in E* and w. Under JKR the springs let go at
    l = sqrt(2 pi a w/E*), the force of contacts of a radius a changes by -2 E* a dl and their indentation by -dl.
    """
    adhesion = _resolved(source, effective_modulus, adhesion)
    adheres = adhesion.work > 0.0
    if adheres and (adhesion.cohesive or not source.all_alike):
        return None
    rows = (FORCE, RADIUS, STIFFNESS) if adheres else (FORCE, STIFFNESS)
    total, *_ = _sums(MeanProblem(source, path, effective_modulus, adhesion, rows), rule)
    force, stiffness, a = total[FORCE], total[STIFFNESS], total[RADIUS]
    let_go = _let_go(a, effective_modulus, adhesion)
    work = 0.5 * (stiffness - 2.0 * effective_modulus * a) * let_go
    return Slopes(*(source.expected_count * each for each in (stiffness, force - work, work)))


def _let_go(a: Floats, effective_modulus: float, adhesion: Adhesion) -> Floats:
    """Return the stretch [m] at which springs at the edge of contacts of these radii [m] let go (H 44)."""
    return np.asarray(np.sqrt(2.0 * math.pi * a * adhesion.work / effective_modulus))


def _are_alike(source: Source) -> bool:
    return source.node_count(2) == source.node_count(1)


def _resolved(source: Source, effective_modulus: float, adhesion: Adhesion) -> Adhesion:
    """Return the adhesion with the model that is used."""
    if len(adhesion.candidates) == 1:
        return adhesion
    coarse = as_ensemble(source, source.nodes(Rule.smooth(1))).columns
    validity = jkr_validity(source.shape_name, source.sigma, coarse, effective_modulus, adhesion)
    return adhesion.resolved(validity.jkr_error)


def _sums(problem: MeanProblem, rule: ForceRule | None) -> tuple[Floats, list[QuadratureNode], ForceRule, bool]:
    """Return the totals of one asperity [row, step], the nodes, their rule, and whether steps had rules of their own;
    OutOfRange where they are not finite.
    """
    split = None
    if _are_alike(problem.source):
        rule = ForceRule((Rule.smooth(1),), smooth=False, error=0.0)
    if rule is None:
        chosen, split = converge_at_kinks(problem, dissipating=False)
        rule, nodes = ForceRule(chosen.rules, chosen.smooth, chosen.error), chosen.nodes
    else:
        nodes = set_up(problem, *rule.rules)
    steps = list(range(problem.path.separation.size))
    partial = PartialRule.of(problem, rule.rules, nodes) if rule.smooth else None
    total, _ = sums_of(problem, partial, nodes, steps, dissipating=False)
    if split is not None:
        for step in split.cuts:
            total[:, step] = split.total(step, dissipating=False)
    if not np.isfinite(total).all():
        raise OutOfRange("the expected law is not finite")
    return total, nodes, rule, split is not None


def _changes(path: LoadingPath, nodes: list[QuadratureNode], *, alike: bool) -> Changes:
    """Return where nodes whose heights are all equal make and lose contact; those of drawn shapes make it together, and
    lose it one by one, which is no change.
    """
    found = list[tuple[int, float, float]]()
    fixed = [node for node in nodes if node.heights.all_equal and node.contact.kernels.adhesive]
    count = Counter(node.heights.origin for node in fixed)
    for node in fixed if alike else {node.heights.origin: node for node in fixed}.values():
        contact, origin, own = node.contact, node.heights.origin, node.in_contact.around(0.0)
        branch, feet = np.zeros(path.separation.size, dtype=np.int64), branch_ends(contact)[0]
        branch[own.step] = own.branch
        ways = np.diff(np.sign(branch))
        made = max(contact.onset, contact.depth[0] * (feet[0] - 1.0))
        touch = np.nan if contact.adhesion.cohesive else 0.0
        found += [(step, origin - made, touch) for step in np.flatnonzero(ways > 0).tolist()]
        for step in np.flatnonzero(ways < 0).tolist() if alike or count[origin] == 1 else ():
            lowest = int(np.argmin(feet[: branch[step]]))
            radius = contact.radius * quantities_at(contact, np.array(feet[lowest : lowest + 1]), lowest + 1, (RADIUS,))
            last = touch + float(_let_go(radius, contact.effective_modulus, contact.adhesion)[0, 0])
            found.append((step, origin + contact.depth[0] * (1.0 - feet[lowest]), last))
    rises = np.diff(path.separation)
    found.sort(key=lambda each: (each[0], rises[each[0]] * each[1]))
    steps, controls, let_go = np.reshape(found, (-1, 3)).T
    return Changes(steps.astype(np.int64), controls, let_go)
