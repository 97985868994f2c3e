"""The hereditary integral over loading: J(h) = ∫ exp(-(t - s)/tau) dF along the falling separations down to h.

At constant speed v the time since s is a length over v, and J depends on the memory length v tau alone. F is
interpolated by polynomials over panels of the separation, and J is their exact integral for any memory length, without
differences that cancel. Panels narrow towards first touch, where F begins with a power of the indentation. They are
halved until halving changes nothing, or until there are too many: each summit that is touched leaves a kink.
"""

from collections.abc import Callable
from itertools import accumulate
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss

_DEGREE = 8  # degree of the polynomials; even, so that the halves of a panel share its points
_HALVINGS, _HALVINGS_BELOW = 30, 6  # halvings of the panels towards first touch, and towards the deepest point
_REACH, _NODES = 40.0, 20  # memory lengths that are integrated, exp(-40) = 4e-18; Gauss points for these
_BLOCK = 4096  # integrals whose points are in memory at a time
_FINE, _COARSE = 1e-12, 1e-9  # errors aimed at, over the largest force, with few separations and with more
_FEW, _MOST, _MOST_PER_STEP = 1024, 8192, 4  # numbers of separations: few, most, and most per step
_SLOPE = 2.0 * _DEGREE  # largest slope of an interpolation error, over that error and the width of its panel
_LEAST_WIDTH = 64.0  # least width of a panel [rounding of a separation]

Force = Callable[[Floats], tuple[Floats, float]]
"""Returns the elastic force [N] at separations [m], and its relative error."""


class Fading(NamedTuple):
    """The memory of a force: at each step it is ``long_term`` times the elastic one plus ``weights`` times J."""

    lengths: Floats
    """v tau [m] of each term."""
    weights: Floats
    """[term, step]"""
    long_term: float
    """Share of the force that does not relax."""
    force: Floats
    """Elastic force at each step [N]."""


class _Panels(NamedTuple):
    """Panels of falling separations, and the force there: [panel, point]."""

    separation: Floats
    force: Floats

    @property
    def width(self) -> Floats:
        """[m]"""
        return self.separation[:, 0] - self.separation[:, -1]

    @property
    def rounding(self) -> Floats:
        """Rounding of the separations [m]."""
        return np.asarray(np.spacing(np.abs(self.separation).max(axis=1)))

    def halved(self, chosen: NDArray[np.bool_], force: Callable[[Floats], Floats]) -> "_Panels":
        """Return the panels with the chosen ones in halves."""
        before = self.separation[chosen]
        between = 0.5 * (before[:, :-1] + before[:, 1:])
        found = force(between.ravel()).reshape(between.shape)
        parts = []
        for own, new, old in ((before, between, self.separation), (self.force[chosen], found, self.force)):
            fine = np.empty((len(own), 2 * _DEGREE + 1))
            fine[:, ::2], fine[:, 1::2] = own, new
            parts.append(np.concatenate([old[~chosen], fine[:, : _DEGREE + 1], fine[:, _DEGREE:]]))
        order = np.argsort(-parts[0][:, 0])
        return _Panels(parts[0][order], parts[1][order])


def remembered_force(force: Force, fading: Fading, at: Floats, clear: float) -> tuple[Floats, float]:
    """Return the force [N] with its memory of loading from ``clear`` down to the separations ``at`` [m], and its error.

    At ``clear``, above the lowest of them, nothing touches. The error [N] is that of the elastic force, with the change
    of the largest force by halving the panels.
    """
    relative = 0.0

    def values(separation: Floats) -> Floats:
        nonlocal relative
        found, error = force(separation)
        relative = max(relative, error)
        return found

    panels, change = _graded(values, clear, float(at.min())), np.inf
    result = _remember(panels, fading, at)
    while True:
        largest, count = float(np.abs(result).max()), panels.force.size
        roundings = _roundings(panels, relative)
        off = _deviations(panels, fading, roundings)
        aim = max(_FINE if count <= _FEW else _COARSE, relative) * largest
        chosen = _worth_halving(panels, off, 0.5 * aim)
        error = float(off[~chosen].sum()) + min(change, float(off[chosen].sum()))
        if error <= aim or not chosen.any() or count > max(_MOST, _MOST_PER_STEP * at.size):
            return result, error + _noise(panels, fading, roundings)
        panels = panels.halved(chosen, values)
        before, result = result, _remember(panels, fading, at)
        change = float(np.abs(result - before).max())


def _graded(force: Callable[[Floats], Floats], clear: float, lowest: float) -> _Panels:
    """Return panels from ``clear`` down to ``lowest`` [m], halved again and again towards either end."""
    part = (clear - lowest) * 0.5 ** np.arange(1, _HALVINGS + 1)
    edges = np.concatenate([[clear], clear - part[::-1], lowest + part[1:_HALVINGS_BELOW], [lowest]])
    edges = edges[np.concatenate([[True], np.diff(np.minimum.accumulate(edges)) < 0.0])]
    separation = np.linspace(edges[:-1], edges[1:], _DEGREE + 1, axis=1)
    return _Panels(separation, force(separation.ravel()).reshape(separation.shape))


def _remember(panels: _Panels, fading: Fading, at: Floats) -> Floats:
    """Return the force with its memory at the separations ``at`` [m]."""
    slopes = _slopes(panels.force)
    starts, width = panels.separation[:, 0], panels.width
    panel = np.clip(np.searchsorted(-starts, -at, side="right") - 1, 0, starts.size - 1)
    depth = np.clip((starts[panel] - at) / width[panel], 0.0, 1.0)
    # Without fading J is the force itself.
    missed = fading.force - panels.force[panel, 0] - _faded(slopes[panel], depth, np.zeros_like(depth))
    result = fading.long_term * fading.force
    for length, weight in zip(fading.lengths, fading.weights, strict=True):
        decay = _decays(width, length)
        before = _carried(np.exp(-decay), _faded(slopes, np.ones_like(width), decay))
        own = _faded(slopes[panel], depth, decay[panel])
        result = result + weight * (np.exp(-depth * decay[panel]) * (before[:-1][panel] + missed) + own)
    return result


def _decays(width: Floats, length: float) -> Floats:
    """Return widths over a memory length, limited to what a float holds."""
    with np.errstate(divide="ignore", over="ignore"):
        return np.minimum(width / length, np.finfo(float).max)


def _carried(kept: Floats, added: Floats) -> Floats:
    """Return the memory at all edges: each panel keeps a share of it and adds to it."""
    steps = zip(kept.tolist(), added.tolist(), strict=True)
    return np.array(list(accumulate(steps, lambda before, step: step[0] * before + step[1], initial=0.0)))


def _faded(slopes: Floats, depth: Floats, decay: Floats) -> Floats:
    """Return ∫_0^depth exp(-decay (depth - u)) q'(u) du for polynomials q on 0 to 1 with these slopes."""
    nodes, weights = (each[:, None] for each in unit_gauss(_NODES))
    parts = []
    for first in range(0, depth.size, _BLOCK):
        some = slice(first, first + _BLOCK)
        with np.errstate(divide="ignore"):
            back = np.minimum(depth[some], _REACH / decay[some])
        x = _DEGREE * (depth[some] - back * nodes - 0.5)
        slope = np.zeros_like(x)
        for coefficient in slopes[some].T:
            slope = slope * x + coefficient
        parts.append(_DEGREE * back * (weights * np.exp(-decay[some] * back * nodes) * slope).sum(axis=0))
    return np.concatenate(parts)


def _slopes(values: Floats) -> Floats:
    """Return the coefficients of the slopes of the interpolating polynomials, highest power of the point number first.

    Points are numbered from the middle.
    """
    numbers = np.arange(_DEGREE + 1) - _DEGREE // 2
    slopes = np.zeros((len(values), _DEGREE))
    for number, column in zip(numbers, (values - values[:, _DEGREE // 2, None]).T, strict=True):
        others = numbers[numbers != number]
        slopes += np.polyder(np.poly(others) / np.prod(number - others)) * column[:, None]
    return slopes


def _worth_halving(panels: _Panels, off: Floats, allowed: float) -> NDArray[np.bool_]:
    """Return which panels to halve, so that all others together have an allowed error of the force [N]."""
    order = np.argsort(off)
    chosen = np.zeros(off.size, dtype=bool)
    chosen[order] = np.cumsum(off[order]) > allowed
    return np.asarray(chosen & (panels.width > _LEAST_WIDTH * panels.rounding))


def _roundings(panels: _Panels, relative: float) -> Floats:
    """Return the error [N] of each panel by that of its forces, and by roundings of its separations."""
    steepness = (panels.force[:, -1] - panels.force[:, 0]) / panels.width
    return np.asarray(relative * panels.force[:, -1] + steepness * panels.rounding)


def _deviations(panels: _Panels, fading: Fading, roundings: Floats) -> Floats:
    """Return a bound on the error of the force [N] by each panel, beyond roundings.

    It is the error, in the middle, of a polynomial without the point there.
    """
    signs = [(-1) ** number * comb(_DEGREE, number) for number in range(_DEGREE + 1)]
    difference = np.abs((panels.force * signs).sum(axis=1))
    off = np.maximum(difference / comb(_DEGREE, _DEGREE // 2) - 2.0 * roundings, 0.0)
    total = np.zeros_like(off)
    for length, weight in zip(fading.lengths, fading.weights.max(axis=1), strict=True):
        decay = _decays(panels.width, length)
        total -= weight * off * np.expm1(-decay) * _slope_limit(decay)
    return np.asarray(total)


def _slope_limit(decay: Floats) -> Floats:
    """Return the largest share of an error of the force that is remembered, since its slope is limited over a panel."""
    with np.errstate(divide="ignore"):
        return np.minimum(1.0, _SLOPE / decay)


def _noise(panels: _Panels, fading: Fading, roundings: Floats) -> float:
    """Return the error of the force with its memory [N] by those of the panels."""
    total = np.zeros_like(roundings)
    for length, weight in zip(fading.lengths, fading.weights.max(axis=1), strict=True):
        decay = _decays(panels.width, length)
        own = roundings * _slope_limit(decay)
        total += weight * (own + _carried(np.exp(-decay), -np.expm1(-decay) * own)[1:])
    return float(total.max() + fading.long_term * roundings.max())
