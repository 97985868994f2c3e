"""The expected force by quadrature over shape parameters and heights.

The distributions and the force of one contact are the package's; which summits are in contact, on which branch, and the
integrals are not: panels over shape parameters end at all points where anything has a kink, those over heights are
halved until their halves agree with them, and within each Gauss's rule is taken in a variable in which roots at either
end are polynomials.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache, cached_property, partial
from itertools import groupby, pairwise

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.ensemble.random.population import Population, nodes_of
from roughmdr.ensemble.random.section import RandomAsperities
from roughmdr.expected.curve import branch_ends
from roughmdr.kernels.elementwise import apply, apply_all
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.shapes import SHAPES
from studies.stated_error.contacts import branch_numbers

ORDERS = (16, 24, 36, 54)  # nodes on each panel over shape parameters, from coarse to fine
_SCORE_END, _SCORE_PANEL = 8.5, 1.7  # normal scores: where parameters end, and the widest panel
_MAX_POPULATIONS = 2
_SCAN = 100  # scores between which kinks are searched
_HALVINGS = 40
_ORDER, _RTOL = 16, 2e-15  # on each panel over heights; of the largest force
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
        for number in np.argsort(-nodes.weights).tolist():  # those of little weight may be less accurate
            share = float(nodes.weights[number])
            tolerance = _RTOL * float(np.abs(total).max()) / (share * nodes.weights.size)
            total += share * _EqualTips(self, nodes, number).force(tolerance)
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
        onset = self.depth if self.contact.kernels.adhesive else 0.0
        ends = zip(self.feet, [*tops, math.inf], strict=True)
        self.branches = [(foot * self.depth - onset, top * self.depth - onset) for foot, top in ends]
        """Indentations [m] between which each stable branch lies."""
        self.touch = -self.contact.adhesion.range
        marks = [self.touch, *(end for branch in self.branches for end in branch if end < math.inf)]
        low, high = (self.heights.origin + self.heights.edges[end] for end in (0, -1))
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

    def force(self, tolerance: float) -> Floats:
        """Return the mean force [N] of one such asperity at each step, to the tolerance [N] or to the last digits."""
        inner = [self.heights.origin + edge for edge in self.heights.edges]
        found = []
        for number, on, lowest, highest in self.in_contact:
            edges = np.array([lowest, *(z for z in inner if lowest < z < highest), highest]) - self.separation[number]
            ends = np.sqrt(np.maximum(edges - self.branches[on][0], 0.0)).tolist()
            found += [(number, on, *pair) for pair in pairwise(ends)]
        panels, total = np.array(found).reshape(-1, 4).T, np.zeros_like(self.separation)
        whole = self._integrals(panels)
        for _ in range(_HALVINGS):
            if not whole.size:
                break
            step, branch, low, high = panels
            middle = 0.5 * (low + high)
            halves = np.array([(step, branch, low, middle), (step, branch, middle, high)])
            parts = np.array([self._integrals(half) for half in halves])
            error = np.abs(parts.sum(axis=0) - whole)
            right = error <= max(tolerance, _RTOL * (np.abs(total).max() + np.abs(parts).sum()))
            total += np.bincount(step[right].astype(int), parts.sum(axis=0)[right], total.size)
            panels, whole = np.concatenate(halves[:, :, ~right], axis=1), parts[:, ~right].ravel()
        return np.asarray(total + np.bincount(panels[0].astype(int), whole, total.size))

    def _integrals(self, panels: Floats) -> Floats:
        """Return the mean force [N] over panels, [step, branch, low, high]: roots of indentations above its start."""
        step, branch = panels[:2].astype(int)
        s, ds = rule(panels[2], panels[3], _ORDER)
        feet = np.array([start for start, _ in self.branches])[branch]
        columns = (self.separation[step] - self.heights.origin, feet, branch)
        origin, foot, at_branch = (np.repeat(column, _ORDER) for column in columns)
        value = self.heights.density(origin + (foot + s * s)) * 2.0 * s * ds
        for k in set(branch.tolist()):
            value[at_branch == k] *= self._force_on(k, (s * s)[at_branch == k])
        return np.asarray(value.reshape(-1, _ORDER).sum(axis=1))

    def _force_on(self, branch: int, above: Floats) -> Floats:
        """Return the force [N] on a branch at indentations [m] above its start."""
        law, params = self.contact.kernels, self.contact.params
        x = self.feet[branch] + above / self.depth
        state = apply(law.state_on_branch, x, branch + 1.0, params) if law.branched else apply(law.state, x, params)
        return np.asarray(self.contact.force * apply_all(law.radius_force_stiffness, state, params)[1])
