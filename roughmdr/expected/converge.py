"""The choice of a rule over the shape parameters, so fine that more nodes change nothing, and its error bound.

It is Gauss's rule for smooth functions, of increasing order; where that does not converge over a single parameter,
panels.
"""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.totals import DISSIPATED
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import RoughmdrError
from roughmdr.expected.detached import PartialRule, sums_of
from roughmdr.expected.node import MeanProblem, QuadratureNode, set_up
from roughmdr.expected.split_rules import RTOL_PANEL, KinkSplit, halve_panels
from roughmdr.numerics.arguments import Floats, Ints

FIRST_ORDER = 8
WARNED_ERROR = 1e-3
"""Error, over the largest force, above which users are warned."""
_ORDERS = (12, 18, 27, 40, 60, 90, 135)
_MAX_NODES = 6_000
_RTOL_ORDER = 1e-11  # largest difference of the forces of two right orders, over the largest force
_MAX_ERROR = 1e-6  # error, over the largest, above which a single parameter is integrated over panels
_MAX_PARTIAL = 1e-9  # error, over the largest, above which the rule is split or integrated over panels
_RTOL_KINKED = 1e-7  # tolerance of panels with kinks, over the largest value: a smaller one costs too much
_KINK_FACTOR = 10.0  # safety factor on the change by halving panels, since nodes may miss kinks between them
_SLOW = 0.3  # a higher order that leaves more of the difference does not help
_SLOWEST = 0.9  # a difference is taken to be at most so much of the one before
_EXPONENTS = (0.5, 1.0)  # forces are about proportional to such powers of a parameter
_PANEL_ENDS, _PANEL_ORDER = np.arange(-8.0, 8.5, 0.5).tolist(), 12  # normal scores
_MEAN_ROUNDING = 1e-10  # relative: means that differ by less do so by roundings and by what is left out
_PROBES = 5  # steps of each kind that are compared where nothing has a kink


_CurvesOfRule = Callable[[list[QuadratureNode], PartialRule | None], Floats]


class Converged(NamedTuple):
    """Rules, one for each random parameter, with their nodes."""

    rules: tuple[Rule, ...]
    nodes: list[QuadratureNode]
    error: float
    """Error bound of the force over its largest value; inf where there is none."""
    error_of_others: float
    """Error bound of the other rows over their largest values, without the stiffness, infinite at detachment."""
    smooth: bool
    """Whether the rules are those for smooth functions."""

    def sums(self, problem: MeanProblem, nodes: list[QuadratureNode], *, dissipating: bool) -> tuple[Floats, int]:
        """Return the totals of one asperity [row, step], and how often tables were multiplied; ``nodes`` may have been
        moved to the path of the problem.
        """
        steps = list(range(problem.path.separation.size))
        partial = PartialRule.of(problem, self.rules, nodes) if self.smooth else None
        return sums_of(problem, partial, nodes, steps, dissipating=dissipating)


class _Trial(NamedTuple):
    """Rules with their nodes, the weights of their parts, and the curves that they give."""

    rules: tuple[Rule, ...]
    nodes: list[QuadratureNode]
    partial: PartialRule | None
    found: Floats


def converge_at_kinks(problem: MeanProblem, *, dissipating: bool) -> tuple[Converged, KinkSplit | None]:
    """Return the rule for all rows, and where it is split at some steps; arguments and errors as ``converge``."""
    if problem.hysteretic:
        with suppress(RoughmdrError):  # parameters that almost no asperity has may not be representable
            smooth = _converge_parts(problem, dissipating)
            if smooth is not None and (max(smooth.error, smooth.error_of_others) <= _MAX_PARTIAL):
                return smooth, None
    split = KinkSplit.of(problem)
    return converge(problem, split, dissipating=dissipating), split


def _converge_parts(problem: MeanProblem, dissipating: bool) -> Converged | None:
    """Return the rule for smooth functions with the weights of its parts; None where these do not hold.

    Nothing has a kink then, and a few steps are compared.
    """
    finest = Rule.smooth(_ORDERS[-1])
    if any(_mean_error(parameter, finest) > _MAX_PARTIAL for parameter in problem.source.drawn_parameters):
        return None
    rules = _first_rules(problem)
    nodes = set_up(problem, *rules)
    first = PartialRule.of(problem, rules, nodes)
    if first is None:
        return None
    separation = problem.path.separation
    falls = np.append(True, np.diff(separation) < 0.0)
    kinds = np.flatnonzero(falls), np.flatnonzero(~falls), first.steps
    steps = np.unique(np.concatenate([[int(np.argmin(separation))], *(_spread(kind) for kind in kinds)]))
    smooth = _converge_order(problem, _curves(problem, steps.tolist(), dissipating), nodes, in_parts=True)
    return _with_means(problem, smooth, others=True)


def _first_rules(problem: MeanProblem) -> tuple[Rule, ...]:
    return (Rule.smooth(FIRST_ORDER),) * sum(problem.source.node_axes)


def _with_means(problem: MeanProblem, smooth: Converged, *, others: bool) -> Converged:
    """Return the rules with errors not below those in the means of the parameters, of ``others`` too or not."""
    of_means = _mean_errors(problem, smooth.rules)
    of_others = max(smooth.error_of_others, of_means if others else 0.0)
    return smooth._replace(error=max(smooth.error, of_means), error_of_others=of_others)


def _spread(steps: Ints) -> Ints:
    """Return a few of some steps."""
    return np.asarray(steps[np.unique(np.linspace(0, steps.size - 1, _PROBES).astype(int))])


def converge(problem: MeanProblem, split: KinkSplit | None, *, dissipating: bool) -> Converged:
    """Return the rule for all rows; RoughmdrError where a contact is not representable.

    Steps at which the rule is split are not considered.
    """
    separation = problem.path.separation
    steps = [step for step in range(separation.size) if split is None or step not in split.cuts]
    if not problem.hysteretic:
        steps.sort(key=lambda step: float(separation[step]))  # the closest, where the force is largest, is one of them
        steps = _spread(np.array(steps)).tolist()
    curves = _curves(problem, steps, dissipating)
    if not problem.source.one_parameter:
        product = _converge_order(problem, curves, set_up(problem, *_first_rules(problem)))
        return _with_means(problem, product, others=len(problem.judged) > 1 or dissipating)
    # A contact that detaches makes a kink over the parameter, at each step another one.
    limit, rtol, factor = (
        (WARNED_ERROR, _RTOL_KINKED, _KINK_FACTOR) if problem.hysteretic else (_MAX_ERROR, RTOL_PANEL, 1.0)
    )
    smooth: Converged | None = None
    with suppress(RoughmdrError):  # parameters that almost no asperity has may not be representable
        smooth = _converge_order(problem, curves, set_up(problem, *_first_rules(problem)))
    if smooth is not None and max(smooth.error, smooth.error_of_others, _mean_errors(problem, smooth.rules)) <= limit:
        return smooth
    rule, nodes, errors = halve_panels(problem, lambda nodes: curves(nodes, None), rtol)
    errors *= factor
    if smooth is not None and max(smooth.error, smooth.error_of_others) <= errors.max():
        return smooth
    return Converged((rule,), nodes, float(errors[0]), float(errors[1:].max(initial=0.0)), smooth=False)


def _curves(problem: MeanProblem, steps: Sequence[int], dissipating: bool) -> _CurvesOfRule:
    """Return the function that has the force and all other rows which are judged: [curve, step]."""
    judged = problem._replace(rows=problem.judged)
    rows = (*judged.rows, DISSIPATED) if dissipating else judged.rows

    def curves(nodes: list[QuadratureNode], partial: PartialRule | None) -> Floats:
        return sums_of(judged, partial, nodes, list(steps), dissipating=dissipating)[0][np.ix_(rows, steps)]

    return curves


def _converge_order(
    problem: MeanProblem, curves: _CurvesOfRule, nodes: list[QuadratureNode], *, in_parts: bool = False
) -> Converged:
    """Raise the orders of Gauss's rules for smooth functions, from the first rules and their nodes on, until two agree
    or a higher one does not help.

    That is done one axis after the other; where there are kinks, which cross all axes, for all axes at once. Rules that
    have to be taken ``in_parts`` but do not have them are not tried.
    """

    def trial(rules: tuple[Rule, ...], nodes: list[QuadratureNode]) -> _Trial:
        partial = PartialRule.of(problem, rules, nodes)
        return _Trial(rules, nodes, partial, curves(nodes, partial))

    base = trial(_first_rules(problem), nodes)
    every = tuple(range(len(base.rules)))
    kinked = problem.hysteretic and base.partial is None
    waiting: list[tuple[int, ...]] = [every] if kinked and every else [(axis,) for axis in every]
    errors = {axes: np.full(len(base.found), math.inf) for axes in waiting}
    changes = errors.copy()
    while waiting:
        axes = waiting.pop(0)
        order = next((order for order in _ORDERS if order > base.rules[axes[0]].scores.size), None)
        if order is None:
            continue
        rules = tuple(Rule.smooth(order) if axis in axes else rule for axis, rule in enumerate(base.rules))
        if _count(problem, rules) > _MAX_NODES:
            continue
        finer = trial(rules, set_up(problem, *rules))
        if in_parts and finer.partial is None:
            break
        largest, change = (
            np.abs(values).max(axis=1, initial=0.0) for values in (finer.found, finer.found - base.found)
        )
        last, changes[axes] = changes[axes], change / np.where(largest > 0.0, largest, 1.0)
        kinked = problem.hysteretic and finer.partial is None
        pairs = zip(changes[axes].tolist(), last.tolist(), strict=True)
        errors[axes] = np.array([_changes_to_come(*pair, kinked) for pair in pairs])
        too_large = changes[axes] > _RTOL_ORDER
        if not too_large.any():
            continue
        base = finer
        slow = bool((changes[axes] > _SLOW * last)[too_large].all())
        if in_parts and slow and errors[axes].max() > _MAX_PARTIAL:
            break
        if not slow:
            waiting.append(axes)
    force, *others = sum(errors.values(), np.zeros(len(base.found))).tolist()
    return Converged(base.rules, base.nodes, force, max(others, default=0.0), smooth=True)


def _count(problem: MeanProblem, rules: tuple[Rule, ...]) -> int:
    """Return the number of nodes of rules."""
    orders = iter([rule.scores.size for rule in rules])
    return sum(math.prod(next(orders) for _ in range(axes)) for axes in problem.source.node_axes)


def _mean_errors(problem: MeanProblem, rules: tuple[Rule, ...]) -> float:
    """Return the sum of the errors of rules in the means of all parameters whose means are known."""
    return sum(map(_mean_error, problem.source.drawn_parameters, rules))


def _mean_error(parameter: Callable[[Floats], Floats], rule: Rule) -> float:
    """Return the relative error of a rule in the means of p^0.5 and p, p a parameter: forces vary about like these.

    Where a parameter has a pole, rules may agree with each other and all be wrong.
    """
    fine = Rule.between(_PANEL_ENDS, _PANEL_ORDER)
    values, exact = parameter(rule.scores), parameter(fine.scores)
    worst = 0.0
    for exponent in _EXPONENTS:
        mean = float(fine.weights @ exact**exponent)
        if math.isfinite(mean):
            worst = max(worst, abs(float(rule.weights @ values**exponent) / mean - 1.0))
    return worst if worst > _MEAN_ROUNDING else 0.0


def _changes_to_come(change: float, before: float, kinked: bool) -> float:
    """Return the sum of all later changes, which decrease as the last two did or more slowly."""
    ratio = min(change / before, _SLOWEST) if before > 0.0 else _SLOWEST
    if (
        change <= _RTOL_ORDER or before == math.inf
    ):  # the coarser of two rules that agree is used; one change alone shows no rate
        return 2.0 * change
    if kinked or change > _SLOW * before:  # between kinks two orders may agree by chance
        change = max(change, before)
    return change * max(ratio / (1.0 - ratio), 1.0)
