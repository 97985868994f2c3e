"""The points of the study of error against run time: what a method costs with a setting, and how far off it is."""

import math
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

_LONG = 0.5  # [s]
QUANTITIES = ("force", "contact area", "pull-off force")
Errors = tuple[float, float, float]
"""Relative error of each of the ``QUANTITIES``."""


class Curve(NamedTuple):
    """Result of a method."""

    force: Floats
    """[N], along the path."""
    area: Floats
    """[m2], along the path."""
    pull_off: float
    """The greatest tension, with its sign [N]."""
    evaluations: int
    """How often a state of a contact, an integrand, a profile or a spring was evaluated."""


class Reference(NamedTuple):
    """The exact result at some steps of the path."""

    steps: list[int]
    force: Floats
    area_steps: list[int]
    area: Floats
    pull_off: float
    """0 where there is none."""

    def errors(self, curve: Curve) -> Errors:
        """Return the r.m.s. error over the steps, over the largest value of the reference."""
        return (
            _rms(curve.force[self.steps] - self.force) / float(np.abs(self.force).max()),
            _rms(curve.area[self.area_steps] - self.area) / float(self.area.max()),
            abs(curve.pull_off / self.pull_off - 1.0) if self.pull_off else math.nan,
        )


class Point(NamedTuple):
    """A method with one setting."""

    setting: float
    errors: Errors
    seconds: float
    """Of a curve."""
    evaluations: float
    """For a curve."""


Points = Callable[[Any, Reference, bool], Iterator[Point]]
"""(scene, reference, quick) -> a point for each setting."""


class Method(NamedTuple):
    """A method: one entry in a list."""

    name: str
    setting: str
    """What its error is set by."""
    points: Points
    competes: bool = True
    """For the cheapest: not a method that chooses among others, or that is a part of one."""


def timed(action: Callable[[], Curve], repeats: int) -> tuple[Curve, float]:
    """Return the result of an action and its shortest wall time [s]; it is repeated unless it takes long."""
    seconds = list[float]()
    while len(seconds) < repeats and sum(seconds) < _LONG:
        started = time.perf_counter()
        curve = action()
        seconds.append(time.perf_counter() - started)
    return curve, min(seconds)


def each_setting(settings: tuple[float, ...], prepare: Callable[[Any, float], Callable[[], Curve]]) -> Points:
    """Return the points of a method that ``prepare`` makes ready for a setting; every other setting where quick."""

    def points(scene: Any, exact: Reference, quick: bool) -> Iterator[Point]:
        prepare(scene, settings[0])()  # compiled before the clock runs
        for setting in settings[:: 2 if quick else 1]:
            curve, seconds = timed(prepare(scene, setting), 1 if quick else 3)
            yield Point(setting, exact.errors(curve), seconds, curve.evaluations)

    return points


def root_mean_square(errors: list[Errors]) -> Errors:
    """Return the r.m.s. of each quantity."""
    force, area, pull_off = np.sqrt(np.mean(np.square(errors), axis=0)).tolist()
    return force, area, pull_off


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
