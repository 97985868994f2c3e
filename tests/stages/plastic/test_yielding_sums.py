"""Sums over contacts that yield: plain sums, elastic limits, blocks, and memory of turning points, bit for bit."""

import math
from typing import Any

import numpy as np
import pytest
from forms import large

from roughmdr.aggregate import LoadingPath, simulate
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.totals import AREA, COUNT, DISSIPATED, ENERGY, FORCE, STIFFNESS, TOTAL_INDEX
from roughmdr.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.stages.plastic.body import NO_MARK, Body
from roughmdr.stages.plastic.models import kernels_of
from roughmdr.stages.plastic.total import add_up, rows_of

E, R, STD, W = 1e9, 1e-6, 2e-8, 0.05
ALL = {FORCE, AREA, COUNT, STIFFNESS, ENERGY, DISSIPATED}
STATES = [FORCE, AREA, COUNT, STIFFNESS, ENERGY]


def body(work: float, stiff: float = 30.0) -> Body:
    return Body(E, E / stiff, work, 0.3, math.inf, 0.0)


def drawn(count: int, seed: int, of: Body) -> tuple[Any, Floats, Floats]:
    rng = np.random.default_rng(seed)
    kernels = kernels_of("mdr", of)
    height = np.sort(rng.normal(0.0, STD, count))[::-1].copy()
    return kernels, height, rows_of(kernels, R * rng.uniform(0.5, 2.0, count), of)


def wandering(rng: np.random.Generator, steps: int) -> Floats:
    """Return separations that come from far away, and rise and fall by as much as contacts stretch."""
    return np.concatenate([[6.0 * STD], np.cumsum(rng.normal(-0.1, 1.5, steps)) * STD])


def followed(kernels: Any, z: float, row: Floats, of: Body, path: Floats) -> Floats:
    """Force, area, number, stiffness and energy of one contact, and the energy it has lost, [quantity, step]."""
    joined, lowest, before, lost, found = False, math.inf, math.inf, 0.0, np.zeros((6, path.size))
    for step, h in enumerate(path.tolist()):
        deepest = max(z - lowest, 0.0)
        mark = kernels.mark(deepest, row, of) if deepest > 0.0 else NO_MARK
        made, gone = kernels.ends(deepest, mark, row, of) if deepest > 0.0 else (0.0, 0.0)
        if not joined and h < before and z - h >= deepest - made:
            joined = True
            lost -= kernels.state(deepest - made, made, mark, row, of).stored if of.work > 0.0 else 0.0
        elif joined and z - h < deepest - gone:
            joined = False
            lost += kernels.state(deepest - gone, gone, mark, row, of).stored if of.work > 0.0 else 0.0
        lowest, before = min(lowest, h), h
        deepest = max(z - lowest, 0.0)
        mark = kernels.mark(deepest, row, of)
        if joined:
            state = kernels.state(z - h, h - lowest, mark, row, of)
            number = float(state.radius > 0.0)
            found[:5, step] = state.force, math.pi * state.radius**2, number, state.stiffness, state.stored
        found[5, step] = lost + kernels.lost(deepest, mark, row, of)
    return found


@pytest.mark.few(1)
@pytest.mark.parametrize("work", [0.0, W, 10.0 * W])
def test_a_sum_is_that_of_contacts_followed_one_by_one(work: float) -> None:
    """Asperities of two blocks, each with a memory of its own."""
    of, path = body(work), wandering(np.random.default_rng(3), 60)
    kernels, height, rows = drawn(300, 1, of)
    found = add_up(kernels, height, rows, path, of, ALL).total[[*STATES, DISSIPATED]]
    exact = sum(followed(kernels, z, row, of, path) for z, row in zip(height.tolist(), rows, strict=True))
    for own, plain in zip(found, np.asarray(exact), strict=True):
        np.testing.assert_allclose(own, plain, rtol=0.0, atol=1e-12 * np.abs(plain).max())


@pytest.mark.parametrize("work", [large(0.0), W])
def test_hard_asperities_are_elastic(work: float) -> None:
    of, rng = body(work, 1e-6), np.random.default_rng(8)
    (kernels, height, rows), path = drawn(300, 4, of), wandering(rng, 40)
    names = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]
    ensemble = Ensemble("paraboloid", height, {"radius": rows[:, 0].copy()})
    along = LoadingPath.along(path, unload=False, adhesive=work > 0.0)
    elastic = simulate(Problem(ensemble, E, Adhesion(work, "jkr")), along, names).variables
    found = add_up(kernels, height, rows, path, of, ALL).total
    for name in names:
        scale = np.abs(elastic[name]).max() or 1.0
        np.testing.assert_allclose(found[TOTAL_INDEX[name]], elastic[name], rtol=0.0, atol=2e-13 * scale)


@pytest.mark.parametrize("work", [0.0, W])
def test_a_turning_point_that_is_passed_again_is_forgotten(work: float) -> None:
    """An excursion upwards from the deepest point and back leaves no trace but the energy that jumps have lost."""
    of, rng = body(work), np.random.default_rng(11)
    kernels, height, rows = drawn(30, 6, of)
    for _ in range(500):
        path = wandering(rng, 12)
        turn = int(rng.choice(np.flatnonzero(path == np.minimum.accumulate(path))))
        up = path[turn] + np.sort(rng.uniform(0.0, 8.0, 3)) * STD
        with_excursion = np.concatenate([path[: turn + 1], up, up[:2][::-1], path[turn:]])
        plain, excursion = (add_up(kernels, height, rows, way, of, ALL).total for way in (path, with_excursion))
        plain, excursion = plain[:, turn:], excursion[:, turn - path.size :]
        assert (plain[STATES, 1:] == excursion[STATES, 1:]).all()
        here = [row for row in STATES if row != STIFFNESS]  # elastic where the flat returns
        assert (plain[here, 0] == excursion[here, 0]).all()
        lost, more = plain[DISSIPATED, -1], excursion[DISSIPATED, -1]
        assert more >= lost * (1.0 - 1e-12) if work > 0.0 else more == lost
