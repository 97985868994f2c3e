"""The equilibrium of the rough layer between a curved body and the half-space, at one approach.

Unknown is the separation s of each ring: s = h + f(r) + u(r), u the displacement of the half-space by p(s). Newton's
method follows a branch along the path. With adhesion branches end: there the rings move as if each were damped, ds/dt
the negative residual, until they are at rest on another branch. Rings without contact follow the others.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit
from roughmdr.stages.curved.local_law import LocalLaw

_RTOL_STEP = 1e-9  # last step over the scale of the layer: Newton's method doubles these digits
_ROUNDINGS = 64.0 * float(np.finfo(float).eps)  # rounding error of a step, over the separations
_MAX_STEPS, _MAX_HALVINGS = 60, 12
_MAX_DAMPED = 2000
_FIRST_DURATION, _GROWTH = 1.0, 2.0  # first duration of a damped step over the time constant of a ring alone; growth
_SHORT, _LONG = 1e-12, 1e3  # such durations at which a search ends: no progress, and hardly any damping
_NEARLY_LINEAR = 0.25  # allowed error of the linear prediction of a damped step, over the residual


class Half(NamedTuple):
    """The half-space and the layer on it."""

    matrix: Floats
    """Displacement by the pressure on each ring [m/Pa]: [ring, ring]."""
    law: LocalLaw

    def displacement(self, pressure: Floats) -> Floats:
        """Return the displacement [m] of each ring, summed in its order."""
        return np.asarray((self.matrix * pressure).sum(axis=1))


class State(NamedTuple):
    """The rings in equilibrium, or during a search for it."""

    s: Floats
    """Separation [m] of each ring."""
    slope: Floats
    """dp/ds [Pa/m] of each ring."""
    pressure: Floats
    """[Pa]"""
    residual: Floats
    """s - h - f - u [m]."""


def state_at(half: Half, rigid: Floats, memory: Floats, s: Floats) -> State:
    """Return the state of rings at separations s [m]; ``rigid`` [m] are those of undeformed bodies, h + f(r)."""
    pressure, slope = half.law.pressure(s, memory)
    return State(s, slope, pressure, s - rigid - half.displacement(pressure))


def equilibrium(half: Half, rigid: Floats, memory: Floats, start: Floats, before: Floats) -> State | None:
    """Return the stable equilibrium that Newton's method reaches from ``start``, or else damped rings from ``before``
    [m]; None where there is none.
    """
    tolerance = max(_RTOL_STEP * half.law.scale, _ROUNDINGS * float(np.abs(rigid).max()))
    found = _newton(half, rigid, memory, start, tolerance)
    return _damped(half, rigid, memory, before, tolerance) if found is None else found


def _newton(half: Half, rigid: Floats, memory: Floats, start: Floats, tolerance: float) -> State | None:
    """Return the equilibrium, by Newton's method with shortened steps; None where there is none, or it is unstable."""
    state = state_at(half, rigid, memory, start)
    for _ in range(_MAX_STEPS):
        step, stable = linear_response(half, state, -state.residual)
        if not np.isfinite(step).all():
            return None
        if float(np.abs(step).max()) <= tolerance:
            return state_at(half, rigid, memory, state.s + step) if stable else None
        before = float(np.abs(state.residual).max())
        for _ in range(_MAX_HALVINGS):
            trial = state_at(half, rigid, memory, state.s + step)
            if float(np.abs(trial.residual).max()) < before:
                break
            step *= 0.5
        else:
            return None
        state = trial
    return None


def _damped(half: Half, rigid: Floats, memory: Floats, start: Floats, tolerance: float) -> State | None:
    """Return the equilibrium at which damped rings come to rest: steps of the linearly implicit Euler method, as long
    as the residual stays near its linear prediction (C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508).
    """
    state, duration = state_at(half, rigid, memory, start), _FIRST_DURATION
    for _ in range(_MAX_DAMPED):
        if duration >= _LONG and (found := _newton(half, rigid, memory, state.s, tolerance)) is not None:
            return found
        if not duration > _SHORT:
            return None
        step, stable = linear_response(half, state, -state.residual, 1.0 / duration)
        trial = state_at(half, rigid, memory, state.s + step)
        off = float(np.abs(trial.residual + step / duration).max())
        if stable and off <= max(_NEARLY_LINEAR * float(np.abs(state.residual).max()), tolerance):
            state, duration = trial, duration * _GROWTH
        else:
            duration /= _GROWTH
    return None


def linear_response(half: Half, state: State, force: Floats, damping: float = 0.0) -> tuple[Floats, bool]:
    """Return x [m] from (1 + damping) x - u(dp/ds x) = ``force`` [m], and whether the determinant is positive.

    It becomes negative where a stable branch ends.
    """
    loaded = np.flatnonzero(state.slope)
    slope, among = state.slope[loaded], force[loaded]
    matrix = -half.matrix[np.ix_(loaded, loaded)] * slope
    matrix[np.diag_indices(loaded.size)] += 1.0 + damping
    stable = bool(_eliminate(matrix, among) > 0.0)
    x = (force + (half.matrix[:, loaded] * (slope * among)).sum(axis=1)) / (1.0 + damping)
    x[loaded] = among
    return x, stable


@njit
def _eliminate(matrix: Floats, x: Floats) -> float:
    """Replace x by the solution of matrix y = x, by Gauss's elimination; return the sign of the determinant, or 0.

    Libraries eliminate in an order that depends on their threads.
    """
    n, sign = x.size, 1.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if not abs(matrix[pivot, k]) > 0.0:
            x[:] = np.nan
            return 0.0
        if pivot != k:
            sign = -sign
            for j in range(k, n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            x[k], x[pivot] = x[pivot], x[k]
        if matrix[k, k] < 0.0:
            sign = -sign
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            if factor != 0.0:
                for j in range(k + 1, n):
                    matrix[i, j] -= factor * matrix[k, j]
                x[i] -= factor * x[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            x[k] -= matrix[k, j] * x[j]
        x[k] /= matrix[k, k]
    return sign
