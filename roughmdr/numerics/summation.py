"""Adding up in an order that depends on nothing but the terms: within a block by halves, over the blocks with the
rounding errors carried along (A. Neumaier, Z. angew. Math. Mech. 54 (1974) 39).

Halves, since a running sum may not be reordered and so never becomes vector code.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

BLOCK = 256


@njit
def add_up(terms: Floats, count: int) -> float:
    """The sum of the first ``count`` terms, by halves over the whole block; the terms are spoilt."""
    for i in range(count, BLOCK):
        terms[i] = 0.0
    half = BLOCK // 2
    while half > 0:
        for i in range(half):
            terms[i] += terms[i + half]
        half //= 2
    return float(terms[0])


@njit
def least(terms: Floats, count: int) -> float:
    """The least of the first ``count`` terms, by halves like ``add_up``; the terms are spoilt."""
    for i in range(count, BLOCK):
        terms[i] = math.inf
    half = BLOCK // 2
    while half > 0:
        for i in range(half):
            terms[i] = terms[i] if terms[i] < terms[i + half] else terms[i + half]
        half //= 2
    return float(terms[0])


@njit
def accumulate(total: Floats, carried: Floats, step: int, term: float) -> None:
    """total[step] += term, with the rounding error added to carried[step]."""
    before = total[step]
    after = before + term
    if abs(before) >= abs(term):
        carried[step] += (before - after) + term
    else:
        carried[step] += (term - after) + before
    total[step] = after


@njit
def run_on(terms: Floats) -> None:
    """Each term becomes the sum of itself and all before it."""
    total, carried = np.zeros(1), np.zeros(1)
    for i in range(terms.size):
        accumulate(total, carried, 0, terms[i])
        terms[i] = total[0] + carried[0]
