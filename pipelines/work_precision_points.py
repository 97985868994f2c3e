"""What a way to a curve costs and how far off it is: the points that ``work_precision.py`` is made of."""

import math
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

_LONG = 0.5  # [s]
QUANTITIES = ("force", "contact area", "pull-off force")


class Curve(NamedTuple):
    """What a way comes to."""

    force: Floats
    """[N], along the path."""
    area: Floats
    """[m2], along the path."""
    pull_off: float
    """The greatest tension, with its sign [N]."""
    evaluations: int
    """How often a state of a contact, an integrand, a profile or a spring was evaluated."""


class Reference(NamedTuple):
    """The same by many digits, at some steps of the path."""

    steps: list[int]
    force: Floats
    area_steps: list[int]
    area: Floats
    pull_off: float
    """0 where there is none."""

    def errors(self, curve: Curve) -> tuple[float, float, float]:
        """Of the ``QUANTITIES``: r.m.s. over the steps and over the largest of the reference; relative."""
        off = abs(curve.pull_off / self.pull_off - 1.0) if self.pull_off else math.nan
        return (
            _rms(curve.force[self.steps] - self.force) / float(np.abs(self.force).max()),
            _rms(curve.area[self.area_steps] - self.area) / float(self.area.max()),
            off,
        )


class Point(NamedTuple):
    """A way with one setting."""

    setting: float
    errors: tuple[float, float, float]
    """Of the ``QUANTITIES``."""
    seconds: float
    """Of a curve."""
    evaluations: float
    """For a curve."""


class Method(NamedTuple):
    """A way to the curve of a scene: one entry in a list."""

    name: str
    setting: str
    """What its error is set by."""
    points: Callable[[Any, Reference, bool], Iterator[Point]]
    """(scene, reference, quick) -> a point for each setting."""
    competes: bool = True
    """For the cheapest: not what chooses among the others, or shows what stands behind one."""


def timed(action: Callable[[], Curve], repeats: int) -> tuple[Curve, float]:
    """What an action comes to, and its shortest wall time [s] of a few; once will do where it takes long."""
    seconds = list[float]()
    while len(seconds) < repeats and sum(seconds) < _LONG:
        started = time.perf_counter()
        curve = action()
        seconds.append(time.perf_counter() - started)
    return curve, min(seconds)


def root_mean_square(errors: list[tuple[float, float, float]]) -> tuple[float, float, float]:
    """Of each quantity."""
    force, area, pull_off = np.sqrt(np.mean(np.square(errors), axis=0)).tolist()
    return force, area, pull_off


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
