"""The points of the study of error against run time: what a method costs with a setting, and how far off it is."""

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from studies.study import timed

_LONG = 0.5  # [s], after which a curve is not timed again
QUANTITIES = ("force", "contact area", "pull-off force")
Errors = tuple[float, float, float]  # relative error of each of the QUANTITIES


class Curve(NamedTuple):
    """Result of a method."""

    force: Floats  # [N], along the path
    area: Floats  # [m2], along the path
    evaluations: int  # how often a state of a contact, an integrand, a profile or a spring was evaluated
    pull_off: float | None = None  # the greatest tension, with its sign [N]; None for that of the path


class Reference(NamedTuple):
    """The exact result at some steps of the path."""

    steps: list[int]
    force: Floats
    area_steps: list[int]
    area: Floats
    pull_off: float  # 0 where there is none

    def errors(self, curve: Curve) -> Errors:
        """Return the r.m.s. error over the steps, over the largest value of the reference."""
        pull_off = float(curve.force.min()) if curve.pull_off is None else curve.pull_off
        return (
            float(root_mean_square(curve.force[self.steps] - self.force) / np.abs(self.force).max()),
            float(root_mean_square(curve.area[self.area_steps] - self.area) / self.area.max()),
            abs(pull_off / self.pull_off - 1.0) if self.pull_off else math.nan,
        )


class Point(NamedTuple):
    """A method with one setting: errors, run time and evaluations of a curve."""

    setting: float
    errors: Errors
    seconds: float
    evaluations: float


Points = Callable[[Any, Reference, bool], Iterator[Point]]  # (scene, reference, quick) -> a point for each setting


class Method(NamedTuple):
    """A method: one entry in a list."""

    name: str
    setting: str  # name of the number that sets its error
    points: Points
    competes: bool = True  # for the cheapest: not a method that chooses among others, or that is a part of one


def each_setting(settings: tuple[float, ...], prepare: Callable[[Any, float], Callable[[], Curve]]) -> Points:
    """Return the points of a method that ``prepare`` makes ready for a setting; every other setting where quick.

    The run time is the shortest of three, or of those that begin within half a second.
    """

    def points(scene: Any, exact: Reference, quick: bool) -> Iterator[Point]:
        prepare(scene, settings[0])()  # compiled before the clock runs
        for setting in settings[:: 2 if quick else 1]:
            curve, seconds = timed(prepare(scene, setting), 1 if quick else 3, _LONG)
            yield Point(setting, exact.errors(curve), seconds, curve.evaluations)

    return points


def root_mean_square(errors: Any) -> Any:
    """Return the r.m.s. over the first axis."""
    return np.sqrt(np.mean(np.square(errors), axis=0))
