"""The fewest asperities with weights whose sum is the expected law to an error asked for: nodes for other codes.

Over the shape parameters a Gauss rule of few scores is taken, over the heights of each of its nodes a rule of
``height_rules``. Both are refined until force and contact area are within the error all along the path, also between
its steps.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.tabor import jkr_validity
from roughmdr.aggregate.totals import AREA, COUNT, FORCE
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.compute import as_ensemble, compute
from roughmdr.expected.curve import quantities_of
from roughmdr.expected.height_rules import RULES, Points, points_of, rule_of
from roughmdr.expected.node import MeanProblem, QuadratureNode, set_up, totals_of
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats

_VARIABLES = ("force", "contact_area", "contact_count")
_ROWS = (FORCE, AREA, COUNT)
_SEPARATIONS = 1024
"""Least number of separations at which the error is taken: steps of the path and separations between them."""
_ORDERS = (1, 2, 3, 4, 6, 8, 12, 18, 27)
_SHARE = 0.25
"""Share of the error asked for that the rule over the shape parameters may use."""
_MOST_HEIGHTS = {"gauss": 100, "equal_fractions": 5_000}
"""Most heights for one score of the shape parameters."""
_SHARE_POWER = {"gauss": 2.0 / 7.0, "equal_fractions": 1.0}
_GROWTH = 1.3
_AT_ONCE = 2**21  # contacts


class FewAsperities(NamedTuple):
    """Asperities with weights: sum of weight P(height - separation) is the expected law."""

    height: Floats
    """[m] above the datum plane: [node]."""
    weight: Floats
    """Number of asperities for which each stands: [node]."""
    parameters: dict[str, Floats]
    """[SI], each [node]; empty where all share a profile."""
    adhesion: Adhesion
    """The model, "jkr" or "dugdale"."""
    errors: tuple[float, float, float]
    """Largest error of force, contact area and number in contact over the path, each over its largest value."""
    separations: int
    """At which these were taken."""


def few_asperities(
    source: Source, path: LoadingPath, *, effective_modulus: float, adhesion: Adhesion, error: float
) -> FewAsperities:
    """Return as few asperities as have the expected force and area along a path, within ``error`` of the largest.

    E* is in Pa. OutOfRange where that takes too many, where the expected law itself is not so right, or has no force.
    """
    path = _refined(path, adhesive=adhesion.work > 0.0)
    validity = jkr_validity(
        source.shape_name,
        source.sigma,
        as_ensemble(source, source.nodes(Rule.smooth(_ORDERS[-1]))).columns,
        effective_modulus,
        adhesion,
    )
    adhesion = adhesion.resolved(validity.jkr_error)
    law = compute(source, path, effective_modulus=effective_modulus, adhesion=adhesion, variables=_VARIABLES)
    if law.numerical_error > _SHARE * error:
        raise OutOfRange(
            f"error is {error:g}, and the expected law itself is right to {law.numerical_error:.1g} of its largest"
        )
    count = source.expected_count
    exact = np.array([law.variables[name] for name in _VARIABLES]) / count
    largest = np.abs(exact).max(axis=1)
    if not largest[0] > 0.0:
        raise OutOfRange("no asperity has any force along the path: there is no law to be had from nodes")
    search = _Search(MeanProblem(source, path, effective_modulus, adhesion, _ROWS), exact, largest, error)
    rule, nodes = search.over_parameters()
    heights = search.over_heights(nodes)
    reached = search.errors(nodes, heights)
    every = source.nodes(rule)
    number = np.repeat(np.arange(len(nodes)), [points[0].size for points in heights])
    return FewAsperities(
        np.concatenate([node.heights.origin + points[0] for node, points in zip(nodes, heights, strict=True)]),
        np.concatenate([count * node.fraction * points[1] for node, points in zip(nodes, heights, strict=True)]),
        {name: column[number] for name, column in every.parameters.items()},
        adhesion,
        (float(reached[0]), float(reached[1]), float(reached[2])),
        path.separation.size,
    )


class _Search(NamedTuple):
    """The search for the fewest nodes."""

    problem: MeanProblem
    exact: Floats
    """The expected law of one asperity: [row, step]."""
    largest: Floats
    """[row]."""
    error: float

    def over_parameters(self) -> tuple[Rule, list[QuadratureNode]]:
        """Return the rule with the fewest scores whose law, with all heights, is within its share of the error."""
        separation = self.problem.path.separation
        source = self.problem.source
        for order in _ORDERS if source.node_count(2) > source.node_count(1) else _ORDERS[:1]:
            rule = Rule.smooth(order)
            nodes = set_up(self.problem, rule)
            total, _ = totals_of(nodes, separation, _ROWS, list(range(separation.size)))
            off = np.abs(total[list(_ROWS)] - self.exact).max(axis=1) / self.largest
            if off[:2].max() <= _SHARE * self.error:
                return rule, nodes
        raise OutOfRange(
            f"error is {self.error:g}, and shape parameters at {order} scores have the expected law to "
            f"{off[:2].max():.1g} of its largest only: they scatter too widely for a few nodes"
        )

    def over_heights(self, nodes: list[QuadratureNode]) -> list[Points]:
        """Return the heights of each node by the rule that needs the fewest in all."""
        found: list[Points] | None = None
        for name in RULES:
            most = _MOST_HEIGHTS[name] * len(nodes) if found is None else sum(points[0].size for points in found) - 1
            found = self._fewest(nodes, name, most) or found
        if found is None:
            most = max(_MOST_HEIGHTS.values()) * len(nodes)
            raise OutOfRange(f"error is {self.error:g}, and {most} heights do not have the expected law to that")
        return found

    def _fewest(self, nodes: list[QuadratureNode], name: str, most: int) -> list[Points] | None:
        """Return the heights of a rule with the fewest of them, up to ``most``; None where these are not enough."""
        failed = 0
        for count in _growing(most):
            heights = self._heights(nodes, name, count)
            if self._met(nodes, heights):
                break
            failed = count
        else:
            return None
        while count - failed > 1 + count // 20:
            middle = (count + failed) // 2
            tried = self._heights(nodes, name, middle)
            if self._met(nodes, tried):
                count, heights = middle, tried
            else:
                failed = middle
        return heights

    def _heights(self, nodes: list[QuadratureNode], name: str, count: int) -> list[Points]:
        """Return ``count`` heights or so in all.

        Of equal fractions all together have the fewest where each height stands for as many; of Gauss's rule, whose
        error falls as count^-5/2, where each node has as many as its fraction to the power 2/7.
        """
        shares = np.array([node.fraction for node in nodes]) ** _SHARE_POWER[name]
        heights = []
        for number, (node, share) in enumerate(zip(nodes, shares / shares.sum(), strict=True)):
            own = max(1, round(count * share))
            lowest = float(node.in_contact.begin.min(initial=math.inf))
            points = points_of(node.heights, lowest, own, name)
            heights.append(rule_of(points, own, name, number / len(nodes)) if points[0].size else points)
        return heights

    def _met(self, nodes: list[QuadratureNode], heights: list[Points]) -> bool:
        return bool(self.errors(nodes, heights)[:2].max() <= self.error)

    def errors(self, nodes: list[QuadratureNode], heights: list[Points]) -> Floats:
        """Return the largest error of each row over its largest value."""
        separation = self.problem.path.separation
        total = np.zeros_like(self.exact)
        for node, points in zip(nodes, heights, strict=True):
            total += node.fraction * weighted_sum(node, points, separation)
        return np.asarray(np.abs(total - self.exact).max(axis=1) / np.where(self.largest > 0.0, self.largest, 1.0))


def _refined(path: LoadingPath, *, adhesive: bool) -> LoadingPath:
    """Return a path with separations between its steps."""
    steps = path.separation.size
    parts = max(2, math.ceil(_SEPARATIONS / steps))
    at = np.arange((steps - 1) * parts + 1) / parts
    separation = np.interp(at, np.arange(steps), path.separation)
    return LoadingPath.along(separation, unload=False, adhesive=adhesive)


def _growing(most: int) -> Iterator[int]:
    """Yield growing numbers of nodes, ``most`` at last."""
    count = 2
    while count < most:
        yield count
        count = math.ceil(_GROWTH * count)
    yield most


def weighted_sum(node: QuadratureNode, rule: Points, separation: Floats) -> Floats:
    """Return force [N], contact area [m2] and number in contact at each separation [m] of the node's path: [row, step].

    The heights of ``rule`` are differences to the origin of those of the node, ascending.
    """
    y, weights = rule
    steps, branches = node.in_contact.step, node.in_contact.branch
    first, last = np.searchsorted(y, node.in_contact.begin), np.searchsorted(y, node.in_contact.end)
    total = np.zeros((3, separation.size))
    rows = max(1, _AT_ONCE // max(y.size, 1))
    for begin in range(0, steps.size, rows):
        part = np.arange(begin, min(begin + rows, steps.size))
        sizes = np.maximum(last[part] - first[part], 0)
        row = np.repeat(part, sizes)
        number = np.arange(row.size) - np.repeat(np.cumsum(sizes) - sizes, sizes) + first[row]
        indentation = y[number] - (separation[steps[row]] - node.heights.origin)
        for quantity, values in enumerate(quantities_of(node.contact, indentation, branches[row], _ROWS)):
            total[quantity] += np.bincount(steps[row], weights[number] * values, separation.size)
    return total
