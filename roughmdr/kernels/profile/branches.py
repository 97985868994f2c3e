"""The state of one asperity on its branches, and the jumps between them. Notation of ``layout``."""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import COUNT, DEPTH, FOOT, FOOT_X, ONSET, TOP, TOP_X
from roughmdr.numerics.arguments import Floats


def state_on_branch(x: float, branch: float, params: Floats) -> float:
    """t at x on branch number ``branch`` = 1, 2, ..."""
    j = int(branch) - 1
    foot = params[FOOT + j]
    if x <= params[FOOT_X + j]:
        return foot
    if j == int(params[COUNT]) - 1:
        start = kernel.guess_anywhere(x, params)
        return kernel.solve_on_branch(
            x * params[DEPTH],
            start if start > foot else foot + 1e-9 * params[kernel.first_node + kernel.node_size],
            foot,
            math.inf,
            j,
            params,
        )
    top = params[TOP + j]
    if x >= params[TOP_X + j]:
        return top
    return kernel.solve_on_branch(x * params[DEPTH], 0.5 * (foot + top), foot, top, j, params)


def state(x: float, params: Floats) -> float:
    """t at x >= 0 on the branch of a slow retraction: the last that reaches so low."""
    j = int(params[COUNT])
    while j > 1 and x < params[FOOT_X + j - 1]:
        j -= 1
    return kernel.state_on_branch(x, float(j), params)


def branch(x: float, before: float, touched: bool, params: Floats) -> float:
    """The branch, 1, 2, ... or 0 for none, after a path in one direction to x from a state on branch ``before``.

    Out of contact, a path that is ``touched``, at ONSET or beyond, enters branch 1. Where a branch ends the contact
    jumps to the next.
    """
    j = int(before)
    if j == 0 and touched:
        j = 1
    while 0 < j < int(params[COUNT]) and x > params[TOP_X + j - 1]:
        j += 1
    while j > 0 and x <= params[FOOT_X + j - 1]:
        j -= 1
    return float(j)


def jump_energy(before: float, after: float, params: Floats) -> float:
    """The energy dissipated in jumps from one branch to another, each where its branch ends (unit as ``energy``)."""
    j, last, lost = int(before), int(after), 0.0
    if j == 0 and last > 0:
        first = kernel.branch(params[ONSET], 0.0, True, params)
        lost -= kernel.energy(kernel.state_on_branch(params[ONSET], first, params), params) if first > 0.0 else 0.0
        j = max(int(first), 1)  # where ``branch`` is 0 attraction begins without a jump, on branch 1
    while j < last:
        x, u = params[TOP_X + j - 1], kernel.energy(params[TOP + j - 1], params)
        j += 1
        while j < int(params[COUNT]) and x > params[TOP_X + j - 1]:
            j += 1
        lost += u - kernel.energy(kernel.state_on_branch(x, float(j), params), params)
    while j > last:
        x, u = params[FOOT_X + j - 1], kernel.energy(params[FOOT + j - 1], params)
        j -= 1
        while j > 0 and x <= params[FOOT_X + j - 1]:
            j -= 1
        lost += u - (kernel.energy(kernel.state_on_branch(x, float(j), params), params) if j > 0 else 0.0)
    return lost
