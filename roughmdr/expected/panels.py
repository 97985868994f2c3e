"""The rule over one shape parameter where Gauss's rule for smooth functions does not converge: panels that are halved.

The variable is the normal score of the parameter. A panel is halved until its halves agree with it; each keeps what it
comes to, so that none is computed twice.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.nodes import Rule, fraction_above, mean_over_edge
from roughmdr.errors import RoughmdrError
from roughmdr.expected.node import Node
from roughmdr.numerics.arguments import Floats

# Normal scores at which panels end, and beyond which parameters may be left out.
_ENDS = (3.0, 4.5, 6.0, 8.5, 12.0, 17.0, 24.0, 37.0)
_USUAL_END = 8.5  # nearer ones only where no contact is representable there
_ORDER = 10
_MOST_NODES = 2_000
AGREE = 1e-12
"""Of the greatest values: panels that part by less are right."""
_NEGLIGIBLE = 1e-13  # of the greatest values: what is left out may bear that

Curves = Callable[[list[Node]], Floats]
"""Nodes -> what they come to, shares included: [curve, step]."""
SetUp = Callable[[Rule], list[Node]]


class Halved(NamedTuple):
    """A rule whose panels are fine enough, or as many as allowed."""

    rule: Rule
    nodes: list[Node]
    doubt: Floats
    """How far each curve may be off over its greatest value."""


class _Panel(NamedTuple):
    low: float
    high: float
    nodes: list[Node]
    sums: Floats


def halve_panels(set_up: SetUp, curves: Curves, agree: float) -> Halved:
    """The rule on panels from the scores where parameters are left out; RoughmdrError where not even the bulk is.

    Panels are halved until they part by less than ``agree``, relative to the greatest values.
    """
    lower, upper = (_end(side, set_up, curves) for side in (-1.0, 1.0))
    edges = sorted({0.0, *(-end for end in _ENDS if end <= lower.score), *(end for end in _ENDS if end <= upper.score)})
    doubtful = _panels(list(pairwise(edges)), set_up, curves)
    accepted: list[_Panel] = []
    off = lower.lost + upper.lost
    made = _ORDER * len(doubtful)
    while doubtful:
        greatest = np.abs(sum(panel.sums for panel in [*accepted, *doubtful])).max(axis=1, keepdims=True)
        middles = [0.5 * (panel.low + panel.high) for panel in doubtful]
        ends = [(panel.low, middle, panel.high) for panel, middle in zip(doubtful, middles, strict=True)]
        halves = _panels([pair for three in ends for pair in pairwise(three)], set_up, curves)
        made += _ORDER * len(halves)
        again: list[_Panel] = []
        for number, panel in enumerate(doubtful):
            pair = halves[2 * number : 2 * number + 2]
            apart = np.abs(pair[0].sums + pair[1].sums - panel.sums)
            if (apart <= agree * greatest).all() or made >= _MOST_NODES:
                accepted += pair
                off = off + apart
            else:
                again += pair
        doubtful = again
    parts = sorted([*accepted, *doubtful], key=lambda panel: panel.low)
    greatest = np.abs(sum(panel.sums for panel in parts)).max(axis=1)
    nodes = [node for panel in parts for node in panel.nodes]
    rule = _rule([(panel.low, panel.high) for panel in parts])
    return Halved(rule, nodes, off.max(axis=1) / np.where(greatest > 0.0, greatest, 1.0))


class _End(NamedTuple):
    score: float
    """Beyond it, on its side, parameters are left out."""
    lost: Floats
    """About what they come to: [curve, step]."""


def _end(side: float, set_up: SetUp, curves: Curves) -> _End:
    """The end of the rule on one side: where next to nothing is left, or no contact is representable beyond."""
    share_before, before = fraction_above(0.0), curves(set_up(_point(0.0)))
    bulk = np.abs(before).max(axis=1, keepdims=True)
    score, lost = 0.0, np.full_like(before, math.inf)
    for end in _ENDS:
        try:
            own = curves(set_up(_point(side * end)))
        except (RoughmdrError, ArithmeticError):
            break
        share = fraction_above(end)
        lost = share * np.abs(own) * mean_over_edge(_index(np.abs(own), np.abs(before), share_before / share))
        score, share_before, before = end, share, own
        bulk = np.maximum(bulk, share * np.abs(own).max(axis=1, keepdims=True))
        if score >= _USUAL_END and (lost <= _NEGLIGIBLE * bulk).all():
            break
    return _End(score, lost)


def _index(own: Floats, before: Floats, ratio: float) -> Floats:
    """The power of 1/share, at least 0, by which values grow from ``before`` to ``own``, whose shares have a ratio."""
    index = np.zeros_like(own)
    both = (own > before) & (before > 0.0)
    index[both] = np.log(own[both] / before[both]) / math.log(ratio)
    return index


def _point(score: float) -> Rule:
    return Rule(np.array([score]), np.ones(1))


def _panels(ends: list[tuple[float, float]], set_up: SetUp, curves: Curves) -> list[_Panel]:
    nodes = set_up(_rule(ends))
    parts = [nodes[first : first + _ORDER] for first in range(0, len(nodes), _ORDER)]
    return [_Panel(low, high, part, curves(part)) for (low, high), part in zip(ends, parts, strict=True)]


def _rule(ends: list[tuple[float, float]]) -> Rule:
    """Gauss's rule on each of some panels, with the normal density."""
    nodes, weights = np.polynomial.legendre.leggauss(_ORDER)
    low, high = np.array(ends).T[..., None]
    scores = (0.5 * (low + high) + 0.5 * (high - low) * nodes).ravel()
    shares = (0.5 * (high - low) * weights).ravel() * np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)
    return Rule(scores, shares)
