"""The mean curve of a rough surface: every method for it, by draws and by integrals."""

import math
from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any

import numpy as np
from oracles.expected_paraboloids import Rough
from oracles.plain_sums import Sums, with_brentq, with_numpy

from roughmdr.batch.plan import Cell, make_plan
from roughmdr.batch.realization import simulate_realization
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from studies.study import timed
from studies.work_precision.points import Curve, Method, Point, Points, Reference, each_setting, root_mean_square

UM, MODULUS, WORK = 1e-6, 4e6, 0.05
COUNT = 1000  # asperities of a realisation
VARIABLES = ["force", "contact_area"]
DIGITS = 12
_STEPS = {False: (10, 20, 30, 40), True: (10, 30, 45, 55, 62, 68)}  # steps of the reference, loading only or both ways
_ERRORS = (0.1, 0.03, 0.01, 0.003)
_MIN_GROUPS = 4  # whose r.m.s. is taken
_SEEDS = 12  # runs to an asked error, of which the mean counts
SURFACES = {
    "Hertz, lognormal radii": Rough("normal", UM, 50 * UM, 5 * UM, MODULUS),
    "JKR, equal radii": Rough("normal", UM, 50 * UM, 0.0, MODULUS, WORK),
    "JKR, lognormal radii": Rough("normal", UM, 50 * UM, 5 * UM, MODULUS, WORK),
}


def scene_of(rough: Rough, **sections: Any) -> Scene:
    """Return paraboloids of normal heights, loaded by a flat and, with adhesion, unloaded; other sections as given."""
    lognormal = {"distribution": "lognormal", "mean": rough.radius, "std": rough.radius_std}
    return read({
        "material": {"effective_modulus": rough.effective_modulus},
        "adhesion": {"model": "jkr", "work": rough.work},
        "asperities": {
            "source": "random", "shape": "paraboloid", "count": COUNT, "patch": "1 mm",
            "height": {"distribution": "normal", "std": rough.std},
            "radius": lognormal if rough.radius_std else rough.radius,
        },
        "path": {"separation": {"start": 3 * UM, "stop": -0.5 * UM, "steps": 50}, "unload": bool(rough.work)},
        "output": {"variables": VARIABLES},
        **sections,
    })  # fmt: skip


@cache
def _cell(rough: Rough) -> Cell:
    return make_plan(scene_of(rough)).cells[0]


def reference(rough: Rough, *, quick: bool) -> Reference:
    """Compute double integrals with ``DIGITS`` digits; the pull-off force at the lowest step of the expected curve."""
    separation = _cell(rough).path.separation
    lowest, turn = int(np.argmin(simulate(rough, "expected").force)), int(np.argmin(separation))

    def mean(quantity: Callable[..., float], step: int) -> float:
        closest = float(separation[turn]) if step > turn else None
        return COUNT * quantity(float(separation[step]), closest, DIGITS)

    steps = list(_STEPS[bool(rough.work)])[:: 2 if quick else 1]
    force = np.array([mean(rough.force, step) for step in steps])
    area = np.array([mean(rough.area, step) for step in steps[::2]])
    return Reference(steps, force, steps[::2], area, mean(rough.force, lowest) if rough.work else 0.0)


def simulate(rough: Rough, estimator: str, realization: int = 0) -> Curve:
    """Compute one realisation, or the expected curve."""
    cell = _cell(rough)
    found = simulate_realization(cell.scene, cell.path, realization, VARIABLES, estimator)
    return Curve(found.variables["force"], found.variables["contact_area"], found.visits)


Draw = Callable[[Rough, int], Curve]  # (surface, number) -> one realisation


def _drawn(draw: Draw, count: int, quick_count: int) -> Points:
    """Return a point for 1, 2, 4 ... of ``count`` realisations: the r.m.s. error of all such groups."""

    def points(rough: Rough, exact: Reference, quick: bool) -> Iterator[Point]:
        draw(rough, 0)  # compiled before the clock runs
        total = quick_count if quick else count
        curves, seconds = zip(*(timed(partial(draw, rough, number)) for number in range(total)), strict=True)
        each, visits = float(np.median(seconds)), float(np.mean([curve.evaluations for curve in curves]))
        drawn = [np.array([getattr(curve, name) for curve in curves]) for name in ("force", "area")]
        for size in 2 ** np.arange(int(math.log2(total / _MIN_GROUPS)) + 1):
            means = [values.reshape(-1, size, values.shape[-1]).mean(axis=1) for values in drawn]
            errors = [exact.errors(Curve(force, area, 0)) for force, area in zip(*means, strict=True)]
            yield Point(float(size), root_mean_square(errors), float(size) * each, float(size) * visits)

    return points


def _plain(sum_up: Callable[..., Sums]) -> Draw:
    """Return realisations drawn and summed by a plain script."""

    def draw(rough: Rough, number: int) -> Curve:
        rng = np.random.default_rng(number)
        spread = math.sqrt(math.log1p((rough.radius_std / rough.radius) ** 2))
        radius = rough.radius * np.exp(spread * rng.standard_normal(COUNT) - 0.5 * spread**2)
        height = rough.std * rng.standard_normal(COUNT)
        found = sum_up(height, radius, _cell(rough).path.separation, rough.effective_modulus, rough.work)
        return Curve(found.force, found.area, found.visits)

    return draw


def _to_error(method: str) -> Points:
    """Return a point for each error that is asked for: r.m.s. error and mean cost of runs with several seeds."""

    def points(rough: Rough, exact: Reference, quick: bool) -> Iterator[Point]:
        _run(rough, method, _ERRORS[-1], 0)  # all is loaded before the clock runs
        for relative in _ERRORS[:2] if quick else _ERRORS:
            runs = [_run(rough, method, relative, seed) for seed in range(2 if quick else _SEEDS)]
            curves, seconds = zip(*runs, strict=True)
            errors = root_mean_square([exact.errors(curve) for curve in curves])
            yield Point(relative, errors, float(np.mean(seconds)), math.nan)

    return points


def _run(rough: Rough, method: str, relative: float, seed: int) -> tuple[Curve, float]:
    """Return the mean curve of a run to an asked error, its states uncounted, and its time [s] without planning."""
    accuracy = {"relative": relative, "max_realizations": 4096, "method": method}
    output = {"variables": VARIABLES, "keep": "statistics"}
    plan = make_plan(scene_of(rough, seed=seed, accuracy=accuracy, output=output))
    done, seconds = timed(partial(execute, plan, None, Backend(workers=1), quiet=True))
    return Curve(done.variables["force_mean"].values, done.variables["contact_area_mean"].values, 0), seconds


METHODS = (
    Method("sampled", "realisations", _drawn(lambda rough, n: simulate(rough, "sampled", n), 1024, 64)),
    Method("stratified", "realisations", _drawn(lambda rough, n: simulate(rough, "stratified", n), 1024, 64)),
    Method("sampled, error asked for", "error", _to_error("sampled"), competes=False),
    Method("stratified, error asked for", "error", _to_error("stratified"), competes=False),
    Method("auto, error asked for", "error", _to_error("auto"), competes=False),
    Method("expected", "-", each_setting((1.0,), lambda rough, _: partial(simulate, rough, "expected"))),
    Method("plain NumPy", "realisations", _drawn(_plain(with_numpy), 128, 16)),
    Method("brentq", "realisations", _drawn(_plain(with_brentq), 4, 4)),
)
