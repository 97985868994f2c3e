"""Sums in an order that depends on the terms alone: within a block by halves, over the blocks with compensated
rounding errors (A. Neumaier, Z. angew. Math. Mech. 54 (1974) 39).

By halves, because the compiler may not reorder a running sum and so cannot make vector code of it.
"""

import math

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

BLOCK = 256


@njit
def sum_by_halves(terms: Floats, count: int, size: int) -> float:
    """Return the sum of the first ``count`` of at most ``size`` terms, a power of 2; the terms are overwritten."""
    while size > 1 and size // 2 >= count:
        size //= 2
    for i in range(count, size):
        terms[i] = 0.0
    half = size // 2
    while half > 0:
        for i in range(half):
            terms[i] += terms[i + half]
        half //= 2
    return float(terms[0])


@njit
def block_minimum(terms: Floats, count: int) -> float:
    """Return the least of the first ``count`` terms, by halves like ``sum_by_halves``; the terms are overwritten."""
    for i in range(count, BLOCK):
        terms[i] = math.inf
    half = BLOCK // 2
    while half > 0:
        for i in range(half):
            terms[i] = terms[i] if terms[i] < terms[i + half] else terms[i + half]
        half //= 2
    return float(terms[0])


@njit
def accumulate(total: float, compensation: float, term: float) -> tuple[float, float]:
    """Return ``total`` with ``term`` added, and ``compensation`` with the rounding error of that."""
    after = total + term
    error = (total - after) + term if abs(total) >= abs(term) else (term - after) + total
    return after, compensation + error


@njit
def cumulative_sum(terms: Floats) -> None:
    """Replace each term by the sum of itself and all before it."""
    total, compensation = 0.0, 0.0
    for i in range(terms.size):
        total, compensation = accumulate(total, compensation, terms[i])
        terms[i] = total + compensation
