"""Integrals over panels, refined until they settle, and functions tabulated once by Chebyshev polynomials."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

Rows = NDArray[np.intp]

_NODES = 16
# A panel is done where its halves change it by less than this part of the whole integral. The halves are far better
# than their change tells. The halvings suffice for powers x^p at an end down to p = -0.6.
_SETTLED = 2e-14
_HALVINGS = 120
# A jump that no node sees lies between an end and the node next to it: it is looked for this near to the ends, and
# followed down to this part of the whole.
_END = 1e-9
_JUMP = 1e-11
# More panels than these at work on an integral mean that its integrand is noisy: the limit rises to the noise.
_AT_WORK = 64


@cache
def gauss(count: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss and Legendre on -1 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return nodes, weights


def panels(edges: Floats, count: int = _NODES) -> tuple[Floats, Floats]:
    """Nodes and weights on the panels between ``edges``, one row a panel."""
    nodes, weights = gauss(count)
    half = 0.5 * np.diff(edges)[:, None]
    return edges[:-1, None] + half * (1.0 + nodes), half * weights


def refined(function: Callable[[Floats], Floats], edges: Floats) -> Floats:
    """``edges`` with more of them where the running integral of a function of at least 0 has not settled."""
    for _ in range(_HALVINGS):
        middles = 0.5 * (edges[:-1] + edges[1:])
        nodes, share = panels(np.sort(np.concatenate([edges, middles])))
        halves = np.sum(function(nodes) * share, axis=1).reshape(-1, 2).sum(axis=1)
        nodes, share = panels(edges)
        change = np.abs(np.sum(function(nodes) * share, axis=1) - halves)
        split = (change > _SETTLED * np.cumsum(halves)) & (edges[:-1] < middles) & (middles < edges[1:])
        if not split.any():
            break
        edges = np.sort(np.concatenate([edges, middles[split]]))
    return edges


def running(values: Floats, edges: Floats) -> Floats:
    """The integral from the first of ``edges`` to each node of ``panels(edges)``, of the values there."""
    nodes, _ = gauss(values.shape[1])
    half = 0.5 * np.diff(edges)[:, None]
    powers = np.polynomial.legendre.legvander(nodes, len(nodes) - 1)
    primitives = np.polynomial.legendre.legint(np.eye(len(nodes)), lbnd=-1)
    inside = half * (values @ np.linalg.inv(powers).T @ np.polynomial.legendre.legval(nodes, primitives))
    whole = panels(edges, len(nodes))[1] * values
    return np.asarray(np.concatenate([[0.0], np.cumsum(whole.sum(axis=1))[:-1]])[:, None] + inside)


def integrate(integrand: Callable[[Rows, Floats], Floats], edges: Floats) -> Floats:
    """One integral for each row of ``edges`` (rows, edges), which do not descend.

    ``integrand(rows, x)`` takes panels, one row of ``x`` each, and tells to which integrals they belong. A panel is
    halved until it settles, so that kinks, jumps and powers at its ends are found.
    """
    nodes, weights = gauss(_NODES)
    ends = np.array([_END - 1.0, 1.0 - _END])
    vander = np.polynomial.legendre.legvander
    to_ends = vander(ends, _NODES - 1) @ np.linalg.inv(vander(nodes, _NODES - 1))
    places = 1.0 + np.append(nodes, ends)

    def rule(rows: Rows, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """The integral over each panel, and what a jump between its ends and the nodes next to them would be worth."""
        half = 0.5 * (high - low)
        values = integrand(rows, low[:, None] + half[:, None] * places)
        inside = values[:, :_NODES]
        jumps = np.abs(values[:, _NODES:] - inside @ to_ends.T).sum(axis=1)
        return half * (inside @ weights), half * places[0] * jumps

    count = len(edges)
    rows, at = np.nonzero(edges[:, 1:] > edges[:, :-1])
    low, high = edges[rows, at], edges[rows, at + 1]
    whole, _ = rule(rows, low, high)
    total, size = np.zeros(count), np.bincount(rows, np.abs(whole), count)
    limit = _SETTLED
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        (left, doubt), (right, more_doubt) = rule(rows, low, middle), rule(rows, middle, high)
        size = np.maximum(size, np.bincount(rows, np.abs(left) + np.abs(right), count))
        # What is not finite is left to the caller.
        settled = ~(np.abs(left + right - whole) > limit * size[rows])
        settled &= ~(doubt + more_doubt > np.maximum(limit, _JUMP) * size[rows])
        settled |= (middle <= low) | (middle >= high)
        total += np.bincount(rows[settled], (left + right)[settled], count)
        more = ~settled
        if not more.any():
            return total
        if np.count_nonzero(more) > _AT_WORK * count:
            limit *= 4.0
        low, high = np.concatenate([low[more], middle[more]]), np.concatenate([middle[more], high[more]])
        rows, whole = np.tile(rows[more], 2), np.concatenate([left[more], right[more]])
    return np.asarray(total + np.bincount(rows, whole, count))


class Table(NamedTuple):
    """A smooth function between the first and the last of ``edges``, by polynomials between them; constant outside."""

    edges: Floats
    terms: Floats
    """Chebyshev coefficients, one column a panel."""

    @classmethod
    def of(cls, function: Callable[[Floats], Floats], edges: Floats, count: int = _NODES) -> "Table":
        """``function`` takes a one-dimensional array."""
        angles = np.pi * (np.arange(count) + 0.5) / count
        half = 0.5 * np.diff(edges)[:, None]
        x = edges[:-1, None] + half * (1.0 + np.cos(angles))
        values = function(x.ravel()).reshape(x.shape)
        terms = 2.0 / count * np.cos(np.arange(count)[:, None] * angles) @ values.T
        terms[0] *= 0.5
        return cls(edges, terms)

    def __call__(self, x: Floats) -> Floats:
        """The function at each x, an array of any shape."""
        at = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[at], self.edges[at + 1]
        t = np.clip((2.0 * x - low - high) / (high - low), -1.0, 1.0)
        # Clenshaw's recurrence.
        ahead, last = np.zeros_like(t), np.zeros_like(t)
        for row in self.terms[:0:-1]:
            ahead, last = row[at] + 2.0 * t * ahead - last, ahead
        return np.asarray(self.terms[0][at] + t * ahead - last)
