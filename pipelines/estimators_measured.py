"""What ``estimators.py`` measures: its scenes, the errors and the run times of each estimator."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from plain_expected import Rough

from roughmdr.aggregate.totals import FORCE
from roughmdr.ensemble.nodes import Rule
from roughmdr.expected.node import Asked, set_up, totals_of
from roughmdr.plan import Cell, law_of, make_plan
from roughmdr.scene import read
from roughmdr.variables import DEFAULT

UM, MODULUS, WORK = 1e-6, 4e6, 0.05
SCENES = {
    "Hertz, normal heights, lognormal radii": Rough("normal", UM, 50 * UM, 5 * UM, MODULUS),
    "Hertz, exponential heights, lognormal radii": Rough("exponential", UM, 50 * UM, 5 * UM, MODULUS),
    "JKR, normal heights, equal radii": Rough("normal", UM, 50 * UM, 0.0, MODULUS, WORK),
    "JKR, normal heights, lognormal radii": Rough("normal", UM, 50 * UM, 5 * UM, MODULUS, WORK),
    "JKR, exponential heights, lognormal radii": Rough("exponential", UM, 50 * UM, 5 * UM, MODULUS, WORK),
}
SPREADS = (0.1, 0.3, 1.0, 2.0)
"""Std of the radii over their mean, for the convergence over the radii."""
HEIGHTS = {"normal": ("normal", "mean", "std"), "exponential": ("expon", "loc", "scale")}
"""The name of each distribution of heights, and of its parameters: where it is, how wide."""
DRAWN = ("sampled", "stratified")
ASKED = ("force", "default variables", "force, in and out")
ORDERS = (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24)
FINEST = 60  # the nodes that these are held against
REALIZATIONS, REPEATS = 32, 5
ROUNDS = 4  # so that what disturbs the clock for a while does not touch all realisations of one count


def cell_of(rough: Rough, estimator: str, count: int = 1, *, unload: bool = False) -> Cell:
    """The scene of some asperities, and the way of its flat: 200 separations."""
    distribution, place, width = HEIGHTS[rough.heights]
    lognormal = {"distribution": "lognormal", "mean": rough.radius, "std": rough.radius_std}
    table: dict[str, Any] = {
        "material": {"effective_modulus": rough.modulus},
        "adhesion": {"model": "jkr", "work": rough.work},
        "asperities": {
            "source": "random",
            "shape": "paraboloid",
            "count": count,
            "patch": "1 mm",
            "height": {"distribution": distribution, place: 0.0, width: rough.std},
            "radius": lognormal if rough.radius_std else rough.radius,
        },
        "path": {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 200}, "unload": unload},
        "batch": {"estimator": estimator},
    }
    return make_plan(read(table)).cells[0]


def shortest(action: Callable[[], object]) -> float:
    """The shortest wall time [s] of a few."""
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        action()
        times.append(time.perf_counter() - started)
    return min(times)


def expected(rough: Rough, points: int, digits: int) -> tuple[np.ndarray, dict[str, float], list[float]]:
    """The force [N] of an asperity on the way in; how far off it is; and seconds, for each of ``ASKED``."""
    cell, both = cell_of(rough, "expected"), cell_of(rough, "expected", unload=True)
    runs = [(cell, ["force"]), (cell, list(DEFAULT)), (both, ["force"])]
    seconds = [shortest(partial(law_of, *way, 0, names, "expected")) for way, names in runs]
    law = law_of(*cell, 0, ["force"], "expected")
    force, separation = law.variables["force"], cell.route.separation
    steps = np.linspace(0, force.size - 1, points).astype(int)
    off = max(abs(rough.force(float(separation[i]), digits=digits) - float(force[i])) for i in steps)
    errors = {"reference_error": off / float(np.abs(force).max()), "numerical_error": law.numerical_error}
    return force, errors, seconds


def by_draws(rough: Rough, force: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """[method, count]: the r.m.s. error of a realisation over the path, and its shortest time [s]."""
    cells = [[cell_of(rough, estimator, int(count)) for count in counts] for estimator in DRAWN]
    squares, seconds = np.zeros((len(DRAWN), counts.size)), np.full((len(DRAWN), counts.size), np.inf)
    for numbers in np.array_split(np.arange(REALIZATIONS), ROUNDS):
        for place in np.ndindex(squares.shape):
            count, cell = int(counts[place[1]]), cells[place[0]][place[1]]
            for number in (numbers + count).tolist():  # other draws for each count, else they begin alike
                started = time.perf_counter()
                law = law_of(*cell, number, ["force"], DRAWN[place[0]])
                seconds[place] = min(seconds[place], time.perf_counter() - started)
                squares[place] += np.mean((law.variables["force"] / count - force) ** 2)
    return np.sqrt(squares / REALIZATIONS) / np.abs(force).max(), seconds


def by_order(rough: Rough) -> tuple[list[float], list[float]]:
    """For each of ``ORDERS``: the r.m.s. error of Gauss's rule over the radii, and its shortest time [s]."""
    scene, route = cell_of(rough, "expected")
    asked, steps = (
        Asked(scene.asperities, route, scene.modulus, scene.law, (FORCE,)),
        list(range(route.separation.size)),
    )

    def found(order: int) -> np.ndarray:
        nodes = set_up(asked, Rule.smooth(order))
        return np.asarray(totals_of(nodes, route.separation, (FORCE,), steps)[0][FORCE])

    finest = found(FINEST)
    error = [float(np.sqrt(np.mean((found(order) - finest) ** 2)) / np.abs(finest).max()) for order in ORDERS]
    return error, [shortest(partial(found, order)) for order in ORDERS]


def by_spread() -> list[list[float]]:
    """[spread, order]: the same error for JKR, normal heights, and ever wider laws of the radius."""
    return [by_order(Rough("normal", UM, 50 * UM, spread * 50 * UM, MODULUS, WORK))[0] for spread in SPREADS]
