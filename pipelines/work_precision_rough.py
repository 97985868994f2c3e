"""The mean law of a rough surface: every way to it, by draws and by integrals."""

import math
import time
from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from oracles.expected_paraboloids import Rough
from oracles.plain_sums import Sums, with_brentq, with_numpy
from work_precision_points import Curve, Method, Point, Reference, root_mean_square, timed

from roughmdr.aggregate import LoadSeparation
from roughmdr.aggregate.totals import AREA, FORCE
from roughmdr.batch import tasks
from roughmdr.batch.plan import Cell, make_plan, simulate_realization
from roughmdr.ensemble.nodes import Rule
from roughmdr.expected.node import Problem, set_up, totals_of
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.run import execute
from roughmdr.scene import read

UM, MODULUS, WORK = 1e-6, 4e6, 0.05
COUNT = 1000  # asperities of a realisation
ASKED = ["force", "contact_area"]
DIGITS = 12
_STEPS = {False: (10, 20, 30, 40), True: (10, 30, 45, 55, 62, 68)}  # of the reference, on ways in, and in and out
_NODES = (1, 2, 3, 4, 6, 8, 12, 16)
_ERRORS = (0.1, 0.03, 0.01, 0.003)
_GROUPS = 4  # at least, whose r.m.s. is taken
_SEEDS = 12  # runs to an asked error, of which the mean counts


class Surface(NamedTuple):
    """Paraboloids of normal heights, pressed by a flat and, with adhesion, pulled off again."""

    rough: Rough

    def table(self, **sections: Any) -> dict[str, Any]:
        """The scene; other sections as they are given."""
        rough = self.rough
        lognormal = {"distribution": "lognormal", "mean": rough.radius, "std": rough.radius_std}
        return {
            "material": {"effective_modulus": rough.effective_modulus},
            "adhesion": {"model": "jkr", "work": rough.work},
            "asperities": {
                "source": "random",
                "shape": "paraboloid",
                "count": COUNT,
                "patch": "1 mm",
                "height": {"distribution": "normal", "std": rough.std},
                "radius": lognormal if rough.radius_std else rough.radius,
            },
            "path": {"separation": {"start": 3 * UM, "stop": -0.5 * UM, "steps": 50}, "unload": bool(rough.work)},
            "output": {"variables": ASKED},
            **sections,
        }

    @property
    def cell(self) -> Cell:
        """The scene, and the way of its flat."""
        return make_plan(read(self.table())).cells[0]


SURFACES = {
    "Hertz, lognormal radii": Surface(Rough("normal", UM, 50 * UM, 5 * UM, MODULUS)),
    "JKR, equal radii": Surface(Rough("normal", UM, 50 * UM, 0.0, MODULUS, WORK)),
    "JKR, lognormal radii": Surface(Rough("normal", UM, 50 * UM, 5 * UM, MODULUS, WORK)),
}


def reference(surface: Surface, *, quick: bool) -> Reference:
    """By double integrals with ``DIGITS`` digits; the pull-off force at the step where the expected law has it."""
    separation = surface.cell.path.separation
    lowest = int(np.argmin(law(surface, "expected").force))
    rough, turn = surface.rough, int(np.argmin(separation))

    def mean(quantity: Callable[..., float], step: int) -> float:
        closest = float(separation[turn]) if step > turn else None
        return COUNT * quantity(float(separation[step]), closest, DIGITS)

    steps = list(_STEPS[bool(rough.work)])[:: 2 if quick else 1]
    force = np.array([mean(rough.force, step) for step in steps])
    area = np.array([mean(rough.area, step) for step in steps[::2]])
    return Reference(steps, force, steps[::2], area, mean(rough.force, lowest) if rough.work else 0.0)


def curve(found: LoadSeparation, count: float = 1.0) -> Curve:
    """Of a law of ``count`` realisations."""
    return _curve(found.variables["force"], found.variables["contact_area"], found.visits, count)


def _curve(force: Floats, area: Floats, evaluations: int, count: float = 1.0) -> Curve:
    return Curve(force / count, area / count, float(force.min()) / count, evaluations)


def law(surface: Surface, estimator: str, realization: int = 0) -> Curve:
    """One realisation, or the expected law."""
    return curve(simulate_realization(*surface.cell, realization, ASKED, estimator))


def expected(surface: Surface, exact: Reference, quick: bool) -> Iterator[Point]:
    """The expected law, with as many nodes as it takes."""
    cell = surface.cell
    found, seconds = timed(lambda: curve(simulate_realization(*cell, 0, ASKED, "expected")), 1 if quick else 3)
    yield Point(1.0, exact.errors(found), seconds, found.evaluations)


def expected_by_nodes(surface: Surface, exact: Reference, quick: bool) -> Iterator[Point]:
    """The expected law with so many nodes over the radii, and nothing done where some let go and others not."""
    if not surface.rough.radius_std:
        return
    scene, route = surface.cell
    asked = Problem(scene.asperities, route, scene.effective_modulus, scene.adhesion_model, (FORCE, AREA))
    steps = list(range(route.separation.size))

    def found(order: int) -> Curve:
        total, products = totals_of(set_up(asked, Rule.smooth(order)), route.separation, asked.rows, steps)
        return _curve(COUNT * total[FORCE], COUNT * total[AREA], products)

    for order in _NODES[:: 2 if quick else 1]:
        one, seconds = timed(partial(found, order), 1 if quick else 3)
        yield Point(order, exact.errors(one), seconds, one.evaluations)


Draw = Callable[[Surface, int], Curve]
"""(surface, number) -> one realisation."""


def _drawn(draw: Draw, most: int, few: int) -> Callable[[Surface, Reference, bool], Iterator[Point]]:
    """A point for 1, 2, 4 ... of ``most`` realisations, or of ``few``: the r.m.s. error of all such groups."""

    def points(surface: Surface, exact: Reference, quick: bool) -> Iterator[Point]:
        draw(surface, 0)  # compiled before the clock runs
        count = few if quick else most
        curves, seconds = [], []
        for number in range(count):
            started = time.perf_counter()
            curves.append(draw(surface, number))
            seconds.append(time.perf_counter() - started)
        each, visits = float(np.median(seconds)), float(np.mean([one.evaluations for one in curves]))
        force, area = (np.array([getattr(one, name) for one in curves]) for name in ("force", "area"))
        for size in 2 ** np.arange(int(math.log2(count / _GROUPS)) + 1):
            means = [values.reshape(-1, size, values.shape[-1]).mean(axis=1) for values in (force, area)]
            errors = [exact.errors(_curve(*group, 0)) for group in zip(means[0], means[1], strict=True)]
            yield Point(float(size), root_mean_square(errors), float(size) * each, float(size) * visits)

    return points


def _by_package(estimator: str) -> Draw:
    def draw(surface: Surface, number: int) -> Curve:
        return curve(simulate_realization(*_cell(surface), number, ASKED, estimator))

    return draw


@cache
def _cell(surface: Surface) -> Cell:
    return surface.cell


def _plainly(sum_up: Callable[..., Sums]) -> Draw:
    """Drawn and summed as most would."""

    def draw(surface: Surface, number: int) -> Curve:
        rng, rough = np.random.default_rng(number), surface.rough
        spread = math.sqrt(math.log1p((rough.radius_std / rough.radius) ** 2))
        radius = rough.radius * np.exp(spread * rng.standard_normal(COUNT) - 0.5 * spread**2)
        height = rough.std * rng.standard_normal(COUNT)
        path = _cell(surface).path.separation
        found = sum_up(height, radius, path, rough.effective_modulus, rough.work)
        return _curve(found.force, found.area, found.visits)

    return draw


def _asked(method: str) -> Callable[[Surface, Reference, bool], Iterator[Point]]:
    """A point for each error that is asked for: the r.m.s. error and the mean cost of runs with several seeds."""

    def points(surface: Surface, exact: Reference, quick: bool) -> Iterator[Point]:
        _run(surface, method, _ERRORS[-1], 0)  # all is loaded before the clock runs
        for relative in _ERRORS[:2] if quick else _ERRORS:
            runs = [_run(surface, method, relative, seed) for seed in range(2 if quick else _SEEDS)]
            errors = root_mean_square([exact.errors(one) for one, _ in runs])
            seconds, visits = np.mean([(spent, one.evaluations) for one, spent in runs], axis=0)
            yield Point(relative, errors, float(seconds), float(visits))

    return points


def _run(surface: Surface, method: str, relative: float, seed: int) -> tuple[Curve, float]:
    """The mean law of a run to an asked error, and its time [s] without planning, of all that was tried on the way."""
    accuracy = {"relative": relative, "max_realizations": 4096, "method": method}
    output = {"variables": ASKED, "keep": "statistics"}
    plan = make_plan(read(surface.table(seed=seed, accuracy=accuracy, output=output)))
    visits = list[int]()

    def counted(*args: Any) -> LoadSeparation:
        found = simulate_realization(*args)
        visits.append(found.visits)
        return found

    with patch.object(tasks, "law_of", counted):
        started = time.perf_counter()
        found = execute(plan, None, workers=1, quiet=True)
        spent = time.perf_counter() - started
    force, area = (found.variables[name].values for name in ("force_mean", "contact_area_mean"))
    return _curve(force, area, sum(visits)), spent


METHODS = (
    Method("sampled", "realisations", _drawn(_by_package("sampled"), 1024, 64)),
    Method("stratified", "realisations", _drawn(_by_package("stratified"), 1024, 64)),
    Method("sampled, error asked for", "error", _asked("sampled"), competes=False),
    Method("stratified, error asked for", "error", _asked("stratified"), competes=False),
    Method("auto, error asked for", "error", _asked("auto"), competes=False),
    Method("expected", "-", expected),
    Method("expected, nodes given", "nodes", expected_by_nodes, competes=False),
    Method("plain NumPy", "realisations", _drawn(_plainly(with_numpy), 128, 16)),
    Method("brentq", "realisations", _drawn(_plainly(with_brentq), 4, 4)),
)
