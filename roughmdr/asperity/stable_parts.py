"""The parts of a branch, stable under fixed grips, that are stable on a machine: where weight + compliance k > 0.

k goes to -inf at the folds of fixed grips, and in between it may have more than one extreme. So k is evaluated on a
fine grid of states, its extremes are refined where they decide, and its sign changes are solved for.
"""

import math
from collections.abc import Callable

import numpy as np

from roughmdr.asperity.approach import Branch
from roughmdr.asperity.contact import DEAD_LOAD, Contact, prepared
from roughmdr.errors import OutOfRange
from roughmdr.kernels.profile.layout import COUNT, LAST, UNIT
from roughmdr.loading.machine import Machine
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.power_profiles import profile_of

_Firmness = Callable[[Floats], Floats]
"""weight + compliance k at distances from the foot."""

_NEAREST, _BEYOND = 1e-9, 4.0  # distances from the foot at which the grid begins and ends, over that of dead load
_POINTS = 240
_RTOL_EXTREME = 1e-7  # error of the state of an extreme, over its bracket; the value there is right to the square
_REGULAR = 1e-2  # relative change of k next to a foot that is a corner, not a fold
_LEAST, _ROUNDING = 1e-300, 2.0**-44  # least distance from a fold, absolute and over its state: nearer, k has no digits


def stable_parts(contact: Contact, machine: Machine, branch: Branch) -> list[Branch]:
    """Return the parts of a branch on which the contact is stable on the machine, outwards.

    OutOfRange where the branch under dead load is not representable.
    """
    if contact.shape.pinned or not contact.kernels.adhesive:
        return [branch]
    foot, top = branch
    end = top - foot if top < math.inf else _BEYOND * (_last_under_load(contact) - foot)
    if not end > 0.0:  # at a corner that is stable under dead load
        return [branch]

    def firmness(beyond: Floats) -> Floats:
        with np.errstate(all="ignore"):
            return machine.slope(contact.radius_force_stiffness(foot + beyond)[2])

    grid = _grid(contact, branch, end)
    values = firmness(grid)
    grid, values = _with_extremes(grid, values, firmness)
    if _is_regular(contact, branch, float(grid[0])):
        grid, values = np.append(0.0, grid), np.append(firmness(np.zeros(1)), values)
    elif values[0] > 0.0:
        nearer = _first_below(float(grid[0]), foot, firmness)
        grid, values = np.append(nearer, grid), np.append(firmness(np.array([nearer])), values)
    stable = values > 0.0
    bounds = [float(grid[0])] if stable[0] else []
    for i in np.flatnonzero(stable[1:] != stable[:-1]):
        bounds.append(_sign_change(float(grid[i]), float(grid[i + 1]), firmness))
    ends = [foot + bound for bound in bounds]
    if len(ends) % 2:
        ends.append(top)
    return [Branch(low, high) for low, high in zip(ends[::2], ends[1::2], strict=True)]


def _last_under_load(contact: Contact) -> float:
    """Return the state beyond which k > 0 for good."""
    kernels = contact.kernels
    if not kernels.iterative:
        return float(kernels.state_of_force(0.0, contact.params))
    params = prepared(kernels, contact.shape, contact.effective_modulus, contact.adhesion, DEAD_LOAD)
    if params[COUNT] == 0.0:
        raise OutOfRange(
            f"the branches under dead load are not representable: effective modulus {contact.effective_modulus:g} Pa, "
            f"{contact.adhesion}, {contact.shape}"
        )
    return float(params[LAST])


def _grid(contact: Contact, branch: Branch, end: float) -> Floats:
    """Return distances from the foot, dense at both ends of a branch, and near states where k may have an extreme."""
    near = np.geomspace(_NEAREST * end, end, _POINTS)
    points = [near, np.linspace(0.0, end, _POINTS)[1:]]
    if branch.top < math.inf:
        points = [near[near < 0.5 * end], (end - near)[near <= 0.5 * end], points[1][:-1]]
    elif contact.kernels.iterative:
        marks = _marks(contact) - branch.foot
        points.append(marks[(marks > near[0]) & (marks < end)])
    return np.unique(np.concatenate(points))


def _marks(contact: Contact) -> Floats:
    """Return the states at which the profile turns softer or stiffer, or is not smooth."""
    profile, params = profile_of(type(contact.shape)), contact.params
    t = [mark for i in range(profile.softening_count(params)) for mark in profile.softening_interval(i, params)]
    breaks = [profile.breakpoint(i, params)[0] for i in range(profile.breakpoint_count(params))]
    t += [profile.t_of_radius(radius, 1.0, params) for radius in breaks if radius > 0.0]
    states = np.array(t, dtype=np.float64)
    if not contact.kernels.cohesive:
        return states
    begin = 2.0 if contact.shape.flat else 1.0
    return np.concatenate([[1.0, begin], begin + states / params[UNIT]])


def _with_extremes(grid: Floats, values: Floats, firmness: _Firmness) -> tuple[Floats, Floats]:
    """Add to a grid the extremes that change the sign between its points."""
    from scipy.optimize import minimize_scalar

    added = []
    for sign in (1.0, -1.0):
        lowest = sign * values
        hidden = (lowest[1:-1] > 0.0) & (lowest[1:-1] <= lowest[:-2]) & (lowest[1:-1] <= lowest[2:])
        for i in np.flatnonzero(hidden):
            low, high = float(grid[i]), float(grid[i + 2])
            found = minimize_scalar(
                lambda beyond, sign=sign: sign * float(firmness(np.array([beyond]))[0]),
                bounds=(low, high),
                method="bounded",
                options={"xatol": _RTOL_EXTREME * (high - low)},
            )
            if found.fun <= 0.0:
                added.append(float(found.x))
    if not added:
        return grid, values
    extremes = np.array(added)
    order = np.argsort(everywhere := np.concatenate([grid, extremes]), kind="stable")
    return everywhere[order], np.concatenate([values, firmness(extremes)])[order]


def _is_regular(contact: Contact, branch: Branch, near: float) -> bool:
    """Return whether k is finite at the foot: at a corner, or where attraction begins without a jump."""
    if contact.kernels.cohesive and branch.foot == 0.0:
        return True
    with np.errstate(all="ignore"):
        at, beside = contact.radius_force_stiffness(branch.foot + np.array([0.0, near]))[2]
        return bool(abs(at - beside) <= _REGULAR * abs(beside))


def _first_below(near: float, foot: float, firmness: _Firmness) -> float:
    """Return a distance from a fold where the contact is not stable, or the least at which k has digits."""
    least = max(_LEAST, _ROUNDING * abs(foot))
    while near > least:
        near = max(0.25 * near, least)
        if not firmness(np.array([near]))[0] > 0.0:
            break
    return near


def _sign_change(low: float, high: float, firmness: _Firmness) -> float:
    """Return where the firmness changes its sign between two distances, next to 0 by halves of their logarithm."""
    from scipy.optimize import brentq

    def at(beyond: float) -> float:
        return float(np.clip(firmness(np.array([beyond]))[0], -1e300, 1e300))

    return float(brentq(at, low, high, xtol=1e-300, rtol=4.0 * np.finfo(float).eps, maxiter=2000))
