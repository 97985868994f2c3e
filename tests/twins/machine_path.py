"""JKR paraboloids under a flat on a machine, interval by interval between touches and detachments: slow and plain.

Each interval without such an event is sampled, densely towards its upper end, where the stiffness of a contact that is
about to detach has no bound; the first sample that has passed is bisected, and so is the way to a peak between samples.
Units: forces [N], lengths [m], E* [Pa], w [J/m2].
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_SAMPLES = 150
_BESIDE = 1e-13  # distance to an event on either side, over the depth of detachment


def stable_root(x: Floats) -> Floats:
    """Return the largest root t of t^4 - t = x, for x of at least -3/4 (1/4)^(1/3)."""
    t = np.maximum(1.0, np.sqrt(np.sqrt(np.maximum(x, 0.0)))) + 1.0
    for _ in range(70):
        t = t - (t**4 - t - x) / (4.0 * t**3 - 1.0)
    return t


@dataclass
class BruteForce:
    """Asperities with the flat and its machine: a spring of stiffness k_m [N/m], or a dead load where it is 0."""

    height: Floats
    radius: Floats
    modulus: float
    work: float
    stiffness: float
    h: float = math.inf
    contacts: set[int] = field(default_factory=set)
    jumps: list[float] = field(default_factory=list)
    """The demand of the machine at each jump."""

    def __post_init__(self) -> None:
        self.a0 = np.cbrt(2.0 * math.pi * self.work * self.radius**2 / self.modulus)
        self.d0 = self.a0**2 / self.radius
        self.depth = 0.75 * np.cbrt(0.25) * self.d0

    def force(self, h: Floats) -> Floats:
        """Return the force [N] of the present contacts at separations [m]."""
        total = np.zeros_like(h)
        for i in sorted(self.contacts):
            x = np.maximum((self.height[i] - h) / self.d0[i], -0.75 * np.cbrt(0.25))
            t = stable_root(x)
            total += 2.0 * self.modulus * self.a0[i] * self.d0[i] * (2.0 / 3.0 * t**6 - t**3)
        return total

    def demand(self, h: Floats) -> Floats:
        """Return the demand of the flat: h - F/k_m, or -F under a dead load."""
        return h - self.force(h) / self.stiffness if self.stiffness > 0.0 else -self.force(h)

    def follow(self, demands: Floats) -> tuple[Floats, Floats, list[int]]:
        """Return separation, force and number of contacts at each demand; inf and 0 where the flat has flown off."""
        found = []
        for number, target in enumerate(demands.tolist()):
            falls = number == 0 or target <= demands[number - 1]
            self._sink(target) if falls else self._rise(target)
            force = float(self.force(np.array([self.h]))[0]) if self.h < math.inf else 0.0
            found.append((self.h, force, len(self.contacts)))
        separation, forces, count = zip(*found, strict=True)
        return np.array(separation), np.array(forces), list(count)

    def _sink(self, target: float) -> None:
        """Go down to the first separation at which the demand is at most the target."""
        if not self.contacts:
            if self.stiffness == 0.0 and target > 0.0:
                self.h = math.inf
                return
            if self.stiffness > 0.0 and target > self.height.max():
                self.h = target
                return
            self._touch(float(self.height.max()))
        while True:
            below = [z for i, z in enumerate(self.height) if i not in self.contacts and z <= self.h]
            event = max(below, default=-math.inf)
            low = event if event > -math.inf else self._deep_enough(target)
            passed = self._first(low, target, lambda demand: demand <= target, falls=True)
            if passed is not None:
                self.h = passed
                return
            self._touch(event)

    def _deep_enough(self, target: float) -> float:
        way = float(self.depth.max())
        while float(self.demand(np.array([self.h - way]))[0]) > target:
            way *= 2.0
        return self.h - way

    def _touch(self, event: float) -> None:
        self.h = event
        self.contacts |= {i for i, z in enumerate(self.height) if z == event}

    def _rise(self, target: float) -> None:
        """Go up to the first separation at which the demand is at least the target."""
        while self.contacts:
            lost = {i: float(self.height[i] + self.depth[i]) for i in self.contacts}
            event = min(lost.values())
            passed = self._first(event, target, lambda demand: demand >= target, falls=False)
            if passed is not None:
                self.h = passed
                return
            self.jumps.append(event)
            self.h = event
            self.contacts -= {i for i, at in lost.items() if at == event}
        self.h = target if self.stiffness > 0.0 else math.inf

    def _first(
        self, end: float, target: float, has_passed: Callable[[Floats], NDArray[np.bool_]], *, falls: bool
    ) -> float | None:
        """Return the first separation from here to the end at which the demand has passed; None where it has not."""
        width = abs(end - self.h)
        if width == 0.0:
            return None
        near = np.geomspace(1e-14, 1.0, _SAMPLES) * width
        upper = max(self.h, end)
        samples = np.unique(np.concatenate([upper - near, np.linspace(self.h, end, _SAMPLES)]))
        samples = samples[::-1] if falls else samples
        demand = self.demand(samples)
        passed = has_passed(demand)
        if not passed.any() and not falls:
            samples, demand = self._with_peak(samples, demand)
            passed = has_passed(demand)
        if not passed.any():
            return None
        number = int(np.argmax(passed))
        if number == 0:
            return float(samples[0])
        before, after = float(samples[number - 1]), float(samples[number])
        for _ in range(200):
            middle = 0.5 * (before + after)
            if middle in (before, after):
                break
            if has_passed(self.demand(np.array([middle])))[0]:
                after = middle
            else:
                before = middle
        return after

    def _with_peak(self, samples: Floats, demand: Floats) -> tuple[Floats, Floats]:
        """Return samples with the peak of the demand between them."""
        at = int(np.argmax(demand))
        low, high = float(samples[max(at - 1, 0)]), float(samples[min(at + 1, samples.size - 1)])
        for _ in range(100):
            thirds = np.array([low + (high - low) / 3.0, high - (high - low) / 3.0])
            first, second = self.demand(thirds)
            low, high = (float(thirds[0]), high) if first < second else (low, float(thirds[1]))
        peak = 0.5 * (low + high)
        number = int(np.searchsorted(samples, peak))
        more = np.insert(samples, number, peak)
        return more, np.insert(demand, number, self.demand(np.array([peak]))[0])
