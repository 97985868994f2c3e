"""Integrals over panels that are halved until their halves agree with them."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss, unit_gauss

Rows = NDArray[np.intp]

_ORDER = 16
# A panel is done where its halves change it by less than _RTOL of the whole integral; the error of the halves is far
# less than that change. The halvings suffice for powers x^p at an end down to p = -0.6.
_RTOL = 2e-14
_MAX_HALVINGS = 120
# A jump that no node sees lies between an end and the node next to it: it is sought at the relative distance
# _NEXT_TO_END from the ends, and located to _RTOL_JUMP of the whole.
_NEXT_TO_END = 1e-9
_RTOL_JUMP = 1e-11
# With more unfinished panels than these the integrand of an integral is noisy: the limit rises to the noise.
_NOISY_PANELS = 64


def panel_rule(edges: Floats, count: int = _ORDER) -> tuple[Floats, Floats]:
    """Return nodes and weights on the panels between ``edges``, one row a panel."""
    nodes, weights = unit_gauss(count)
    width = np.diff(edges)[:, None]
    return edges[:-1, None] + width * nodes, width * weights


def refine_edges(function: Callable[[Floats], Floats], edges: Floats) -> Floats:
    """Add ``edges`` until Gauss's rule between them is right for the running integral of a function of at least 0."""
    for _ in range(_MAX_HALVINGS):
        middles = 0.5 * (edges[:-1] + edges[1:])
        nodes, weights = panel_rule(np.sort(np.concatenate([edges, middles])))
        halves = np.sum(function(nodes) * weights, axis=1).reshape(-1, 2).sum(axis=1)
        nodes, weights = panel_rule(edges)
        change = np.abs(np.sum(function(nodes) * weights, axis=1) - halves)
        split = (change > _RTOL * np.cumsum(halves)) & (edges[:-1] < middles) & (middles < edges[1:])
        if not split.any():
            break
        edges = np.sort(np.concatenate([edges, middles[split]]))
    return edges


def running_integral(values: Floats, edges: Floats) -> Floats:
    """Return the integral from the first of ``edges`` to each node of ``panel_rule(edges)``, of the values there."""
    nodes, _ = gauss(values.shape[1])
    half = 0.5 * np.diff(edges)[:, None]
    powers = np.polynomial.legendre.legvander(nodes, len(nodes) - 1)
    primitives = np.polynomial.legendre.legint(np.eye(len(nodes)), lbnd=-1)
    inside = half * (values @ np.linalg.inv(powers).T @ np.polynomial.legendre.legval(nodes, primitives))
    whole = panel_rule(edges, len(nodes))[1] * values
    return np.asarray(np.concatenate([[0.0], np.cumsum(whole.sum(axis=1))[:-1]])[:, None] + inside)


def integrate(integrand: Callable[[Rows, Floats], Floats], edges: Floats) -> Floats:
    """Return one integral for each row of ``edges`` (rows, edges), which do not descend.

    ``integrand(rows, x)`` takes panels, one row of ``x`` each, and the number of the integral that each belongs to.
    Panels are halved until their halves agree, so that kinks, jumps and powers at their ends are found.
    """
    nodes, weights = gauss(_ORDER)
    ends = np.array([_NEXT_TO_END - 1.0, 1.0 - _NEXT_TO_END])
    vander = np.polynomial.legendre.legvander
    to_ends = vander(ends, _ORDER - 1) @ np.linalg.inv(vander(nodes, _ORDER - 1))
    points = 1.0 + np.append(nodes, ends)

    def integrate_panels(rows: Rows, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Return each panel's integral, and that of a jump between its ends and the nodes next to them."""
        half = 0.5 * (high - low)
        values = integrand(rows, low[:, None] + half[:, None] * points)
        inside = values[:, :_ORDER]
        jumps = np.abs(values[:, _ORDER:] - inside @ to_ends.T).sum(axis=1)
        return half * (inside @ weights), half * points[0] * jumps

    count = len(edges)
    rows, panel = np.nonzero(edges[:, 1:] > edges[:, :-1])
    low, high = edges[rows, panel], edges[rows, panel + 1]
    whole, _ = integrate_panels(rows, low, high)
    total, size = np.zeros(count), np.bincount(rows, np.abs(whole), count)
    rtol = _RTOL
    for _ in range(_MAX_HALVINGS):
        middle = 0.5 * (low + high)
        (left, left_jump), (right, right_jump) = (
            integrate_panels(rows, low, middle),
            integrate_panels(rows, middle, high),
        )
        size = np.maximum(size, np.bincount(rows, np.abs(left) + np.abs(right), count))
        # Values that are not finite are left to the caller.
        converged = ~(np.abs(left + right - whole) > rtol * size[rows])
        converged &= ~(left_jump + right_jump > np.maximum(rtol, _RTOL_JUMP) * size[rows])
        converged |= (middle <= low) | (middle >= high)
        total += np.bincount(rows[converged], (left + right)[converged], count)
        more = ~converged
        if not more.any():
            return total
        if np.count_nonzero(more) > _NOISY_PANELS * count:
            rtol *= 4.0
        low, high = np.concatenate([low[more], middle[more]]), np.concatenate([middle[more], high[more]])
        rows, whole = np.tile(rows[more], 2), np.concatenate([left[more], right[more]])
    return np.asarray(total + np.bincount(rows, whole, count))
