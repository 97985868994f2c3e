"""Gauss-Legendre rules, each computed once; read-only, and constants where a compiled function uses one as a global."""

from functools import cache

import numpy as np

from roughmdr.numerics.arguments import Floats


def _read_only(*arrays: Floats) -> tuple[Floats, ...]:
    for array in arrays:
        array.flags.writeable = False
    return arrays


@cache
def gauss(count: int) -> tuple[Floats, Floats]:
    """Return nodes and weights on -1 to 1."""
    nodes, weights = _read_only(*np.polynomial.legendre.leggauss(count))
    return nodes, weights


@cache
def unit_gauss(count: int) -> tuple[Floats, Floats]:
    """Return nodes and weights on 0 to 1."""
    nodes, weights = gauss(count)
    unit_nodes, unit_weights = _read_only(0.5 * (1.0 + nodes), 0.5 * weights)
    return unit_nodes, unit_weights


@cache
def last_coefficients(count: int) -> Floats:
    """Return the two rows that turn values at the nodes into the last two coefficients of their Legendre series.

    Their size shows the error of the rule.
    """
    nodes, weights = gauss(count)
    basis = np.polynomial.legendre.Legendre.basis
    (rows,) = _read_only(np.array([(n + 0.5) * weights * basis(n)(nodes) for n in (count - 2, count - 1)]))
    return rows
