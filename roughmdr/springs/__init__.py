"""One asperity as a row of springs: the method of dimensionality reduction carried out literally (H 18-24, 44).

The half-space becomes a row of independent springs, dx apart, each of stiffness E* dx; on either side of the axis they
stand at x_i = (i + 1/2) dx. The MDR profile g(x) is pressed into them by delta: a spring in contact is pressed by
delta - g(x_i). When the outermost pair detaches at a stretch u, their energy E* dx u^2 is freed, and 2 pi x_i dx w is
spent on the ring that is bared. So a spring stays in contact up to the stretch dl(x_i) = sqrt(2 pi x_i w/E*) (H 44),
and the next one outside attaches where its stretch would be at most that. The contact radius is where the outermost
spring ends, a multiple of dx.

Without adhesion the force, and the indentation under a force, converge to second order in dx where g' is finite (else
to order 3/2 or so), the contact radius to first order. With adhesion all converge to first order, since the force steps
by that of the outermost pair. The stiffness takes g' from the last springs, and is coarse at a corner of the profile.
"""

import math
from collections.abc import Callable, Iterator
from operator import index
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.shapes import Shape
from roughmdr.springs.profile import FunctionProfile, ShapeProfile

Results = dict[str, Floats]

_COUNT_MIN, _COUNT_MAX, _COUNT_MAX_OF_FUNCTION = 10, 10_000_000, 1_000_000
_PER_OCTAVE = 8  # lengths of rows per factor of 2
_TRIAL_SPRINGS = 64  # springs by which lengths are estimated
_LENGTH_NUMBER_MAX = 498 * _PER_OCTAVE  # the longest is 2^498 m, the shortest 2^-498 m


class Row(NamedTuple):
    """The springs on one side of the axis at (i + 1/2) dx, with one more outside the row."""

    spacing: float
    g: Floats  # MDR profile [m] at each
    release_stretch: Floats  # dl [m] at each
    area: Floats  # ∫ g dx [m2] over those before it

    @property
    def release_indentation(self) -> Floats:
        """The indentation [m] below which each detaches, when it is the outermost."""
        return self.g - self.release_stretch

    @property
    def release_load(self) -> Floats:
        """The force over 2 E* [m2] below which each detaches under dead load, when it is the outermost."""
        before = np.arange(self.g.size)
        return self.spacing * (before * self.g - (before + 1) * self.release_stretch) - self.area


class Springs(NamedTuple):
    """A contact whose state is that of a row of springs, which ends a little beyond the contact."""

    profile: ShapeProfile | FunctionProfile
    effective_modulus: float
    adhesion_length: float  # w/E* [m]
    springs: int

    @classmethod
    def of(
        cls, shape: Shape | Callable[[Floats], Floats], effective_modulus: float, work: float, count: int | None
    ) -> "Springs":
        """Return ``count`` springs for a shape, or a function f(r) [m] of radii [m]; errors as ``indent``."""
        if isinstance(shape, type) or not (isinstance(shape, Shape) or callable(shape)):
            raise ShapeError(
                f"shape is {shape!r}; it must be a shape such as Paraboloid(radius=1e-6), or a function f(r)"
            )
        maximum = _COUNT_MAX if isinstance(shape, Shape) else _COUNT_MAX_OF_FUNCTION
        whole = hasattr(count, "__index__") and not isinstance(count, bool)
        if count is None or not whole or not _COUNT_MIN <= index(count) <= maximum:
            allowed = f"a whole number from {_COUNT_MIN} to {maximum}"
            of_function = "" if isinstance(shape, Shape) else " for a function f(r)"
            raise RoughmdrError(f"springs is {count!r}; with method='springs' it must be {allowed}{of_function}")
        profile = ShapeProfile(shape) if isinstance(shape, Shape) else FunctionProfile(shape)
        if work > 0.0 and not profile.least_exponent > 0.5:
            raise OutOfRange(f"exponent is {profile.least_exponent:g}; with adhesion (work > 0) it must be above 1/2")
        return cls(profile, effective_modulus, work / effective_modulus, index(count))

    def at_indentation(self, delta: Floats) -> Results:
        """Return the contact as on retraction, up to the last spring that can be in contact; zeros where none can."""
        results = _zeros(delta, "force", "contact_radius", "stiffness")
        in_contact = np.flatnonzero((delta > 0.0) | (self.adhesion_length > 0.0))
        for row, group, count in self.fitted(delta[in_contact], loaded=False):
            _fill(results, in_contact[group], self._state(row, count, delta[in_contact[group]]))
        return results

    def at_force(self, force: Floats) -> Results:
        """Return the contact as on retraction under dead load; OutOfRange where no spring can be in contact."""
        results = _zeros(force, "indentation", "contact_radius", "stiffness")
        in_contact = np.flatnonzero((force > 0.0) | (self.adhesion_length > 0.0))
        loads = 0.5 * force[in_contact] / self.effective_modulus
        for row, group, count in self.fitted(loads, loaded=True):
            delta = (loads[group] / row.spacing + row.area[count] / row.spacing) / np.maximum(count, 1)
            _fill(results, in_contact[group], {**self._state(row, count, delta), "indentation": delta})
        lost = (results["contact_radius"] == 0.0) & ((force < 0.0) | (self.adhesion_length > 0.0))
        if lost.any():
            worst, lowest = float(force[lost].min()), self.pull_off_force()
            raise OutOfRange(f"force is {worst!r} N; it must be at least the pull-off force, {lowest!r} N")
        return results

    def at_radius(self, radius: Floats) -> Results:
        """Return the equilibrium of a row as long as each contact, stable or not; zeros where it is 0."""
        profile = self.profile
        if (radius < 0.0).any():
            raise OutOfRange(f"contact_radius is {float(radius.min()):g} m; it must be at least 0")
        if profile.plateau == profile.limit:
            raise ShapeError(
                f"contact_radius does not determine the state of a flat punch: it is always {profile.plateau:g} m"
            )
        on_the_flat = (radius > 0.0) & (radius < profile.plateau)
        if on_the_flat.any():
            raise ShapeError(
                f"contact_radius is {radius[on_the_flat][0]:g} m, on the flat of the profile, where contacts are not "
                f"stable; it must be 0, or at least {profile.plateau:g} m"
            )
        results = _zeros(radius, "indentation", "force", "stiffness")
        for k in np.flatnonzero(radius):
            a = radius[k : k + 1]
            delta = profile.at(a, self.springs)[0] - self.release_stretch(a)
            row = self.row(float(a[0]))
            state = self._state(row, np.array([self.springs]), delta)
            _fill(results, np.array([k]), {**state, "indentation": delta})
        return results

    def follow(self, path: Floats) -> Results:
        """Return contact radius [m] and force [N] along a path of indentations [m] that begins out of contact.

        One row with memory, as long as the largest contact: at each indentation springs attach or detach, one after
        another from where the contact ended before. It begins at first touch, where delta is 0 or more.
        """
        results = _zeros(path, "contact_radius", "force")
        largest = path.max(keepdims=True)
        if not (largest[0] > 0.0 or (largest[0] == 0.0 and self.adhesion_length > 0.0)):
            return results
        with np.errstate(all="ignore"):
            row, _, _ = next(self.fitted(largest, loaded=False))
            thresholds, count, counts = row.release_indentation, 0, []
            for delta in path:
                if count or delta > 0.0 or (delta == 0.0 and self.adhesion_length > 0.0):
                    count += int(np.argmax(thresholds[count:] > delta))
                    count -= int(np.argmax(np.append(thresholds[:count][::-1] <= delta, True)))
                counts.append(count)
            state = self._state(row, np.array(counts), path)
        return {name: state[name] for name in results}

    def _state(self, row: Row, count: Ints, delta: Floats) -> Results:
        """Return the state of contacts of the first ``count`` springs; zeros where that is 0."""
        thresholds = row.release_indentation
        a: Floats = row.spacing * count.astype(np.float64)
        slope = (thresholds[count] - thresholds[count - 1]) / row.spacing
        released = self.release_stretch(a) / slope if self.adhesion_length > 0.0 else 0.0
        results = {
            "contact_radius": a,
            "force": 2.0 * self.effective_modulus * (a * delta - row.area[count]),
            "stiffness": 2.0 * self.effective_modulus * (a - released),
        }
        return {name: np.where(count > 0, numbers, 0.0) for name, numbers in results.items()}

    def pull_off_force(self) -> float:
        """Return the least force [N] at which there is a contact under dead load."""
        if not self.adhesion_length > 0.0:
            return 0.0
        row, _, _ = next(self.fitted(np.zeros(1), loaded=True))
        return 2.0 * self.effective_modulus * float(row.release_load[:-1].min())

    def release_stretch(self, x: Floats) -> Floats:
        """dl(x) [m] = sqrt(2 pi x w/E*) (H 44)."""
        return np.asarray(np.sqrt(2.0 * math.pi * x) * math.sqrt(self.adhesion_length), dtype=np.float64)

    def row(self, length: float) -> Row:
        """Return the row of a length [m]."""
        spacing = length / self.springs
        g = self.profile.row(spacing, self.springs + 1)
        release_stretch = self.release_stretch(spacing * np.arange(0.5, self.springs + 1.0))
        return Row(spacing, g, release_stretch, spacing * np.append(0.0, np.cumsum(g[:-1])))

    def fitted(self, targets: Floats, loaded: bool) -> Iterator[tuple[Row, Ints, Ints]]:
        """Yield a row of fitting length for each group of targets: it, their indices, and the springs in contact.

        Targets are indentations [m] or, if ``loaded``, forces over 2 E* [m2]. On retraction the contact ends with
        the last spring that can be in contact. Targets under which none can are in no group.
        """
        numbers, waiting = self._length_numbers(targets, loaded)
        while waiting.any():
            number = int(numbers[waiting].min())
            group = np.flatnonzero(waiting & (numbers == number))
            row = self.row(min(2.0 ** (number / _PER_OCTAVE), self.profile.limit))
            thresholds = row.release_load if loaded else row.release_indentation
            too_short = thresholds[-1] <= targets[group]  # the spring outside the row would be in contact too
            numbers[group[too_short]] += 1
            group = group[~too_short]
            waiting[group] = False
            yield row, group, np.searchsorted(_min_from(thresholds[:-1]), targets[group], side="right")

    def _length_numbers(self, targets: Floats, loaded: bool) -> tuple[Ints, NDArray[np.bool_]]:
        """Return numbers of lengths 2^(number/_PER_OCTAVE) [m] that no contact exceeds, and where there can be contact.

        Where the stretch dl is less than the gap to the profile, it is so further out as well.
        """
        low = math.floor(_PER_OCTAVE * math.log2(self.profile.start))
        bounds = self._lower_bounds(low, low + _PER_OCTAVE, loaded)
        while not bounds[-1] > max(0.0, targets.max(initial=0.0)):
            end = low + bounds.size
            bounds = np.append(bounds, self._lower_bounds(end, end + _PER_OCTAVE, loaded))
        while True:
            found = np.searchsorted(_min_from(bounds), targets, side="right")
            adhesive = self._adhesive_part(np.array(2.0 ** (low / _PER_OCTAVE)), loaded)
            if ((found > 0) | (adhesive <= -targets)).all():
                return low + found, found > 0
            bounds = np.append(self._lower_bounds(low - 4 * _PER_OCTAVE, low, loaded), bounds)
            low -= 4 * _PER_OCTAVE

    def _lower_bounds(self, low: int, high: int, loaded: bool) -> Floats:
        """Return for each length to the next a target below which no contact ends between them."""
        if not -_LENGTH_NUMBER_MAX <= low < high <= _LENGTH_NUMBER_MAX:
            raise OutOfRange("the contact radius is not representable, or the contact grows without end")
        x: Floats = 2.0 ** (np.arange(low, high + 1.0) / _PER_OCTAVE)
        g, G = self.profile.at(x[:-1], _TRIAL_SPRINGS)
        return (x[:-1] * g - G if loaded else g) - self._adhesive_part(x[1:], loaded)

    def _adhesive_part(self, x: Floats, loaded: bool) -> Floats:
        """Return the decrease of the control by adhesion at each contact radius [m]."""
        return x * self.release_stretch(x) if loaded else self.release_stretch(x)


def _zeros(like: Floats, *names: str) -> Results:
    return {name: np.zeros_like(like) for name in names}


def _fill(results: Results, indices: Ints, state: Results) -> None:
    for name, numbers in results.items():
        numbers[indices] = state[name]


def _min_from(values: Floats) -> Floats:
    """Return the minimum of each value and all after it."""
    return np.minimum.accumulate(values[::-1])[::-1]
