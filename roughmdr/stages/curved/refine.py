"""Refinement of rings, until the force no longer changes, and of tables, until they are as deep as the rings come."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import STIFFNESS
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import OutOfRange
from roughmdr.expected.converge import FIRST_ORDER, converge
from roughmdr.expected.node import MeanProblem, set_up
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.stages.curved.bulk import displacement_matrix
from roughmdr.stages.curved.equilibrium import Half
from roughmdr.stages.curved.follow import Body, Place
from roughmdr.stages.curved.local_law import ROWS, LocalLaw
from roughmdr.stages.curved.rings import Rings

_FIRST_ELEMENTS, _GRADING = 16, 1.5  # equal steps of radius^(1/grading): a light contact is small
_AT_AN_END = 1e-6  # distance of a negligible kink from the axis or the last ring, over the last radius
_MAX_ELEMENTS = 256  # with more of them a step takes a second
_MAX_PASSES = 16
_RULE_STEPS = 32  # steps of the path for which the rule over the shape parameters is chosen
_ROWS_OF_RULE = tuple(sorted(ROWS, key=lambda row: row == STIFFNESS))  # stiffness last: its error is not judged
_DEEPER, _WIDER = 2.0, 1.25  # factors on the depth of tables, and on the last radius, where they do not suffice
_MAX_TRIALS = 60
_NO_PRESSURE = 1e-12  # pressure over the largest that counts as none


class Layer(NamedTuple):
    """The asperities between the bodies, and how they stick and yield."""

    source: Source
    effective_modulus: float
    """E* [Pa], of the asperities and of the half-space."""
    adhesion: Adhesion


class Solution(NamedTuple):
    """The rings along a path."""

    body: Body
    places: list[Place]
    error: float
    """Change of the force by the last refinement of the rings or, where it is larger, the estimated error of elements
    that were not refined, over the largest force."""
    rule_error: float
    """Error of the rule over the shape parameters, over the pressure at the closest separation of the tables."""


def solve(layer: Layer, shape: Shape, separation: Floats, error: float) -> Solution:
    """Return the rings under a body of this shape along a path of its apex [m], refined to ``error`` if possible.

    OutOfRange where there is no equilibrium, where the body ends within the contact, or where no float holds it.
    """
    source, adhesive = layer.source, layer.adhesion.work > 0.0
    scale = min(heights.scale for heights in source.nodes(Rule.smooth(FIRST_ORDER)).heights)
    density = source.expected_count / (source.nominal_area or math.nan)
    hysteretic = adhesive and bool((np.diff(separation) > 0.0).any())
    closest, margin = float(separation.min()), scale if adhesive else 0.0
    for _ in range(_MAX_TRIALS):
        deepest = closest - margin
        some = np.linspace(max(float(separation.max()), deepest + scale), deepest, _RULE_STEPS)
        path = LoadingPath.along(some, unload=hysteretic, adhesive=adhesive)
        problem = MeanProblem(source, path, layer.effective_modulus, layer.adhesion, _ROWS_OF_RULE)
        rule = converge(problem, None, dissipating=False)
        nodes = set_up(problem._replace(rows=ROWS), *rule.rules, shared=False)
        law = LocalLaw.of(nodes, density, scale, deepest)
        body, places, change = _on_wide_rings(law, shape, layer.effective_modulus, separation, error)
        if not adhesive or min(float(place.state.s.min()) for place in places) >= deepest:
            return Solution(body, places, change, rule.error)
        margin *= _DEEPER
    raise OutOfRange("the adhesion of the layer draws the half-space up without end")


def _on_wide_rings(
    law: LocalLaw, shape: Shape, effective_modulus: float, separation: Floats, error: float
) -> tuple[Body, list[Place], float]:
    """Return the solution on rings that reach beyond the contact, or to the end of the body."""
    height = law.highest + law.range - float(separation.min())
    height = max(height, law.scale)
    for _ in range(_MAX_TRIALS):
        last = _radius_at(shape, height)
        body, places, change = _refined(law, shape, effective_modulus, separation, last, error)
        pressure = np.abs([place.state.pressure for place in places])
        within = bool((pressure[:, -1] > _NO_PRESSURE * pressure.max()).any())
        if not within or shape.pinned:
            return body, places, change
        if last >= shape.limit:
            raise OutOfRange(f"the nominal contact reaches the end of the {shape.name} at a radius of {last:g} m")
        height *= _WIDER
    raise OutOfRange("the adhesion of the layer spreads the nominal contact without end")


def _refined(
    law: LocalLaw, shape: Shape, effective_modulus: float, separation: Floats, last: float, error: float
) -> tuple[Body, list[Place], float]:
    """Return the solution on rings up to the radius ``last`` [m], halved where the pressure needs it."""
    rings = Rings.between(_first_ends(shape, last))
    before, change, doubt_left = np.zeros(0), math.inf, 0.0
    for _ in range(_MAX_PASSES):
        body = Body(rings, shape.f(rings.radius), Half(displacement_matrix(rings, effective_modulus), law))
        places = body.along(separation)
        force, pressure = body.force(places), np.array([place.state.pressure for place in places])
        largest = float(np.abs(force).max())
        if before.size:
            change = float(np.abs(force - before).max()) / largest if largest > 0.0 else 0.0
        if change <= error:
            break
        before, elements = force, rings.ends.size - 1
        doubt = rings.doubt(pressure)
        chosen = elements * doubt.max(axis=0) > error * largest
        chosen |= not chosen.any()
        if elements + int(chosen.sum()) > _MAX_ELEMENTS:
            break
        doubt_left = 0.0 if chosen.all() else float(doubt[:, ~chosen].sum(axis=1).max()) / largest
        rings = rings.halved(chosen)
    return body, places, max(change, doubt_left)


def _first_ends(shape: Shape, last: float) -> Floats:
    """Return the ends [m] of the first elements, kinks of the profile among them: there the pressure has kinks too."""
    ends = np.asarray(last * (np.arange(_FIRST_ELEMENTS + 1) / _FIRST_ELEMENTS) ** _GRADING)
    for radius in shape.breakpoints.tolist():
        if _AT_AN_END * last < radius < (1.0 - _AT_AN_END) * last:
            ends[1 + int(np.abs(ends[1:-1] - radius).argmin())] = radius
    return ends


def _radius_at(shape: Shape, height: float) -> float:
    """Return the radius [m] at which the profile has this height [m], or at which it ends."""
    if math.isfinite(shape.limit) and float(shape.f(shape.limit)) <= height:
        return shape.limit
    low, high = 0.0, shape.limit if math.isfinite(shape.limit) else height
    while float(shape.f(high)) < height:
        low, high = high, 2.0 * high
    while high - low > 1e-3 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(shape.f(middle)) < height else (low, middle)
    return high
