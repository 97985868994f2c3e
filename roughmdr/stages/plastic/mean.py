"""The mean over asperities of random heights and radii that yield.

Over the heights the density is taken from its table, and the contact as it is: Gauss's rule in the square root of the
distance to the edge of contact, between the edges of the table and where contacts begin to yield or have kinks. A
second rule tells the error. Over the radii Gauss's rule is refined until the force no longer changes.
"""

import math
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.tabor import JkrValidity
from roughmdr.aggregate.totals import (
    AREA,
    CONDUCTANCE,
    COUNT,
    DISSIPATED,
    ENERGY,
    ERROR,
    FORCE,
    RADIUS,
    ROWS as TOTAL_ROWS,
    STIFFNESS,
    TOTAL_INDEX,
)
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.compute import KERNEL_ERROR, as_ensemble, law_of_means, warnings_of
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.node import MeanProblem
from roughmdr.expected.pull_off import ends_apart
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, unloadings
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import find_piece, series_at
from roughmdr.numerics.gauss import gauss
from roughmdr.numerics.jit import once, specialise
from roughmdr.stages.plastic.body import JUST_RISEN, LIMIT, Body, PlasticKernels, check_depth, range_warnings
from roughmdr.stages.plastic.drawn import DrawnAsperities
from roughmdr.stages.plastic.models import kernels_of
from roughmdr.stages.plastic.total import add_up, rows_of

_NODES, _WEIGHTS = (np.concatenate(each) for each in zip(gauss(24), gauss(15), strict=True))
_OF_RESULT = 24  # nodes of the first rule, which gives the result
_ORDERS = (4, 8, 16, 32, 64)
"""Scores of the rule over the radii, one after the other."""
_RTOL = 1e-7  # change of the force, over the largest, at which the rule is fine enough: kinks make it converge slowly
_DOUBT = 4.0  # error of a rule over its last change: kinks and jumps over a shape parameter make it fall slowly
_LEAST = 1e-6  # least error of such a rule: orders may agree by chance to _RTOL where laws have kinks
_JUMP = 0.08  # largest jump of a fitted law, over its force
_GROWTH = 2.0  # power of the indentation by which forces grow at most: those of cones
_HALVINGS = 60  # halvings that locate the edge of contact
_BESIDE = 1e-9  # distance over the interval at which a contact has just yielded
_MOST_DRAWN = 1000  # asperities drawn evenly to tell which yield and how models differ: to some percent of both
_CHANCE = 1e-9  # probability that an asperity is higher than where a machine begins to search
_Two = tuple[float, float]
_Flat = tuple[float, float, float]
"""Separation of the flat, the lowest so far, and its rise since [m]."""
kernel = PlasticKernels("kernel")
"""Stands for the kernels of a model in the loops."""


class _Node(NamedTuple):
    """Asperities of one radius, a fraction of all."""

    fraction: float
    heights: HeightTable
    asperity: Floats


def _touches(z: float, h: float, lowest: float, asperity: Floats, body: Body) -> bool:
    """Whether a summit of height z [m] that has yielded is in contact at h, after the flat has been at ``lowest``."""
    deepest = z - lowest
    return bool(h - lowest < kernel.ends(deepest, kernel.mark(deepest, asperity, body), asperity, body)[0])


def _edge(begin: float, top: float, h: float, lowest: float, asperity: Floats, body: Body) -> float:
    """Return the height [m] from which on contacts that yield are made, the lowest of which is lost first.

    It is ``begin`` where that is so there, and also where none is made at the ``top``: forces are 0 where none is.
    """
    low, high = begin + _BESIDE * (top - begin), top
    if kernel.touches(low, h, lowest, asperity, body) or not kernel.touches(top, h, lowest, asperity, body):
        return begin
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if kernel.touches(middle, h, lowest, asperity, body) else (middle, high)
    return high


def _interval(
    ends: _Two, flat: _Flat, heights: HeightTable, asperity: Floats, body: Body, dissipating: bool, found: Floats
) -> None:
    """Add to ``found`` the totals between two heights [m].

    ERROR takes the difference of the force by the second rule, on each piece of the table, and how much the force
    varies there, as far as it is not known where on the piece the heights are.
    """
    (begin, end), (h, lowest, risen) = ends, flat
    low, high, coefficients = heights.low, heights.high, heights.coefficients
    j, start = find_piece(high, begin), max(begin, low[0])
    while start < end and j < high.size:
        stop = min(end, high[j])
        first, last = math.sqrt(start - begin), math.sqrt(stop - begin)
        change, width = (stop - start) / (first + last), high[j] - low[j]  # narrow pieces keep their digits so
        difference, most, least = 0.0, 0.0, 0.0 if start > low[j] or stop < high[j] else math.inf
        for m in range(_NODES.size):
            beyond = 0.5 * change * (1.0 + _NODES[m])
            rise = beyond * (beyond + 2.0 * first)
            density = series_at(coefficients[j, 0], 2.0 * (start - low[j] + rise) / width - 1.0)
            weight = change * _WEIGHTS[m] * (first + beyond) * density
            y = start + rise
            deepest = y - lowest
            mark = kernel.mark(deepest, asperity, body)
            contact = kernel.state(y - h, risen, mark, asperity, body)
            least, most = min(least, contact.force), max(most, contact.force)
            difference += contact.force * (weight if m < _OF_RESULT else -weight)
            if m < _OF_RESULT:
                found[FORCE] += weight * contact.force
                found[RADIUS] += weight * contact.radius
                found[AREA] += weight * math.pi * contact.radius * contact.radius
                found[STIFFNESS] += weight * contact.stiffness
                found[COUNT] += weight if contact.radius > 0.0 else 0.0
                found[ENERGY] += weight * contact.stored
                if dissipating:
                    found[DISSIPATED] += weight * kernel.lost(deepest, mark, asperity, body)
        found[ERROR] += abs(difference) + (most - least) * heights.doubt[j, 1]
        start, j = stop, j + 1


def _mean_loop(
    separation: Floats, heights: HeightTable, asperity: Floats, body: Body, dissipating: bool, total: Floats
) -> None:
    """Add the mean over the heights of one node to the totals [row, step]; separations [m] are from their origin."""
    lowest, top, limit, lost = math.inf, heights.high[-1], asperity[LIMIT], 0.0
    unknown = heights.doubt[:, 2].sum()  # fraction whose heights are not known
    found = np.zeros(total.shape[0])
    for step in range(separation.size):
        h = separation[step]
        flat = h, min(lowest, h), max(h - lowest, 0.0 if h < lowest else JUST_RISEN)
        lowest = flat[1]
        found[:], loses = 0.0, dissipating and h == lowest
        if h < top:
            begin = max(h, lowest + limit)
            if h < begin:
                kernel.interval((h, min(begin, top)), flat, heights, asperity, body, False, found)
            if h > lowest and begin < top:
                begin = kernel.edge(begin, top, h, lowest, asperity, body)
            for kink in kernel.kinks:
                end = min(lowest + kink * limit, top)
                if begin < end:
                    kernel.interval((begin, end), flat, heights, asperity, body, loses, found)
                    begin = end
            mark = kernel.mark(top - lowest, asperity, body)
            found[ERROR] += abs(kernel.state(top - h, h - lowest, mark, asperity, body).force) * unknown
        lost = found[DISSIPATED] if loses else lost
        found[DISSIPATED] = lost
        for row in range(total.shape[0]):
            total[row, step] += found[row]


@once
def _compiled(kernels: PlasticKernels) -> PlasticKernels:
    """Return kernels with the loop that is compiled for some kernels."""
    whole = PlasticKernels(f"{kernels.__name__}_mean")
    vars(whole).update({name: part for name, part in vars(kernels).items() if not name.startswith("__")})
    for name, part in (("touches", _touches), ("edge", _edge), ("interval", _interval), ("loop", _mean_loop)):
        vars(whole)[name] = specialise(part, whole)
    return whole


class MeanAsperities:
    """The mean over asperities of a source that yield by a model, without adhesion."""

    def __init__(self, source: Source, model: str, body: Body) -> None:
        self._source, self._model, self._body = source, model, body
        self._kernels = kernels_of(model, body, source.shape_name)
        self.nominal_area = source.nominal_area
        self.order = 1  # nodes over the radii by which totals are found; ``law`` takes more where they are too few
        self._nodes = cache(self._nodes_by)  # a machine asks for them many times

    @cached_property
    def first_touch(self) -> float:
        """A separation [m] above which hardly an asperity touches."""
        return float(self._source.extremes(_CHANCE).height.max())

    @cached_property
    def depth(self) -> float:
        """A usual indentation [m]."""
        return self._source.sigma or float(self._source.extremes(_CHANCE).columns.rise[0])

    @np.errstate(all="ignore")  # numbers that no float can hold are refused at the end
    def _nodes_by(self, order: int) -> list[_Node]:
        nodes = self._source.nodes(Rule.smooth(order))
        rows = rows_of(self._kernels, nodes.parameters[self._kernels.parameter], self._body)
        tables = {heights: HeightTable.of(heights) for heights in dict.fromkeys(nodes.heights)}
        parts = zip(nodes.weights.tolist(), nodes.heights, rows, strict=True)
        return [_Node(fraction, tables[heights], row) for fraction, heights, row in parts]

    def _at_order(self, separation: Floats, rows: set[int], order: int) -> Floats:
        """Return the totals of all asperities [row, step] by a rule over the radii."""
        total, kernels, body = np.zeros((TOTAL_ROWS, separation.size)), self._kernels, self._body
        nodes, largest = self._nodes(order), np.zeros(separation.size)
        for fraction, heights, asperity in nodes:
            own, relative = np.zeros_like(total), separation - heights.origin
            if heights.all_equal:
                own = add_up(kernels, np.zeros(1), asperity[None], relative, body, rows).total
            else:
                _compiled(kernels).loop(relative, heights, asperity, body, DISSIPATED in rows, own)
                top = heights.high[-1] - float(relative.min())
                if top > 0.0 and heights.tail.fraction > 0.0:
                    mark = kernels.mark(top, asperity, body)
                    edge = kernels.state(top, 0.0, mark, asperity, body).force
                    own[ERROR] += edge * heights.tail.over_edge(_GROWTH)
            total += fraction * own
            largest = np.maximum(largest, fraction * own[FORCE])
        if all(node.heights.all_equal for node in nodes):  # the rule over radii misses up to a node next to a jump
            depth = np.array([(node.heights.origin - separation) / node.asperity[LIMIT] for node in nodes])
            for kink in {1.0, *kernels.kinks} - {math.inf} if self._model != "mdr" else ():
                total[ERROR] += _JUMP * largest * ((depth < kink).any(axis=0) & (depth > kink).any(axis=0))
        total[CONDUCTANCE] = total[RADIUS]
        return np.asarray(self._source.expected_count * total)

    def totals(self, separation: Floats, rows: set[int]) -> Floats:
        """Return totals [row, step] along separations [m]; OutOfRange where one is not representable."""
        return self._at_order(separation, rows, self.order)

    def parting(self, lowest: float) -> float:
        """Return the separation [m] at which the last contact is lost after the flat has been at ``lowest`` [m]."""
        found = [lowest]
        for _, heights, asperity in self._nodes(self.order):
            deepest = heights.origin + float(heights.high[-1]) - lowest
            if deepest > 0.0:
                mark = self._kernels.mark(deepest, asperity, self._body)
                found.append(lowest + self._kernels.ends(deepest, mark, asperity, self._body)[1])
        return max(found)

    def law(self, path: LoadingPath, names: list[str]) -> LoadSeparation:
        """Return the law along a path of the flat; OutOfRange as ``totals``, or where its error is too large."""
        separation, body = path.separation, self._body
        named = {TOTAL_INDEX[name] for name in names}
        asked = named | {FORCE, AREA, COUNT, ERROR}
        total, error = self._converged(separation, asked)
        largest, closest = float(np.abs(total[FORCE]).max()), float(separation.min())
        radii = self._largest_radii(closest)
        if not np.isfinite(total[list(asked)]).all():
            raise OutOfRange(f"the mean contact is not representable: {self._model} with {body}")
        total[ERROR] += (error[FORCE] + KERNEL_ERROR) * largest
        of_others = float(error[list(named - {STIFFNESS})].max(initial=0.0))
        warnings = warnings_of(float(total[ERROR].max()) / largest if largest > 0.0 else 0.0, of_others)
        problem = MeanProblem(self._source, path, body.effective_modulus, Adhesion(0.0), (FORCE,))
        nodes = self._source.nodes(Rule.smooth(self.order))
        limits = as_ensemble(self._source, nodes).validity_limits
        yielding = self._drawn.compared(separation)
        law = law_of_means(problem, names, total, radii, limits, JkrValidity(), yielding=yielding)
        pull_off = WITHOUT_TENSION if ends_apart(unloadings(separation, total[FORCE]), total[COUNT]) else PullOff()
        wide = range_warnings(self._kernels, radii, np.array([node.asperity for node in self._nodes(self.order)]))
        told = (*warnings, *wide, *law.warnings)
        return law._replace(warnings=told, pull_off=pull_off, yielding=lambda: self._drawn.shares(closest))

    def _converged(self, separation: Floats, rows: set[int]) -> tuple[Floats, Floats]:
        """Return totals by a rule over the radii that is fine enough, and not coarser than the last one, and the error
        of each over its largest: by the last change, or the last two where the force still changes.
        """
        fixed = self._source.node_count(2) == self._source.node_count(1)
        before, changes = None, [np.zeros(TOTAL_ROWS)]
        for order in (1,) if fixed else [order for order in _ORDERS if 4 * order >= self.order]:
            self.order = max(order, self.order)
            total = self._at_order(separation, rows, order)
            if before is not None:
                largest = np.abs(total).max(axis=1)
                changes.append(np.abs(total - before).max(axis=1) / np.where(largest > 0.0, largest, 1.0))
                if changes[-1][FORCE] <= _RTOL and order == self.order:
                    return total, np.maximum(_DOUBT * changes[-1], _LEAST)
            before = total
        return total, np.sum(changes[-2:], axis=0)

    def _largest_radii(self, closest: float) -> Floats:
        """Return the contact radius [m] of the highest summit of each node; TooMuchContact as ``check_depth``."""
        radii, deepest, nodes = list[float](), list[float](), self._nodes(self.order)
        for fraction, heights, asperity in nodes:
            highest = heights.origin if heights.all_equal else heights.highest(self._source.expected_count * fraction)
            deepest.append(highest - closest)
            mark = self._kernels.mark(deepest[-1], asperity, self._body)
            radii.append(self._kernels.state(deepest[-1], 0.0, mark, asperity, self._body).radius)
        check_depth(self._kernels, np.array(deepest), np.array([node.asperity for node in nodes]))
        return np.array(radii)

    @cached_property
    def _drawn(self) -> DrawnAsperities:
        """Asperities that are drawn evenly, which tell what yields and how much the models differ."""
        drawn = self._source.limited_to(_MOST_DRAWN).ensemble(0, 0, stratified=True)
        problem = Problem(drawn, self._body.effective_modulus, Adhesion(0.0))
        return DrawnAsperities(problem, self._model, self._body)
