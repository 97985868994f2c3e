"""The equilibrium of coupled contacts at one separation, by a semismooth Newton method with conjugate gradients.

For each asperity x + lift + U = z - h, where x > 0 carries a load P(x) (``contacts.py``), U is the displacement by all
loads and moments, and lift depends on the slopes and the curvature of U. Each step solves (1/k + G) dP = -residual
for the contacts, with the coupling of first order, that of close pairs in full: what the second order adds to it is a
few per cent, and so each step leaves a few per cent of the error. A contact that moves back and forth, as one that
opens and closes, goes to where its last two steps cross 0.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from roughmdr.interaction import close
from roughmdr.interaction.coupling import Coupling, add_moments, field_of, first_order
from roughmdr.interaction.interface import Asperities, Contacts, CoupledKernels
from roughmdr.numerics.arguments import Floats

_MAX_STEPS = 40
_RTOL = 0.03  # relative error of a Newton step
_LOST = 15, 0.05  # after so many steps one that changes so much of the load leads nowhere
_LEAST_RATIO = 0.25  # least ratio of two steps that is counted on: each step leaves a few per cent
_MOST_RATIO = 0.9  # and the largest: at rest, where only rounding is left, steps no longer fall
_REMEMBERED = 8  # steps, the largest of which is the error of loads that do not come to rest
_STIFFNESS_RTOL, _RESTART, _RESTARTS, _PROBE = 1e-6, 20, 5, 1e-5


class System(NamedTuple):
    """Asperities that are coupled, in units of the patch."""

    kernels: CoupledKernels
    asperities: Asperities
    coupling: Coupling
    tangent: Coupling
    """That of the steps, which are less accurate."""
    at: Floats
    """Positions, [asperity, 2]."""
    sides: Floats | None
    """Sides of the patch that repeats; None of a free one."""
    order: int


class State(NamedTuple):
    """Contacts, in equilibrium or not."""

    x: Floats
    contacts: Contacts
    pairs: close.Pairs
    residual: Floats
    displacement: Floats
    """Where each asperity would have to be for x = 0, over z - h."""
    lost: int
    """Number of contacts that are no discs."""
    slopes: Floats
    """Slopes of the displacement by point loads at each asperity, along x and along y; 0 to first order."""


class Equilibrium(NamedTuple):
    """The state that was found."""

    state: State
    error: float
    """About the relative error of the total load; inf where there was no equilibrium."""


def evaluate(system: System, x: Floats, separation: float, pairs: close.Pairs | None) -> State:
    """Return the contacts at x with their residuals; close pairs are looked for again where they may be others."""
    kernels, asperities, coupling = system.kernels, system.asperities, system.coupling
    contacts = Contacts(*np.zeros((len(Contacts._fields), x.size)))
    kernels.load_alone(x, asperities, contacts)
    if pairs is None or pairs.outgrown(contacts.punch):
        pairs = close.find_pairs(system.at, contacts.punch, system.sides)
    close.update_shares(pairs, contacts.punch)
    load, order = contacts.load, system.order
    field = field_of(coupling, pairs, order, load)
    lost = kernels.respond(asperities, field, contacts)
    displacement = field[0].copy()
    if order == 2:
        moments = 0.25 * contacts.second_moment, contacts.tilting * field[1], contacts.tilting * field[2]
        add_moments(coupling, pairs, moments, displacement)
    with np.errstate(invalid="ignore", divide="ignore"):
        excess = np.where(load > 0.0, contacts.second_moment / (load * contacts.punch**2), 0.0)
    close.add_contacts(pairs, contacts, excess, displacement)
    displacement = displacement + contacts.lift
    residual = x + displacement + (separation - asperities.height)
    return State(x, contacts, pairs, residual, displacement, lost, field[1:3])


def _step(system: System, state: State, values: Floats, right: Floats, rtol: float) -> Floats:
    """Return the loads dP of the contacts with (1/k + G) dP = right, 0 of all others."""
    return first_order(system.tangent, state.pairs, values, state.contacts.stiffness, right, rtol)


def _tangent(state: State) -> Floats:
    values = np.zeros(state.pairs.share.size)
    close.tangent(state.pairs, state.contacts.punch, values)
    return values


@np.errstate(all="ignore")  # a guess that no float holds is no equilibrium
def solve(system: System, x: Floats, separation: float, error: float) -> Equilibrium:
    """Return the equilibrium at a separation, from a guess of x; ``error`` is that asked for of the total load."""
    state = evaluate(system, x, separation, None)
    before, largest, taken, last = np.inf, [np.inf], np.ones_like(x), np.zeros_like(x)
    for number in range(_MAX_STEPS):
        growth = state.contacts.growth
        touching = growth > 0.0
        if not np.isfinite(state.residual).all():
            break
        if not touching.any() and not (state.residual < 0.0).any():
            return Equilibrium(state, 0.0)
        values = _tangent(state)
        change = _step(system, state, values, -state.residual, _RTOL) if touching.any() else np.zeros_like(x)
        moved = -state.residual
        if touching.any():
            potential = system.tangent.potential(change)
            close.add_tangent(state.pairs, values, change, potential)
            moved = np.where(touching, change / np.where(touching, growth, 1.0), -state.residual - potential)
        back = moved * last < 0.0
        taken = np.where(back, taken * np.abs(last) / (np.abs(last) + np.abs(moved)), np.minimum(2.0 * taken, 1.0))
        last = moved
        total = state.contacts.load.sum()
        new = evaluate(system, state.x + taken * moved, separation, state.pairs)
        made = np.maximum(np.abs(new.contacts.load - state.contacts.load), np.abs(change))
        size = float(made.sum() / max(total, new.contacts.load.sum()))
        ratio = min(max(size / before, _LEAST_RATIO), _MOST_RATIO) if number and before > 0.0 else _MOST_RATIO
        stated = size * ratio / (1.0 - ratio)
        state, before = new, size
        if number >= _LOST[0] and size > _LOST[1]:
            break
        largest = [*largest[1 - _REMEMBERED :], size]
        if stated <= error:
            return Equilibrium(state, stated)
    else:
        if max(largest) <= _LOST[1]:  # a contact that opens and closes keeps all others from rest
            return Equilibrium(state, max(largest))
    return Equilibrium(state, np.inf)


def total_stiffness(system: System, state: State, separation: float) -> float:
    """Return -dF/dh: the response of all loads to 1, by probes of the residuals, the tangent of first order before it.

    NaN where it is not found.
    """
    growth = state.contacts.growth
    touching = growth > 0.0
    if not touching.any():
        return 0.0
    values, right = _tangent(state), np.where(touching, 1.0, 0.0)
    probe = _PROBE * float(state.x.max())

    def product(load: Floats) -> Floats:
        moved = np.where(touching, load.ravel() / np.where(touching, growth, 1.0), 0.0)
        largest = float(np.abs(moved).max())
        if largest == 0.0:
            return np.zeros_like(moved)
        other = evaluate(system, state.x + probe / largest * moved, separation, state.pairs)
        return np.where(touching, (other.residual - state.residual) * (largest / probe), 0.0)

    def before(residual: Floats) -> Floats:
        return _step(system, state, values, residual.ravel(), _STIFFNESS_RTOL)

    shape = (right.size, right.size)
    whole, tangent = (LinearOperator(shape, matvec=each, dtype=np.float64) for each in (product, before))
    change, failed = gmres(whole, right, M=tangent, rtol=_STIFFNESS_RTOL, atol=0.0, restart=_RESTART, maxiter=_RESTARTS)
    return math.nan if failed else float(change.sum())
