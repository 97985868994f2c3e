"""One asperity as a row of springs: the method of dimensionality reduction taken at its word (H 18-24, 44).

The half-space becomes a row of springs that do not feel each other, dx apart, each of stiffness E* dx; on either side
of the axis they stand at x_i = (i + 1/2) dx. The MDR profile g(x) is pressed into them by delta: a spring in contact is
pressed by delta - g(x_i). When the outermost pair lets go at a stretch u, their energy E* dx u^2 is freed, and
2 pi x_i dx w spent on the ring that is bared. So a spring holds on up to the stretch dl(x_i) = sqrt(2 pi x_i w/E*)
(H 44), and the next one outside snaps on where its stretch would be at most that. The contact radius is where the
outermost ends, a multiple of dx.

Without adhesion the force, and the indentation under a force, are right to second order in dx where g' is finite (else
to order 3/2 or so), the contact radius to first order. With adhesion all are to first order, since the force steps by
that of the outermost pair. The stiffness takes g' from the last springs, and is coarse at a corner of the profile.
"""

from collections.abc import Callable
from operator import index
from typing import NamedTuple

import numpy as np

from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.springs.profile import OfFunction, OfShape
from roughmdr.springs.row import Ints, Row, Rows

Results = dict[str, Floats]

FEWEST, MOST, MOST_OF_FUNCTION = 10, 10_000_000, 1_000_000


class Springs(NamedTuple):
    """A contact whose state is that of a row of springs, which ends a little beyond the contact."""

    rows: Rows
    effective_modulus: float

    @classmethod
    def of(
        cls, shape: Shape | Callable[[Floats], Floats], effective_modulus: float, work: float, count: int | None
    ) -> "Springs":
        """``count`` springs below a shape, or a profile f(r) [m] of an array of radii [m]; errors as ``indent``."""
        if isinstance(shape, type) or not (isinstance(shape, Shape) or callable(shape)):
            raise ShapeError(
                f"shape is {shape!r}; it must be a shape such as Paraboloid(radius=1e-6), or a function f(r)"
            )
        most = MOST if isinstance(shape, Shape) else MOST_OF_FUNCTION
        whole = hasattr(count, "__index__") and not isinstance(count, bool)
        if count is None or not whole or not FEWEST <= index(count) <= most:
            allowed = f"a whole number from {FEWEST} to {most}{'' if most == MOST else ' for a function f(r)'}"
            raise RoughmdrError(f"springs is {count!r}; with method='springs' it must be {allowed}")
        profile = OfShape(shape) if isinstance(shape, Shape) else OfFunction(shape)
        if work > 0.0 and not profile.least_exponent > 0.5:
            raise OutOfRange(f"exponent is {profile.least_exponent:g}; with adhesion (work > 0) it must be above 1/2")
        return cls(Rows(profile, work / effective_modulus, index(count)), effective_modulus)

    def at_indentation(self, delta: Floats) -> Results:
        """As on retraction: all springs up to the last that holds; zeros where none does."""
        results = _zeros(delta, "force", "contact_radius", "stiffness")
        touching = np.flatnonzero((delta > 0.0) | (self.rows.tenacity > 0.0))
        for row, some, held in self.rows.fitted(delta[touching], loaded=False):
            state = self._state(row, held, delta[touching[some]])
            _fill(results, touching[some], state)
        return results

    def at_force(self, force: Floats) -> Results:
        """The same under dead load; OutOfRange where none holds."""
        results = _zeros(force, "indentation", "contact_radius", "stiffness")
        touching = np.flatnonzero((force > 0.0) | (self.rows.tenacity > 0.0))
        loads = 0.5 * force[touching] / self.effective_modulus
        for row, some, held in self.rows.fitted(loads, loaded=True):
            delta = (loads[some] / row.spacing + row.area[held] / row.spacing) / np.maximum(held, 1)
            state = {**self._state(row, held, delta), "indentation": delta}
            _fill(results, touching[some], state)
        lost = (results["contact_radius"] == 0.0) & ((force < 0.0) | (self.rows.tenacity > 0.0))
        if lost.any():
            worst, least = float(force[lost].min()), self.pull_off_force()
            raise OutOfRange(f"force is {worst!r} N; the contact holds no more than the pull-off force, {least!r} N")
        return results

    def at_radius(self, radius: Floats) -> Results:
        """The equilibrium of a row as long as each contact, stable or not; zeros where it is 0."""
        profile = self.rows.profile
        if (radius < 0.0).any():
            raise OutOfRange(f"contact_radius is {float(radius.min()):g} m; it must be at least 0")
        if profile.flat == profile.limit:
            raise ShapeError(f"contact_radius does not tell the state of a flat punch: it is always {profile.flat:g} m")
        on_the_flat = (radius > 0.0) & (radius < profile.flat)
        if on_the_flat.any():
            raise ShapeError(
                f"contact_radius is {radius[on_the_flat][0]:g} m, on the flat of the profile, where contacts are not "
                f"stable; it must be 0, or at least {profile.flat:g} m"
            )
        results = _zeros(radius, "indentation", "force", "stiffness")
        for k in np.flatnonzero(radius):
            a = radius[k : k + 1]
            delta = profile.at(a, self.rows.springs)[0] - self.rows.stretch(a)
            row = self.rows.row(float(a[0]))
            state = {**self._state(row, np.array([self.rows.springs]), delta), "indentation": delta}
            _fill(results, np.array([k]), state)
        return results

    def follow(self, path: Floats) -> Results:
        """Contact radius [m] and force [N] along a path of indentations [m] that begins out of contact.

        One row with memory, as long as the farthest contact: at each indentation springs snap on, or let go, one after
        another from where the contact ended before. It begins at first touch, where delta is 0 or more.
        """
        results = _zeros(path, "contact_radius", "force")
        farthest = path.max(keepdims=True)
        if not (farthest[0] > 0.0 or (farthest[0] == 0.0 and self.rows.tenacity > 0.0)):
            return results
        with np.errstate(all="ignore"):
            row, _, _ = next(self.rows.fitted(farthest, loaded=False))
            grips, held, ends = row.grips, 0, []
            for delta in path:
                if held or delta > 0.0 or (delta == 0.0 and self.rows.tenacity > 0.0):
                    held += int(np.argmax(grips[held:] > delta))
                    held -= int(np.argmax(np.append(grips[:held][::-1] <= delta, True)))
                ends.append(held)
            state = self._state(row, np.array(ends), path)
        return {name: state[name] for name in results}

    def _state(self, row: Row, held: Ints, delta: Floats) -> Results:
        """The state of contacts that end with the spring before number ``held``; zeros where that is 0."""
        grips = row.grips
        a: Floats = row.spacing * held.astype(np.float64)
        slope = (grips[held] - grips[held - 1]) / row.spacing
        released = self.rows.stretch(a) / slope if self.rows.tenacity > 0.0 else 0.0
        results = {
            "contact_radius": a,
            "force": 2.0 * self.effective_modulus * (a * delta - row.area[held]),
            "stiffness": 2.0 * self.effective_modulus * (a - released),
        }
        return {name: np.where(held > 0, numbers, 0.0) for name, numbers in results.items()}

    def pull_off_force(self) -> float:
        """The least force [N] that the springs hold under dead load."""
        if not self.rows.tenacity > 0.0:
            return 0.0
        row, _, _ = next(self.rows.fitted(np.zeros(1), loaded=True))
        return 2.0 * self.effective_modulus * float(row.load[:-1].min())


def _zeros(like: Floats, *names: str) -> Results:
    return {name: np.zeros_like(like) for name in names}


def _fill(results: Results, places: Ints, state: Results) -> None:
    for name, numbers in results.items():
        numbers[places] = state[name]
