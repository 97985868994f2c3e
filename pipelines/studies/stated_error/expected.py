"""The expected force by plain and dense quadrature over shape parameters and heights.

The distributions and the force of one contact are the package's; which summits are in contact, on which branch, and the
integrals are not: panels end at all points where anything has a kink, and within each Gauss's rule is taken in a
variable in which roots at either end are polynomials.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache, cached_property, partial
from itertools import groupby, pairwise

import numpy as np
from oracles.profiles import closed_profile
from scipy.optimize import brentq
from studies.stated_error.contacts import branch_numbers

from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.ensemble.random.population import Population
from roughmdr.ensemble.random.population_nodes import nodes_of
from roughmdr.ensemble.random.section import RandomAsperities
from roughmdr.expected.curve import branch_ends
from roughmdr.kernels.adhesion import release_stretch
from roughmdr.kernels.elementwise import apply, apply_all
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.shapes import SHAPES, FlatPunch, ProfileShape

ORDERS = (16, 24, 36, 54)
"""Nodes on each panel, from coarse to fine."""
_SCORE_END, _SCORE_PANEL = 8.5, 1.7  # normal scores: where parameters end, and the widest panel
_MAX_POPULATIONS = 2
_SCAN = 100  # scores between which kinks are searched
_HALVINGS = 40
_HEIGHT_EDGES = np.concatenate([4.0 ** np.arange(-18.0, 0.0), np.arange(1.0, 40.0), 40.0 * 2.0 ** np.arange(10.0)])
"""Edges of panels over heights, from the lowest, in widths of their distribution."""
_DEPTH_EDGES = 4.0 ** np.arange(-8.0, 12.0)  # edges above the start of a branch, over the natural depth
_LEAP_EDGES = 4.0 ** np.arange(-12.0, -1.0)  # edges about a leap, over the natural depth
_LEAP_RATE = 3.0  # times the usual rate of the force
_LEAP_SEARCH = 2.0  # natural depths above the start of a branch
_LEAP_SCAN, _REFINEMENTS = 2_000, 3  # indentations between which leaps are searched, and ever finer scans about one
_gauss = cache(np.polynomial.legendre.leggauss)


def rule(low: Floats, high: Floats, order: int) -> tuple[Floats, Floats]:
    """Return nodes and weights on each panel, one panel after the other."""
    x, weight = _gauss(order)
    y, length = 0.5 * (1.0 + x), (high - low)[:, None]
    nodes = low[:, None] + length * (y * y * (3.0 - 2.0 * y))
    return nodes.ravel(), (0.5 * length * (6.0 * y * (1.0 - y) * weight)).ravel()


def _over_scores(score: Floats, weight: Floats) -> Rule:
    """Return the rule for means over a normal score."""
    return Rule(score, weight * np.exp(-0.5 * score**2) / math.sqrt(2.0 * math.pi))


class ExpectedForce:
    """The expected force of a scene without a sweep."""

    def __init__(self, scene: Scene, separation: Floats) -> None:
        self.scene, self.separation, self.nodes = scene, separation, scene.asperities.nodes
        if isinstance(scene.asperities, RandomAsperities):
            # Heights are measured from where most of them are: far from there z - h would lose its digits.
            populations = scene.asperities.populations
            datum = populations.members[0].height.loc
            self.separation = separation - datum
            lowered = replace(populations, members=tuple(_lowered(each, datum) for each in populations.members))
            self.nodes = partial(nodes_of, lowered)
        count = self.nodes(Rule(np.arange(-1.0, 2.0), np.ones(3))).weights.size
        self.drawn = count > _MAX_POPULATIONS
        """Whether a shape parameter is drawn."""
        self.several = count > 3 * _MAX_POPULATIONS
        """Whether more than one parameter of a population is drawn: kinks are curves then."""

    def force(self, order: int) -> Floats:
        """Return the force [N] at each step, with ``order`` nodes on each panel."""
        nodes = self.nodes(self._scores(order))
        total = np.zeros_like(self.separation)
        for number, share in enumerate(nodes.weights.tolist()):
            total += share * _EqualTips(self, nodes, number).force(order)
        return self.scene.asperities.expected_count * total

    def _scores(self, order: int) -> Rule:
        """Return Gauss's rule on panels that end at the kinks of all steps; the trapezoidal rule for curved kinks."""
        if not self.drawn:
            return Rule(np.zeros(1), np.ones(1))
        if self.several:
            score, step = np.linspace(-_SCORE_END, _SCORE_END, order + order // 2, retstep=True)
            return _over_scores(score, np.full(score.size, step))
        edges = np.linspace(-_SCORE_END, _SCORE_END, math.ceil(2.0 * _SCORE_END / _SCORE_PANEL) + 1)
        edges = np.union1d(edges, self._kinks)
        return _over_scores(*rule(edges[:-1], edges[1:], order))

    @cached_property
    def _kinks(self) -> list[float]:
        """Scores at which the ends of what is in contact change their order, by bisection."""
        kinks = []
        scan = np.linspace(-_SCORE_END, _SCORE_END, _SCAN).tolist()
        for (low, before), (high, after) in pairwise((score, self._label(score)) for score in scan):
            begin, label = low, before
            while label != after:  # there may be several
                end = high
                for _ in range(_HALVINGS):
                    middle = 0.5 * (begin + end)
                    begin, end = (middle, end) if self._label(middle) == label else (begin, middle)
                kinks.append(end)
                begin, label = end, self._label(end)
        return kinks

    def _label(self, score: float) -> list[object]:
        """Return the ends of all that is in contact, by their names."""
        nodes = self.nodes(Rule(np.array([score]), np.ones(1)))
        return [_EqualTips(self, nodes, number).label for number in range(nodes.weights.size)]


def _lowered(population: Population, datum: float) -> Population:
    """Return a population with all heights lower by ``datum`` [m]."""
    height = population.height
    loc, low, high = (end - datum for end in (height.loc, height.min, height.max))
    return replace(population, height=replace(height, loc=loc, min=low, max=high))


class _EqualTips:
    """All asperities with one set of shape parameters."""

    def __init__(self, expected: ExpectedForce, nodes: Nodes, number: int) -> None:
        scene, self.heights, self.separation = expected.scene, nodes.heights[number], expected.separation
        values = {name: float(column[number]) for name, column in nodes.parameters.items()}
        self.shape = scene.asperities.shared_profile or SHAPES[scene.asperities.shape_name](**values)
        self.contact = Contact.of(self.shape, scene.effective_modulus, scene.adhesion_model)
        self.depth = self.contact.depth[0]
        """The natural depth [m]."""
        self.feet, tops = branch_ends(self.contact)
        onset = self.depth if self.contact.law.adhesive else 0.0
        ends = zip(self.feet, [*tops, math.inf], strict=True)
        self.branches = [(foot * self.depth - onset, top * self.depth - onset) for foot, top in ends]
        """Indentations [m] between which each stable branch lies."""
        self.touch = -self.contact.adhesion.range
        marks = [self.touch, *(end for branch in self.branches for end in branch if end < math.inf)]
        low, high = self.heights.low, self.heights.high
        cuts: dict[float, object] = {low: "low", high: "high"}
        for step, h in enumerate(self.separation.tolist()):
            cuts |= {h + mark: (step, k) for k, mark in enumerate(marks) if low < h + mark < high}
        self.cuts = dict(sorted(cuts.items()))
        """Heights [m] between which all summits have the same history, each with its name."""

    @property
    def in_contact(self) -> Iterator[tuple[int, int, float, float]]:
        """Step, branch, lowest and highest summit [m] of what is in contact."""
        cuts = list(pairwise(self.cuts))
        paths = (0.5 * (low + high) - self.separation for low, high in cuts)
        branches = [list(branch_numbers(path, self.branches, self.touch)) for path in paths]
        for step, at_step in enumerate(zip(*branches, strict=True)):
            for branch, group in groupby(zip(at_step, cuts, strict=True), key=lambda pair: pair[0]):
                if branch >= 0:
                    ends = [end for _, cut in group for end in cut]
                    yield step, branch, ends[0], ends[-1]

    @property
    def label(self) -> tuple[object, ...]:
        """The ends of all that is in contact, by their names."""
        return tuple((step, branch, self.cuts[low], self.cuts[high]) for step, branch, low, high in self.in_contact)

    def force(self, order: int) -> Floats:
        """Return the mean force [N] of one such asperity at each step."""
        parts = [self._panels(*one, order) for one in self.in_contact]
        if not parts:
            return np.zeros_like(self.separation)
        step, branch, y, above, weight = np.concatenate(parts, axis=1)
        weight *= self.heights.density(y)
        for k in np.unique(branch).astype(int).tolist():
            weight[branch == k] *= self._force_on(k, above[branch == k])
        return np.asarray(np.bincount(step.astype(int), weight, self.separation.size), dtype=np.float64)

    def _panels(self, step: int, branch: int, low: float, high: float, order: int) -> Floats:
        """Return nodes for summits from low to high [m]: step, branch, y of ``Heights``, depth above foot, weight."""
        h, foot = self.separation[step], self.branches[branch][0]
        edges = np.sqrt(np.maximum(self._edges(h, foot, low - h, high - h) - foot, 0.0))
        s, ds = rule(edges[:-1], edges[1:], order)
        y = (h - self.heights.origin) + (foot + s * s)
        return np.array([np.full(s.size, step), np.full(s.size, branch), y, s * s, 2.0 * s * ds])

    def _edges(self, h: float, foot: float, begin: float, end: float) -> Floats:
        """Return indentations [m] between which all is smooth, and no panel wider than the features there."""
        lowest, highest, width = self.heights.low - h, self.heights.high - h, self.heights.scale
        above_foot = foot + (self.depth if self.contact.law.adhesive else end - foot) * _DEPTH_EDGES
        from_ends = [lowest + width * _HEIGHT_EDGES, highest - width * _HEIGHT_EDGES[_HEIGHT_EDGES < 1.0]]
        edges = np.concatenate([[begin, end], above_foot, *from_ends, self._corners, self._leap_edges])
        return np.unique(edges[(edges >= begin) & (edges <= end)])

    @cached_property
    def _corners(self) -> Floats:
        """Indentations [m] at which the edge of the contact comes to a kink of the profile, or to the axis."""
        effective_modulus, adhesion = self.contact.effective_modulus, self.contact.adhesion
        if adhesion.cohesive:
            return np.array([-self._zone_at_lift * 2.0 * adhesion.strength / effective_modulus])
        if not isinstance(self.shape, ProfileShape):
            return np.zeros(0)
        radii = [float(b) for b in closed_profile(self.shape).kinks]
        return np.array([float(self.shape.g(b)) - release_stretch(b, effective_modulus, adhesion.work) for b in radii])

    @property
    def _zone_at_lift(self) -> float:
        """The cohesive radius [m] at which contacts cease to touch."""
        if isinstance(self.shape, FlatPunch):
            return self.shape.radius
        shape, adhesion = self.shape, self.contact.adhesion
        pull = 2.0 * adhesion.strength / self.contact.effective_modulus * (1.0 - 2.0 / math.pi)
        return float(
            brentq(lambda c: float(shape.f(c)) + pull * c - adhesion.range, 0.0, adhesion.range / pull, xtol=1e-300)
        )

    @cached_property
    def _leap_edges(self) -> Floats:
        """Indentations [m] about those at which the force all but leaps, since two folds nearly part the branch."""
        if not self.contact.law.adhesive or self.contact.adhesion.cohesive:
            return np.zeros(0)
        found = []
        for branch, (foot, top) in enumerate(self.branches):
            edges = np.linspace(0.0, min(_LEAP_SEARCH * self.depth, top - foot), _LEAP_SCAN)
            rate = np.abs(np.diff(self._force_on(branch, edges)))
            steep = np.maximum(np.maximum(rate[:-2], rate[2:]), _LEAP_RATE * np.median(rate))
            for i in np.flatnonzero(rate[1:-1] > steep) + 1:
                low, high = edges[i - 1], edges[i + 2]
                for _ in range(_REFINEMENTS):
                    scan = np.linspace(low, high, _SCAN)
                    k = int(np.abs(np.diff(self._force_on(branch, scan))).argmax())
                    low, high = scan[max(k - 1, 0)], scan[min(k + 2, _SCAN - 1)]
                found.append(foot + 0.5 * (low + high))
        steps = self.depth * np.concatenate([-_LEAP_EDGES, [0.0], _LEAP_EDGES])
        return (np.array(found)[:, None] + steps).ravel()

    def _force_on(self, branch: int, above: Floats) -> Floats:
        """Return the force [N] on a branch at indentations [m] above its start."""
        law, params = self.contact.law, self.contact.params
        x = self.feet[branch] + above / self.depth
        state = apply(law.state_on_branch, x, branch + 1.0, params) if law.branched else apply(law.state, x, params)
        return np.asarray(self.contact.force * apply_all(law.radius_force_stiffness, state, params)[1])
