"""The sum over asperities that yield, along separations that come from far away.

All that a contact remembers is its deepest indentation, which the lowest separation so far tells for all, and with
adhesion whether it is joined to the flat. So each asperity is followed step by step.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.loop import count_above
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
)
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit, once, specialise
from roughmdr.numerics.summation import BLOCK, accumulate, sum_by_halves
from roughmdr.stages.plastic.body import (
    JUST_RISEN,
    RADIUS as OWN_RADIUS,
    ROWS,
    Body,
    Mark,
    PlasticKernels,
    State,
    fill_elastic,
)

_KERNEL_ERROR = 1e-13  # error of a force over 2 E* a times the deepest indentation, as tested
_ROUNDING = 2.0**-52  # relative error of an indentation, over height and separation
kernel = PlasticKernels("kernel")
"""Stands for the kernels of a model in ``_loop``."""
_compiled = once(specialise)


class Sum(NamedTuple):
    """Totals along separations."""

    total: Floats
    """[row, step] in SI."""
    closest: Floats
    """Contact radius [m] and force [N] of each asperity where the flat is lowest, [2, asperity]."""


@njit
def _add(wanted: NDArray[np.bool_], total: Floats, compensation: Floats, step: int, terms: Floats, count: int) -> None:
    """Add the first ``count`` terms of each row that is wanted."""
    for row in range(TOTAL_ROWS):
        if wanted[row] and count > 0:
            term = sum_by_halves(terms[row], count, BLOCK)
            total[row, step], compensation[row, step] = accumulate(total[row, step], compensation[row, step], term)


def _loop(
    height: Floats,
    rows: Floats,
    separation: Floats,
    body: Body,
    wanted: NDArray[np.bool_],
    total: Floats,
    compensation: Floats,
    closest: Floats,
) -> None:
    """Add all asperities, of descending height [m], to the totals that are wanted; ``rows`` are numbers of each."""
    turn = np.argmin(separation)
    terms, remembered, elastic = np.zeros((TOTAL_ROWS, BLOCK)), np.zeros((8, BLOCK)), np.empty((4, BLOCK))
    joined, jumped, flowed, made, loss, first, second, third = remembered
    for start in range(0, height.size, BLOCK):
        z, lowest, above, turned = height[start : min(start + BLOCK, height.size)], math.inf, math.inf, True
        remembered[:] = 0.0
        for step in range(separation.size):
            h, deeper = separation[step], separation[step] < lowest
            before, lowest, falls, above = lowest, min(lowest, h), h < above, h
            count = count_above(z, lowest)
            some = count if kernel.adhesive and kernel.round else 0  # others cost less one by one
            fill_elastic(z[:some], h, rows[start : start + some], body, elastic)
            for i in range(count):
                asperity, deepest = rows[start + i], z[i] - lowest
                mark, rise = Mark(first[i], second[i], third[i]), max(h - lowest, 0.0 if deeper else JUST_RISEN)
                if deeper:
                    if kernel.adhesive and joined[i] == 0.0:  # it joins on the way down, where it was made last
                        last = max(z[i] - before, 0.0) - made[i]
                        jumped[i] -= kernel.state(last, made[i], mark, asperity, body).stored
                    mark = kernel.mark(deepest, asperity, body)
                    first[i], second[i], third[i] = mark.first, mark.second, mark.third
                    if wanted[DISSIPATED]:
                        flowed[i] = kernel.lost(deepest, mark, asperity, body)
                    joined[i] = 1.0
                elif kernel.adhesive:
                    if not turned:
                        made[i], loss[i] = kernel.ends(deepest, mark, asperity, body)
                    if joined[i] == 0.0 and falls and rise <= made[i]:
                        jumped[i] -= kernel.state(deepest - made[i], made[i], mark, asperity, body).stored
                        joined[i] = 1.0
                    elif joined[i] > 0.0 and rise > loss[i]:
                        jumped[i] += kernel.state(deepest - loss[i], loss[i], mark, asperity, body).stored
                        joined[i] = 0.0
                contact = State(0.0, 0.0, 0.0, 0.0)
                if (joined[i] > 0.0) if kernel.adhesive else z[i] > h:
                    alone = not (kernel.adhesive and kernel.round) or mark.first > 0.0
                    other = State(elastic[0, i], elastic[1, i], elastic[2, i], elastic[3, i])
                    contact = kernel.state(z[i] - h, rise, mark, asperity, body) if alone else other
                if step == turn:
                    closest[0, start + i], closest[1, start + i] = contact.radius, contact.force
                slope = 2.0 * body.effective_modulus * contact.radius
                terms[FORCE, i], terms[RADIUS, i] = contact.force, contact.radius
                terms[AREA, i] = math.pi * contact.radius * contact.radius
                terms[STIFFNESS, i], terms[ENERGY, i] = contact.stiffness, contact.stored
                terms[COUNT, i] = 1.0 if contact.radius > 0.0 else 0.0
                terms[ERROR, i] = slope * (_KERNEL_ERROR * deepest + _ROUNDING * (abs(z[i]) + abs(h)))
                terms[DISSIPATED, i] = jumped[i] + flowed[i]
            turned = not deeper
            _add(wanted, total, compensation, step, terms, count)


def _parting_loop(height: Floats, rows: Floats, lowest: float, body: Body, separation: Floats) -> None:
    """Fill in where each contact is lost after the flat has been at ``lowest`` [m]; untouched ones at their height."""
    for i in range(height.size):
        deepest, separation[i] = height[i] - lowest, height[i]
        if deepest > 0.0:
            mark = kernel.mark(deepest, rows[i], body)
            separation[i] = lowest + kernel.ends(deepest, mark, rows[i], body)[1]


def _rows_loop(rows: Floats, body: Body) -> None:
    """Fill in the numbers of each asperity behind its radius."""
    for asperity in rows:
        kernel.prepare(asperity, body)


def rows_of(kernels: PlasticKernels, parameter: Floats, body: Body) -> Floats:
    """Return the numbers of each asperity, [asperity, row], from its ``kernels.parameter``."""
    rows = np.zeros((parameter.size, ROWS))
    rows[:, OWN_RADIUS] = parameter
    with np.errstate(all="ignore"):  # numbers that no float holds are refused with the totals
        _compiled(_rows_loop, kernels)(rows, body)
    return rows


def add_up(
    kernels: PlasticKernels, height: Floats, rows: Floats, separation: Floats, body: Body, wanted: set[int]
) -> Sum:
    """Return the totals along separations [m]; height [m] descends; OutOfRange where one is not representable."""
    asked = np.zeros(TOTAL_ROWS, dtype=np.bool_)
    asked[list(wanted)] = True
    asked[RADIUS] |= asked[CONDUCTANCE]
    found = np.zeros((TOTAL_ROWS, separation.size))
    compensation, closest = np.zeros_like(found), np.zeros((2, height.size))
    _compiled(_loop, kernels)(height, rows, separation, body, asked, found, compensation, closest)
    found += compensation
    if asked[CONDUCTANCE]:
        found[CONDUCTANCE] = found[RADIUS]
    if not np.isfinite(found).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {kernels.__name__} with {body}, separation down to "
            f"{separation.min():g} m"
        )
    return Sum(found, closest)


def partings(kernels: PlasticKernels, height: Floats, rows: Floats, lowest: float, body: Body) -> Floats:
    """Return the separation [m] at which each contact is lost after the flat has been at ``lowest`` [m]."""
    separation = np.empty_like(height)
    _compiled(_parting_loop, kernels)(height, rows, lowest, body, separation)
    return separation
