"""The state at which the controlled quantity has a value: Newton's method on one branch. Notation of ``layout``."""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import CANCELLED, COUNT, DEPTH, FOOT, FOOT_X, LAST, LAST_X, NEAR, TENSION
from roughmdr.numerics.arguments import Floats

# Gauss's rule of five nodes, exact for a slope of ninth degree: from the middle over the length, and weights.
_INNER, _OUTER = (math.sqrt(5.0 - sign * 2.0 * math.sqrt(10.0 / 7.0)) / 6.0 for sign in (1.0, -1.0))
_MIDDLE = 64.0 / 225.0
_INNER_WEIGHT, _OUTER_WEIGHT = ((322.0 + sign * 13.0 * math.sqrt(70.0)) / 1800.0 for sign in (1.0, -1.0))
_RTOL_STEP = 1e-8  # last step over the distance to the foot, and of the value: the error left is its square
_RTOL = 1e-16  # error of a converged state, over its distance to the foot
_REACH = 64.0  # distance, over the first step, within which a kink makes the error larger than stated
_MIN_DISTANCE = 1e-3  # share of the distance to the foot that is left after a step that would go beyond it
_FREE_STEPS = 6  # Newton steps before every third is a bisection: it may not converge where the slope changes much


def control_above_fold(t: float, j: int, params: Floats) -> tuple[float, float]:
    """The controlled quantity above the lowest foot, and its slope; t on branch j."""
    value, slope = kernel.control_at(t, params)
    foot = params[FOOT + j]
    step = t - foot
    if params[TENSION] == 0.0:
        return value, slope
    lifted = value + params[DEPTH]
    far = step > params[NEAR] * t and (foot > 0.0 or lifted > CANCELLED * params[DEPTH])
    if far or kernel.kink(foot, t, params):
        return lifted, slope
    middle = foot + 0.5 * step
    inner = kernel.control_at(middle - _INNER * step, params)[1] + kernel.control_at(middle + _INNER * step, params)[1]
    outer = kernel.control_at(middle - _OUTER * step, params)[1] + kernel.control_at(middle + _OUTER * step, params)[1]
    mean = _MIDDLE * kernel.control_at(middle, params)[1] + _INNER_WEIGHT * inner + _OUTER_WEIGHT * outer
    return params[FOOT_X + j] * params[DEPTH] + step * mean, slope


def solve_on_branch(wanted: float, t: float, low: float, high: float, j: int, params: Floats) -> float:
    """The t on branch j, between low and high, with ``control_above_fold`` = ``wanted``, by Newton's method from t."""
    foot, lift = params[FOOT + j], params[DEPTH] if params[TENSION] > 0.0 else 0.0
    for i in range(200):
        value, slope = kernel.control_above_fold(t, j, params)
        if value < wanted:
            low = t
        elif value > wanted:
            high = t
        else:
            return t
        step = (value - wanted) / slope if slope > 0.0 else math.inf
        if abs(step) <= _RTOL_STEP * (t - foot) and abs(value - wanted) <= _RTOL_STEP * (wanted + lift):
            return t - step
        better = t - step
        circling = i % 3 == 2 and i > _FREE_STEPS
        if circling or not low < better < high:
            better = 0.5 * (low + high) if high < math.inf else 2.0 * t
            if 0.0 < 4.0 * low < high < math.inf:  # a step up a steep power law can be decades too long
                better = math.sqrt(low) * math.sqrt(high)
            if not low < better < high:
                return t
        t = better
    return math.nan


def newton_step(t: float, x: float, params: Floats) -> tuple[float, float, float]:
    """One step of Newton's method on the last branch under fixed grips, not below its foot: the new t, the distance
    that the old one had to the state, and dt/dx.

    That distance is the larger of the step and of the relative error of the value times the distance to the foot: on a
    steep power law the value changes much more than t.
    """
    value, slope = kernel.indentation_at(t, params)
    lift = params[DEPTH] if params[TENSION] > 0.0 else 0.0
    wanted, beyond = x * params[DEPTH], t - params[LAST]
    rest = (value + lift) - wanted
    step = rest / slope
    away = max(abs(step), abs(rest) / (wanted + lift) * beyond)
    return max(t - step, params[LAST] + _MIN_DISTANCE * beyond), away, params[DEPTH] / slope


def one_step(t: float, x: float, params: Floats) -> tuple[float, float, float]:
    """The state one step from t, a bound of its error over its distance to the foot (inf next to it), and dt/dx."""
    foot = params[LAST]
    t, away, per = kernel.newton_step(t, x, params)
    left = away / (t - foot)
    return t, left * left if (x > params[LAST_X]) & (t - foot > params[NEAR] * t) else math.inf, per


def two_steps(t: float, x: float, params: Floats) -> tuple[float, float, float]:
    """Take two steps: ``one_step``, and one on the cubic that the inverse function and its slopes at both points give.

    Its error is about the product of the squares of the distances from both; inf where there is a kink near.
    """
    foot, lift, wanted = params[LAST], params[DEPTH] if params[TENSION] > 0.0 else 0.0, x * params[DEPTH]
    value, slope = kernel.indentation_at(t, params)
    rest, per = (value + lift) - wanted, 1.0 / slope
    second = max(t - rest * per, foot + _MIN_DISTANCE * (t - foot))
    value, slope = kernel.indentation_at(second, params)
    last, per_last = (value + lift) - wanted, 1.0 / slope
    way, rise = second - t, last - rest
    share = last / rise if rise != 0.0 else 0.0
    bend = way - rise * per_last
    bend -= (1.0 - share) * ((rise * per - way) - bend)
    found = second - (last * per_last + share * share * bend)
    beyond, size = found - foot, wanted + lift
    far = max(abs(way) * size, abs(rest) * beyond)
    near = max(abs(second - found) * size, abs(last) * beyond)
    left = far * near / (size * size * beyond * beyond)
    reach = _REACH * abs(way)
    smooth = kernel.kink_between(second - reach, second + reach, params) < 1
    error = left * left if (x > params[LAST_X]) & (beyond > params[NEAR] * found) & smooth else math.inf
    return found, error, params[DEPTH] * per_last


def converged(error: float, branch: float, params: Floats) -> bool:
    """Whether a state on the last branch, with the ``error`` of a fixed number of steps, is that on ``branch``."""
    return bool((error <= _RTOL) & (branch == params[COUNT]))
