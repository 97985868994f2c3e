"""How far the sum of the forces of a block can be off.

A kernel finds the state t of a contact where the indentation D, as it computes it, is z - h. The exact D(t) differs
from that by some eta, and the right state is the t* with D(t*) = z - h. So the error of the force is the error of P at
t, and |P(t) - P(t*)|. The latter is at most m |k(t)| eta, whether k grows or falls along the branch:

- Far from a fold k is nearly equal at t and t*, and m is 1.
- Next to a smooth fold P - P_c is proportional to y = t - t_c, and D - D_c to y^2, or to y^3 where two folds are about
  to meet, or to a power between. If t* lies above t, dy/dD is less there, and m is 1. If t* lies below t, it is at
  least the fold itself, and y/(D - D_c) is 2 or 3 times dy/dD at t. So m is 2 or 3, however close the fold is.
- So close to a fold that no digit of the slope of D is left, the computed |k| is of the order a/u (u is the unit
  roundoff), and eta is at least u dl (dl is the part of adhesion in D), so that |k| eta is at least the force itself.

eta consists of the roundings of z - h and of the depth, which times m are at most 4 u (|z| + |h| + depth). The
roundings of x are relative to D - D_c and negligible. Where D is computed as g - dl, the errors of g and dl, some
u (g + dl) with g = z - h + dl, are added to eta. Where the state comes from the distance to the fold they are not.
"""

import math

from roughmdr.aggregate.block import DEPTH_SCALE, FORCE_SCALE, PER_DEPTH, STIFFNESS_SCALE, Block, kernel
from roughmdr.kernels.blocks import FORCE, IN_CONTACT, RADIUS, STATE, STATE_ERROR, STIFFNESS, TERM
from roughmdr.numerics.double_double import ROUNDING
from roughmdr.numerics.jit import njit
from roughmdr.numerics.summation import BLOCK, block_minimum, sum_by_halves

_NEXT_TO_A_FOLD = 3.0  # m


def total_error(count: int, block: Block, h: float, stiffness: float, force_error: float, rounding: float) -> float:
    """Return the error [N] of ``count`` contacts whose |k| add up to ``stiffness`` [N/m].

    ``force_error`` [N] is the sum of the errors of their forces, each at its state; ``rounding`` the relative error of
    z - h as a term of the computed indentation.
    """
    deepest = block.max_scales[DEPTH_SCALE] if kernel.adhesive else 0.0
    farthest = max(abs(block.z[0]), abs(block.z[count - 1])) + abs(h) + deepest
    return float(stiffness * (4.0 * ROUNDING + _NEXT_TO_A_FOLD * rounding) * farthest + force_error)


@njit
def no_terms(t: float, params: object) -> tuple[float, float]:
    """Stand for ``term_sizes`` where no terms cancel."""
    return 0.0, 0.0


def bound_block(count: int, block: Block, h: float, retracted: bool) -> float:
    """Return a bound on the error [N] of the force of the first ``count`` asperities of a block.

    For kernels whose k grows along the branch, from -inf at the fold of a cone or a paraboloid, so that |k| is largest
    in the lowest or the highest state: two calls bound a block whose parameters are alike. Only a retraction brings a
    state below that of first touch, x = 1.
    """
    params, contacts = block.params, block.contacts
    first, terms = kernel.params_of(params, 0), contacts[TERM]
    lift = block.max_scales[DEPTH_SCALE] if kernel.adhesive else 0.0
    high = kernel.state(((block.z[0] - h) + lift) * block.max_scales[PER_DEPTH], first)
    low = high
    if kernel.adhesive:
        low = kernel.state(1.0, first)
        if retracted:
            for i in range(count):
                terms[i] = contacts[STATE, i] if contacts[IN_CONTACT, i] > 0.0 else math.inf
            low = max(min(low, block_minimum(terms, count)), ROUNDING)
    stiffness = max(abs(kernel.stiffness(low, first)), abs(kernel.stiffness(high, first)))
    least_force = 1.0 if kernel.adhesive else 0.0  # without adhesion the natural force is no force of this contact
    error = max(least_force, abs(kernel.force(high, first))) * kernel.relative_errors(first)[0]
    if not kernel.alike and kernel.heterogeneous(params):
        for i in range(count):
            own, state = kernel.params_of(params, i), contacts[STATE, i]
            stiffness = max(stiffness, abs(kernel.stiffness(max(state, low), own)))
            error = max(error, abs(kernel.force(state, own)) * kernel.relative_errors(own)[0])
    stiffness = count * stiffness * block.max_scales[STIFFNESS_SCALE]
    return kernel.total_error(count, block, h, stiffness, count * error * block.max_scales[FORCE_SCALE], 0.0)


def bound_each(count: int, block: Block, h: float, retracted: bool) -> float:
    """Return the bound where P and k were found with the state: one by one, whichever way k goes along the branch."""
    contacts, params = block.contacts, block.params
    scales, terms, stiffness = block.scales, contacts[TERM], contacts[STATE_ERROR]
    for i in range(count):
        own = kernel.params_of(params, i)
        of_force, of_indentation = kernel.relative_errors(own)
        k, force = abs(contacts[STIFFNESS, i]), abs(contacts[FORCE, i])
        each = of_force * force
        if kernel.adhesive:
            stretch, pull = kernel.adhesion_terms(contacts[RADIUS, i], own)
            k = min(k, pull / stretch / ROUNDING)  # next to the fold, where k is infinite, a bound of |k| eta
            each = of_force * (force + 2.0 * pull) + 2.0 * _NEXT_TO_A_FOLD * of_indentation * k * stretch
        if kernel.terms_cancel:
            g, size = kernel.term_sizes(contacts[STATE, i], own)
            each += of_force * size + _NEXT_TO_A_FOLD * of_indentation * k * g
        terms[i] = scales[FORCE_SCALE, i] * each if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        stiffness[i] = scales[STIFFNESS_SCALE, i] * k if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
    error = sum_by_halves(terms, count, BLOCK)
    sum_of_stiffness = sum_by_halves(stiffness, count, BLOCK)
    for i in range(count):
        of_indentation = kernel.relative_errors(kernel.params_of(params, i))[1]
        terms[i] = -of_indentation if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
    return kernel.total_error(count, block, h, sum_of_stiffness, error, -block_minimum(terms, count))
