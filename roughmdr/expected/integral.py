"""Integrals of what a contact bears over the density of its heights, step by step: two tables multiplied."""

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
# The last two coefficients of Legendre's polynomials in a product, which tell how far its integral may be off.
_LAST = np.array([(n + 0.5) * _WEIGHTS * np.polynomial.legendre.Legendre.basis(n)(_NODES) for n in (14, 15)])
_NARROW = 2.0**-5  # of the distance to where contact begins
_BETWEEN_NODES = 1.1  # times what is seen at the nodes, which stand within the ends of a piece


@njit
def evaluate(coefficients: Floats, u: Floats, out: Floats, before: Floats, earlier: Floats) -> None:
    """A Chebyshev series at all u, by C. W. Clenshaw's recurrence."""
    for i in range(u.size):
        before[i] = 0.0
        earlier[i] = 0.0
    degree = coefficients.size - 1
    while degree > 0 and coefficients[degree] == 0.0:
        degree -= 1
    for n in range(degree, 0, -1):
        c = coefficients[n]
        for i in range(u.size):
            now = 2.0 * u[i] * before[i] - earlier[i] + c
            earlier[i] = before[i]
            before[i] = now
    for i in range(u.size):
        out[i] = u[i] * before[i] - earlier[i] + coefficients[0]


@njit
def _place(edges: Floats, value: float) -> int:
    """The number of the first piece whose upper edge lies above a value."""
    low, high = 0, edges.size
    while low < high:
        middle = (low + high) // 2
        if edges[middle] > value:
            high = middle
        else:
            low = middle + 1
    return low


@njit
def _place_nodes(
    at: float, to: float, h: float, base: float, depth: float, s: Floats, z: Floats, weight: Floats, weight_of_s: Floats
) -> None:
    """Gauss's nodes over the heights from ``at`` to ``to`` [m]: s, (z - at) - (to - z), and the weights of dz and ds.

    The variable is s, in which what a contact bears is smooth. Far from where contact begins, though, the roundings of
    s are seen on pieces that are narrow beside that distance: there the variable is z.
    """
    reach = (to - h) + base * depth
    if to - at < _NARROW * reach:
        half, middle = 0.5 * (to - at), 0.5 * (to + at)
        for m in range(s.size):
            s[m] = np.sqrt(max((middle + half * _NODES[m] - h) / depth + base, 0.0))
            z[m] = (to - at) * _NODES[m]
            weight[m] = _WEIGHTS[m] * half
            weight_of_s[m] = weight[m] / (2.0 * s[m])
    else:
        low, high = np.sqrt(max((at - h) / depth + base, 0.0)), np.sqrt(max(reach / depth, 0.0))
        half, middle = 0.5 * (high - low), 0.5 * (high + low)
        for m in range(s.size):
            s[m] = middle + half * _NODES[m]
            height = h + (s[m] * s[m] - base) * depth
            z[m] = (height - at) - (to - height)
            weight_of_s[m] = _WEIGHTS[m] * half * depth
            weight[m] = weight_of_s[m] * 2.0 * s[m]


@njit
def _error(
    force: Floats, phi: Floats, weight: Floats, slack: float, slack_of_density: float, loose: float, unknown: float
) -> float:
    """How far the integral of the force over a density may be off.

    By what the rule leaves out, by how far either is off, by heights that stand anywhere between the nodes, and by
    those that may stand there or not.
    """
    off, odd, largest, mass, most, greatest = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for m in range(force.size):
        value = force[m] * phi[m] * (weight[m] / _WEIGHTS[m])
        off += _LAST[0, m] * value
        odd += _LAST[1, m] * value
        largest = max(largest, abs(value))
        mass += weight[m] * abs(phi[m])
        most += weight[m] * abs(force[m])
        greatest = max(greatest, abs(force[m]))
    tail = max(abs(off), abs(odd)) / largest if largest > 0.0 else 0.0
    spread = abs(force[-1] - force[0])
    anywhere = _BETWEEN_NODES * (loose * spread + unknown * greatest)
    return float(largest * tail**1.5 + slack * mass + slack_of_density * most + anywhere)


@njit
def integrate(
    step: NDArray[np.int64],
    rung: NDArray[np.int64],
    begin: Floats,
    end: Floats,
    separation: Floats,
    depth: float,
    lift: float,
    first: NDArray[np.int64],
    foot: Floats,
    low: Floats,
    high: Floats,
    coefficients: Floats,
    slack: Floats,
    z_low: Floats,
    z_high: Floats,
    density: Floats,
    doubt: Floats,
    rooted: int,
    total: Floats,
    error: Floats,
) -> int:
    """Add to total[row, step] what summits from ``begin`` to ``end`` [m] bear on branch ``rung``, for each interval.

    x = (z - separation)/depth + lift, in [m] but x and lift, all heights as differences to one origin. ``first``,
    ``foot`` and the four after them are a ``Curve``, the four from ``z_low`` on a ``HeightTable``. Rows are over their
    natural scales, and row ``rooted`` (-1 for none) is times 2 s; ``error`` [step] takes up how far the first row may
    be off. Returns how often the tables were evaluated.
    """
    n = _NODES.size
    s, u, phi, value, weight, weight_of_s = np.empty((6, n))
    before, earlier = np.empty(n), np.empty(n)
    pieces = 0
    for i in range(step.size):
        h, b = separation[step[i]], rung[i] - 1
        start, stop = max(begin[i], z_low[0]), min(end[i], z_high[-1])
        if not start < stop:
            continue
        base = lift - foot[b]
        k = first[b] + _place(high[first[b] : first[b + 1]], np.sqrt(max((start - h) / depth + base, 0.0)))
        k = min(k, first[b + 1] - 1)
        j = _place(z_high, start)
        at = start
        while at < stop and j < z_high.size:
            edge = h + (high[k] * high[k] - base) * depth if k < first[b + 1] - 1 else np.inf
            to = max(min(stop, z_high[j], edge), at)
            if to > at:
                _place_nodes(at, to, h, base, depth, s, u, weight, weight_of_s)
                for m in range(n):
                    u[m] = (((at - z_low[j]) - (z_high[j] - to)) + u[m]) / (z_high[j] - z_low[j])
                evaluate(density[j, 0], u, phi, before, earlier)
                for m in range(n):
                    u[m] = (2.0 * s[m] - low[k] - high[k]) / (high[k] - low[k])
                for row in range(total.shape[0]):
                    evaluate(coefficients[k, row], u, value, before, earlier)
                    measure = weight_of_s if row == rooted else weight
                    found = 0.0
                    for m in range(n):
                        found += measure[m] * value[m] * phi[m]
                    total[row, step[i]] += found
                    if row == 0:
                        # Heights of a piece on which contact begins or ends may be in contact or not.
                        cut = start > z_low[j] or stop < z_high[j]
                        unknown = doubt[j, 2] + (doubt[j, 1] if cut else 0.0)
                        error[step[i]] += _error(value, phi, weight, slack[k, 0], doubt[j, 0], doubt[j, 1], unknown)
                pieces += 1
            if edge <= to:
                k += 1
            if to == z_high[j]:
                j += 1
            at = to
    return pieces


@njit
def mass(below: Floats, z_low: Floats, z_high: Floats, density: Floats, z: float) -> float:
    """The fraction of heights below z; ``below`` [piece + 1] are those below the edges."""
    if z <= z_low[0]:
        return 0.0
    if z >= z_high[-1]:
        return float(below[-1])
    j = _place(z_high, z)
    half, middle = 0.5 * (z - z_low[j]), 0.5 * (z + z_low[j])
    u = (2.0 * (middle + half * _NODES) - z_low[j] - z_high[j]) / (z_high[j] - z_low[j])
    phi, before, earlier = np.empty_like(u), np.empty_like(u), np.empty_like(u)
    evaluate(density[j, 0], u, phi, before, earlier)
    found = 0.0
    for m in range(u.size):
        found += _WEIGHTS[m] * phi[m]
    return float(below[j] + half * found)
