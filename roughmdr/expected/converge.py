"""A rule over the shape parameters with so many nodes that more change nothing, and how far it may be off.

Gauss's rule for smooth functions, of ever higher order; where it does not converge over a single parameter, panels.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.totals import STIFFNESS
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import RoughmdrError
from roughmdr.expected.kinks import Parted
from roughmdr.expected.node import Node, Problem, dissipated_of, set_up, totals_of
from roughmdr.expected.panels import AGREE, Curves, halve_panels
from roughmdr.numerics.arguments import Floats

FIRST_ORDER = 8
_ORDERS = (12, 18, 27, 40, 60, 90, 135)
_MOST_NODES = 6_000
_AGREE = 1e-11  # of the largest force: orders whose forces part by less are both right
DOUBTFUL = 1e-3
"""Of the largest force: an error that users are warned of."""
_ROUGH = 1e-6  # of the largest: an error for which one parameter is integrated over panels
_KINKED = 1e-7  # of the greatest values: panels agree so far where kinks make more too dear
_BY_CHANCE = 10.0  # times what panels part by, where kinks between their nodes may be seen by none
_SLOW = 0.3  # a higher order that leaves so much of the difference does not help
_SLOWEST = 0.9  # as if each difference were at most so much of the one before
_POWERS = (0.5, 1.0)  # of a parameter that forces go with
_PANELS, _PANEL_ORDER = np.arange(-8.0, 8.5, 0.5).tolist(), 12  # ends of panels over normal scores
_ROUNDED = 1e-10  # means that part by less do so by roundings and by what is left out
_PROBES = 5  # steps at which they are compared where all are alike: where nothing lets go


class Converged(NamedTuple):
    """A rule with its nodes."""

    rule: Rule
    nodes: list[Node]
    doubt: float
    """How far the force may be off over its largest value; inf where that is not known."""
    doubt_of_others: float
    """Likewise of what else is asked for, but for the stiffness, which runs off where contacts let go."""


def converge(asked: Problem, parted: Parted | None, *, dissipating: bool) -> Converged:
    """The rule for all that is asked for; RoughmdrError where a contact is not representable.

    Steps at which the rule is parted do not count.
    """
    separation = asked.path.separation
    steps = [step for step in range(separation.size) if parted is None or step not in parted.cuts]
    if not asked.hysteretic:
        steps.sort(key=lambda step: float(separation[step]))  # the closest, where the force is largest, is one of them
        steps = [steps[i] for i in np.unique(np.linspace(0, len(steps) - 1, _PROBES).astype(int))]
    rows = tuple(row for row in asked.rows if row != STIFFNESS)

    def curves(nodes: list[Node]) -> Floats:
        """Of the force and all others: [curve, step]."""
        found = totals_of(nodes, separation, rows, steps)[0][np.ix_(rows, steps)]
        return np.vstack([found, dissipated_of(nodes, separation.size)[steps]]) if dissipating else found

    def off(rule: Rule) -> float:
        return sum(_off(parameter, rule) for parameter in asked.source.drawn_parameters)

    if not asked.source.one_parameter:
        product = _smooth(asked, curves)
        own = off(product.rule)
        others = max(product.doubt_of_others, own if len(rows) > 1 or dissipating else 0.0)
        return product._replace(doubt=max(product.doubt, own), doubt_of_others=others)
    # A contact that lets go makes a kink in what goes with the parameter, each step another one.
    rough, agree, chance = (DOUBTFUL, _KINKED, _BY_CHANCE) if asked.hysteretic else (_ROUGH, AGREE, 1.0)
    smooth: Converged | None = None
    with suppress(RoughmdrError):  # of parameters that next to no asperity has
        smooth = _smooth(asked, curves)
    if smooth is not None and max(smooth.doubt, smooth.doubt_of_others, off(smooth.rule)) <= rough:
        return smooth
    rule, nodes, doubts = halve_panels(partial(set_up, asked), curves, agree)
    doubts *= chance
    if smooth is not None and max(smooth.doubt, smooth.doubt_of_others) <= doubts.max():
        return smooth
    return Converged(rule, nodes, float(doubts[0]), float(doubts[1:].max(initial=0.0)))


def _smooth(asked: Problem, curves: Curves) -> Converged:
    """Gauss's rule for smooth functions."""
    rule = Rule.smooth(FIRST_ORDER)
    nodes = set_up(asked, rule)
    found = curves(nodes)
    before = doubts = np.full(len(found), math.inf)
    for order in _ORDERS:
        finer_rule = Rule.smooth(order)
        count = asked.source.nodes(finer_rule).weights.size
        if count == len(nodes):  # no parameter is drawn
            return Converged(rule, nodes, 0.0, 0.0)
        if count > _MOST_NODES:
            break
        finer = set_up(asked, finer_rule)
        again = curves(finer)
        largest, apart = (np.abs(values).max(axis=1, initial=0.0) for values in (again, again - found))
        before, doubts = doubts, apart / np.where(largest > 0.0, largest, 1.0)
        wanting = doubts > _AGREE
        if not wanting.any():
            break
        rule, nodes, found = finer_rule, finer, again
        if (doubts > _SLOW * before)[wanting].all():
            break
    off = [_left(doubt, last, asked.hysteretic) for doubt, last in zip(doubts.tolist(), before.tolist(), strict=True)]
    return Converged(rule, nodes, off[0], max(off[1:], default=0.0))


def _off(parameter: Callable[[Floats], Floats], rule: Rule) -> float:
    """How far a rule over the scores of a parameter is off, relative, in the means of powers that forces go with.

    Rules may agree with each other and all be off where a parameter has a pole.
    """
    fine = Rule.between(_PANELS, _PANEL_ORDER)
    values, exact = parameter(rule.scores), parameter(fine.scores)
    worst = 0.0
    for power in _POWERS:
        mean = float(fine.weights @ exact**power)
        if math.isfinite(mean):
            worst = max(worst, abs(float(rule.weights @ values**power) / mean - 1.0))
    return worst if worst > _ROUNDED else 0.0


def _left(doubt: float, last: float, hysteretic: bool) -> float:
    """The sum of all differences to come: they fall as the last two did, or more slowly."""
    fall = min(doubt / last, _SLOWEST) if last > 0.0 else _SLOWEST
    if doubt <= _AGREE or last == math.inf:  # either of the two may be nearer, and the coarser one is taken
        return 2.0 * doubt
    if hysteretic or doubt > _SLOW * last:  # between kinks two orders may agree by chance
        doubt = max(doubt, last)
    return doubt * max(fall / (1.0 - fall), 1.0)
