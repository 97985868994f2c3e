"""The expected force by plain and dense quadrature over shape parameters and heights.

The law of the asperities and the force of one contact are the package's; which summits are in contact, on which branch,
and the integrals are not: panels between all points where anything has a kink, and in each Gauss's rule, in a variable
in which roots at either end are polynomials.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache, cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from stated_error_contacts import profile, walk

from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Heights, Nodes, Rule, nodes_of
from roughmdr.ensemble.random.population import Population, Populations
from roughmdr.ensemble.random.section import RandomAsperities
from roughmdr.expected.curve import branch_ends
from roughmdr.kernels.adhesion import release_stretch
from roughmdr.kernels.elementwise import apply, apply_all
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.shapes import SHAPES, FlatPunch, ProfileShape

Array = NDArray[Any]

ORDERS = (16, 24, 36, 54)
"""Nodes on each panel, from coarse to fine."""
_FARTHEST, _WIDEST = 8.5, 1.7  # normal scores: where parameters end, and of a panel
_POPULATIONS = 2  # at most
_SCAN = 100  # scores between which kinks are looked for
_HALVINGS = 40
_WIDTHS = np.concatenate([4.0 ** np.arange(-18.0, 0.0), np.arange(1.0, 40.0), 40.0 * 2.0 ** np.arange(10.0)])
"""Edges of panels over heights, from the lowest, in widths of their distribution."""
_OCTAVES = np.arange(-8.0, 12.0)  # edges about the depth that contacts are measured by, in powers of 4
_OCTAVES_OF_LEAPS = np.arange(-12.0, -1.0)  # edges about a leap, in powers of 4 of that depth
_LEAP = 3.0  # times the usual rate of the force
_LEAPS_BELOW = 2.0  # depths above the foot of a branch
_FINE_SCAN, _CLOSER = 2_000, 3  # indentations between which leaps are looked for, and scans ever closer to one


@cache
def _gauss(order: int) -> tuple[Floats, Floats]:
    x, weight = np.polynomial.legendre.leggauss(order)
    return x, weight


def rule(low: Floats, high: Floats, order: int) -> tuple[Floats, Floats]:
    """Nodes and weights on each panel: [panel, node]."""
    x, weight = _gauss(order)
    y = 0.5 * (1.0 + x)
    way, speed = y * y * (3.0 - 2.0 * y), 6.0 * y * (1.0 - y)
    length = (high - low)[:, None]
    return low[:, None] + length * way, 0.5 * length * (speed * weight)


class Expected:
    """What the expected force of a scene without a sweep is made of."""

    def __init__(self, scene: Scene, separation: Floats) -> None:
        self.scene, self.separation = scene, separation
        self.law: Populations | None = None
        if isinstance(scene.asperities, RandomAsperities):
            # Heights from where most of them are: far from there z - h would lose its digits.
            law = scene.asperities.law
            datum = law.populations[0].height.loc
            self.separation = separation - datum
            self.law = replace(law, populations=tuple(_moved(each, datum) for each in law.populations))

    def nodes(self, scores: Rule) -> Nodes:
        """Asperities that stand for all."""
        return self.scene.asperities.nodes(scores) if self.law is None else nodes_of(self.law, scores)

    def force(self, order: int) -> Floats:
        """[N] at each step, with so many nodes on each panel."""
        nodes = self.nodes(self._scores(order))
        total = np.zeros_like(self.separation)
        for number, share in enumerate(nodes.share.tolist()):
            total += share * Tip(self, nodes, number).force(order)
        return self.scene.asperities.expected_count * total

    @cached_property
    def _tried(self) -> int:
        """How many nodes there are with three scores for each parameter."""
        return self.nodes(Rule(np.arange(-1.0, 2.0), np.ones(3))).share.size

    @property
    def several(self) -> bool:
        """Whether more than one parameter of a population is drawn: kinks are curves then."""
        return self._tried > 3 * _POPULATIONS

    def _scores(self, order: int) -> Rule:
        """Gauss's rule on panels that end where any step has a kink; plainly where there are many."""
        if self._tried <= _POPULATIONS:  # nothing is drawn
            return Rule(np.zeros(1), np.ones(1))
        if self.several:
            plain, step = np.linspace(-_FARTHEST, _FARTHEST, order + order // 2, retstep=True)
            return Rule(plain, float(step) * np.exp(-0.5 * plain**2) / math.sqrt(2.0 * math.pi))
        edges = np.linspace(-_FARTHEST, _FARTHEST, math.ceil(2.0 * _FARTHEST / _WIDEST) + 1)
        edges = np.union1d(edges, self._kinks)
        at, weight = rule(edges[:-1], edges[1:], order)
        return Rule(at.ravel(), (weight * np.exp(-0.5 * at**2)).ravel() / math.sqrt(2.0 * math.pi))

    @cached_property
    def _kinks(self) -> list[float]:
        """Scores at which the ends of what is in contact change places, by halving."""
        found = []
        scan = np.linspace(-_FARTHEST, _FARTHEST, _SCAN).tolist()
        for (low, before), (high, after) in pairwise((score, self._label(score)) for score in scan):
            begin, label = low, before
            while label != after:  # there may be several
                end = high
                for _ in range(_HALVINGS):
                    middle = 0.5 * (begin + end)
                    begin, end = (middle, end) if self._label(middle) == label else (begin, middle)
                found.append(end)
                begin, label = end, self._label(end)
        return found

    def _label(self, score: float) -> list[object]:
        """What the ends of all that is in contact are."""
        nodes = self.nodes(Rule(np.array([score]), np.ones(1)))
        return [Tip(self, nodes, number).label for number in range(nodes.share.size)]


def _moved(population: Population, datum: float) -> Population:
    """The same with all heights lower by ``datum`` [m]."""
    height = population.height
    loc, low, high = (end - datum for end in (height.loc, height.min, height.max))
    return replace(population, height=replace(height, loc=loc, min=low, max=high))


class Tip:
    """All asperities with one set of shape parameters."""

    def __init__(self, of: Expected, nodes: Nodes, number: int) -> None:
        source, scene = of.scene.asperities, of.scene
        values = {name: float(column[number]) for name, column in nodes.parameters.items()}
        self.shape = source.fixed or SHAPES[source.shape_name](**values)
        self.contact = Contact.of(self.shape, scene.effective_modulus, scene.adhesion_model)
        self.heights: Heights = nodes.heights[number]
        self.separation = of.separation
        self.feet, tops = branch_ends(self.contact)
        depth = self.contact.depth[0] if self.contact.law.adhesive else 0.0
        self.arcs = [
            (x * self.contact.depth[0] - depth, top * self.contact.depth[0] - depth)
            for x, top in zip(self.feet, [*tops, math.inf], strict=True)
        ]
        self.touch = -self.contact.adhesion.range
        marks = [self.touch, *(end for arc in self.arcs for end in arc if end < math.inf)]
        low, high = self.heights.low, self.heights.high
        cuts: dict[float, object] = {low: "low", high: "high"}
        for step, h in enumerate(self.separation.tolist()):
            cuts |= {h + mark: (step, k) for k, mark in enumerate(marks) if low < h + mark < high}
        self.cuts = dict(sorted(cuts.items()))
        """Heights [m] between which all summits have the same history, and what each is."""

    @property
    def held(self) -> Iterator[tuple[int, int, float, float]]:
        """Step, branch, lowest and highest summit [m] of what is in contact."""
        ends = list(self.cuts)
        on = [list(walk(0.5 * (a + b) - self.separation, self.arcs, self.touch)) for a, b in pairwise(ends)]
        for step in range(self.separation.size):
            begin = 0
            for number in range(1, len(on) + 1):
                if number == len(on) or on[number][step] != on[begin][step]:
                    if on[begin][step] >= 0:
                        yield step, on[begin][step], ends[begin], ends[number]
                    begin = number

    @property
    def label(self) -> tuple[object, ...]:
        """What the ends of all that is in contact are."""
        return tuple((step, branch, self.cuts[low], self.cuts[high]) for step, branch, low, high in self.held)

    def force(self, order: int) -> Floats:
        """[N] of one such asperity on average, at each step."""
        parts = [self._panels(*one, order) for one in self.held]
        if not parts:
            return np.zeros_like(self.separation)
        step, branch, foot, above, weight = (np.concatenate(columns) for columns in zip(*parts, strict=True))
        density = self.heights.density((self.separation[step] - self.heights.origin) + (foot + above))
        force = np.zeros_like(above)
        for one in np.unique(branch).tolist():
            force[branch == one] = self._bears(one, above[branch == one])
        return np.asarray(np.bincount(step, weight * density * force, self.separation.size), dtype=np.float64)

    def _panels(self, step: int, branch: int, low: float, high: float, order: int) -> tuple[Array, ...]:
        """Step, branch, its foot [m], indentations above that [m] and weights [m] for summits from low to high [m]."""
        h, foot = self.separation[step], self.arcs[branch][0]
        edges = np.sqrt(np.maximum(self._edges(h, foot, low - h, high - h) - foot, 0.0))
        s, ds = (each.ravel() for each in rule(edges[:-1], edges[1:], order))
        return np.full(s.size, step), np.full(s.size, branch), np.full(s.size, foot), s * s, 2.0 * s * ds

    def _edges(self, h: float, foot: float, begin: float, end: float) -> Floats:
        """Indentations [m] between which all is smooth, and no panel wider than what happens there."""
        lowest, highest, width = self.heights.low - h, self.heights.high - h, self.heights.scale
        near = foot + (self.contact.depth[0] if self.contact.law.adhesive else end - foot) * 4.0**_OCTAVES
        ends = [lowest + width * _WIDTHS, highest - width * _WIDTHS[_WIDTHS < 1.0]]
        edges = np.concatenate([[begin, end], near, *ends, self._corners, self._beside_leaps])
        return np.unique(edges[(edges >= begin) & (edges <= end)])

    @cached_property
    def _corners(self) -> Floats:
        """Indentations [m] at which the edge of the contact comes to where the profile has a kink, or to the axis."""
        effective_modulus, adhesion = self.contact.effective_modulus, self.contact.adhesion
        if adhesion.cohesive:
            return np.array([-self._opening * 2.0 * adhesion.strength / effective_modulus])
        if not isinstance(self.shape, ProfileShape):
            return np.zeros(0)
        radii = [float(b) for b in profile(self.shape).kinks]
        return np.array([float(self.shape.g(b)) - release_stretch(b, effective_modulus, adhesion.work) for b in radii])

    @cached_property
    def _beside_leaps(self) -> Floats:
        """Indentations [m] about those at which the force all but leaps, since two folds nearly part the branch."""
        law, depth = self.contact.law, self.contact.depth[0]
        if not law.adhesive or self.contact.adhesion.cohesive:
            return np.zeros(0)
        found = [np.zeros(0)]
        for branch, (foot, top) in enumerate(self.arcs):
            edges = np.linspace(0.0, min(_LEAPS_BELOW * depth, top - foot), _FINE_SCAN)
            rate = np.abs(np.diff(self._bears(branch, edges)))
            steep = np.maximum(np.maximum(rate[:-2], rate[2:]), _LEAP * np.median(rate))
            for i in np.flatnonzero(rate[1:-1] > steep) + 1:
                low, high = edges[i - 1], edges[i + 2]
                for _ in range(_CLOSER):
                    near = np.linspace(low, high, _SCAN)
                    k = int(np.abs(np.diff(self._bears(branch, near))).argmax())
                    low, high = near[max(k - 1, 0)], near[min(k + 2, _SCAN - 1)]
                steps = depth * 4.0**_OCTAVES_OF_LEAPS
                found.append(foot + 0.5 * (low + high) + np.concatenate([-steps, [0.0], steps]))
        return np.concatenate(found)

    @property
    def _opening(self) -> float:
        """The cohesive radius [m] where contacts cease to touch."""
        if isinstance(self.shape, FlatPunch):
            return self.shape.radius
        adhesion, end = self.contact.adhesion, 1.0
        pull = 2.0 * adhesion.strength / self.contact.effective_modulus * (1.0 - 2.0 / math.pi)

        def above(c: float) -> float:
            return float(self.shape.f(c)) + pull * c - adhesion.range

        while above(end) > 0.0:
            end *= 0.5
        while above(end) < 0.0:
            end *= 2.0
        return float(brentq(above, 0.5 * end, end, xtol=1e-300, rtol=1e-14))

    def _bears(self, branch: int, above: Floats) -> Floats:
        """[N] on a branch at indentations so far above its foot."""
        law, params = self.contact.law, self.contact.params
        x = self.feet[branch] + above / self.contact.depth[0]
        state = apply(law.state_on_branch, x, branch + 1.0, params) if law.branched else apply(law.state, x, params)
        return np.asarray(self.contact.force * apply_all(law.radius_force_stiffness, state, params)[1])
