"""The expected law of a scene at the steps of a measured curve, as a function of the free parameters."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation, Problem
from roughmdr.aggregate.under_machine import separations_of
from roughmdr.batch.paths import machine_path
from roughmdr.batch.realization import simulate_realization
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError, StoreError
from roughmdr.expected import Changes, Force, ForceRule, Slopes, expected_force, expected_slopes
from roughmdr.fitting.correlation import correlation_of_noise
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.parameters import MACHINE, OF_THE_CURVE, OFFSET, Known, Parameter, baselines, free_parameters
from roughmdr.fitting.spring import Spring
from roughmdr.loading.machine import Jump, MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read, with_numbers
from roughmdr.schema.toml_text import parse_toml


class Point(NamedTuple):
    """The law with certain parameters."""

    x: Floats
    deviations: Floats
    """Law minus measurement, weighted; inf where the law cannot be computed, as ``last_error`` of the model says."""
    law: Force
    """Empty where it cannot be computed."""

    @property
    def cost(self) -> float:
        """The sum of squares of the deviations."""
        return float(np.sum(np.square(self.deviations)))

    @property
    def jumps(self) -> tuple[int, ...]:
        """The steps after which the contact is made or lost."""
        return tuple(self.law.changes.step.tolist())


LEAST_NOISE = 1e-12  # least noise over the largest load: of a curve without any, that of rounding
_NOWHERE = Changes(np.empty(0, dtype=np.int64), np.empty(0), np.empty(0))
_KEPT = 10, 100  # most laws that are kept: more of those that jump, whose neighbours are tried again


class Model:
    """The expected law at the measured steps as a function of x, one number for each free parameter."""

    def __init__(self, scene: Scene, curve: MeasuredCurve, free: list[str], known: Known = Known()) -> None:
        if reason := scene.reason_against("expected"):
            raise SceneError(f"scene: cannot be fitted, for it has no expected law: {reason}")
        if curve.quantity == "pressure" and scene.nominal_area is None:
            raise SceneError(
                f"{curve.origin}: pressure needs a nominal area in the scene: asperities.patch, and a flat"
            )
        if scene.work > 0.0 and curve.is_mixed():
            raise StoreError(
                f"{curve.origin}: {curve.control} goes to and fro from row to row; rows must be in the order of "
                "measurement, on which adhesion depends"
            )
        self.seconds = 0.0
        """Time that was spent on it."""
        self.start, self._free, self._known = scene, free, known
        self.curve = curve._replace(level=curve.far) if any(key.startswith("baseline") for key in free) else curve
        self.parameters: list[Parameter] = free_parameters(free, scene, parse_toml(scene.toml), self.curve, known)
        self.baselines = baselines(self.parameters, self.curve)
        """Load per x of each parameter without contact [step, parameter]."""
        low, high = np.reshape([each.bounds for each in self.parameters], (-1, 2)).T
        self.bounds = low, high
        self._is_plain = scene.interaction is None and not scene.unlike
        self.adheres = scene.work > 0.0
        self.jumps = scene.asperities.equal_heights and self.adheres
        self._path = LoadingPath.along(curve.values, unload=False, adhesive=scene.work > 0.0)
        self.borne: Floats | None = None
        """Load that the spring of a machine bears where it is given; None where it is that of the law."""
        self._rule: ForceRule | None = None
        self.near: Spring | None = None
        """How the load on a machine changes near the last parameters whose slopes were found; None where it jumps."""
        self.noise = 0.0 if curve.error is None else 1.0
        """Standard deviation of the noise in units of the deviations; priors count from when it is known."""
        self.begin, self.told = np.zeros_like(low), (np.empty((0, low.size)), np.empty(0))
        """Where the search begins, and what other curves tell: A x = b."""
        self.spread = np.eye(sum(each.prior is not None for each in self.parameters))
        """A square root of the covariance of what is known otherwise, by priors and by other curves."""
        self.evaluations = 0
        self._points, self._read = dict[tuple[Any, ...], tuple[Point, object]](), (dict[str, float](), scene)
        self.last_error: RoughmdrError = OutOfRange("the expected law is not finite")

    def __getstate__(self) -> dict[str, Any]:
        return vars(self) | {"_points": {}}  # which are known by the identity of what is held

    def along(self, curve: MeasuredCurve) -> "Model":
        """Return the model of another curve, with its own spring constant where that of this curve is the machine's."""
        start, own = self.start, self.curve.stiffness
        if own is None:
            curve = curve._replace(stiffness=None)
        elif curve.stiffness is None:
            raise StoreError(f"{curve.origin}: tells no spring constant, as the first does; set {MACHINE}")
        elif curve.stiffness != own:
            start = read(start, {MACHINE: curve.stiffness})
        return Model(start, curve, self._free, self._known)

    def scene(self, x: Floats) -> Scene:
        """Return the scene with these parameters; SceneError where it does not allow them."""
        pairs = zip(self.parameters, x.tolist(), strict=True)
        numbers = {p.key: p.value(each) for p, each in pairs if p.key not in OF_THE_CURVE}
        if numbers != self._read[0]:
            self._read = numbers, with_numbers(self.start, numbers)
        return self._read[1]

    def fitted(self, x: Floats) -> Scene:
        """Return the scene with these parameters along the whole path, whose run is the fitted law."""
        steps = (self.curve.values + self._offset(x)).tolist()
        return read(self.scene(x), {f"path.{self.curve.control}": steps, "batch": {"estimator": "expected"}})

    def law(self, x: Floats) -> LoadSeparation:
        """Return the law with these parameters; RoughmdrError where there is none."""
        scene, quantity = self.scene(x), self.curve.quantity
        names = [quantity] if scene.nominal_area is None else [quantity, "model_error_curve"]
        return simulate_realization(scene, self._path_in(scene, x, self.curve.values), 0, names, "expected")

    def force(self, x: Floats, values: Floats) -> Force:
        """Return the force, or pressure, of the law along a control; RoughmdrError where there is no law."""
        if self.borne is None and self.near is not None and values is self.curve.values:
            first = self._borne_by(x, self.near.load, None)
            load = self.near.found(first.force, lambda load: self._borne_by(x, load, first.rule).force)
            if load is not None:
                return first._replace(force=load)
        self.evaluations += 1
        scene, (path, jumps) = self.scene(x), self._along(x, values)
        if not (self._is_plain and isinstance(path, LoadingPath)):
            law = simulate_realization(scene, path, 0, [self.curve.quantity], "expected")
            return Force(law.variables[self.curve.quantity], law.numerical_error, _NOWHERE, None)
        found = expected_force(scene.asperities, path, scene.effective_modulus, scene.adhesion_model, self._rule)
        changes = found.changes._replace(control=_control_of(found.changes, jumps) - self._offset(x))
        return found._replace(force=found.force / self._area(scene), changes=changes)

    def slopes(self, x: Floats, rule: ForceRule | None, path: LoadingPath | None = None) -> Slopes | None:
        """Return the derivatives of the force at the separations of the law, or of a path; None where not known."""
        scene, along = self.scene(x), path or self._path_in(self.scene(x), x, self.curve.values)
        if not (self._is_plain and isinstance(along, LoadingPath)):
            return None
        with suppress(OutOfRange):  # the stiffness is infinite where contact is lost
            found = expected_slopes(scene.asperities, along, scene.effective_modulus, scene.adhesion_model, rule)
            if found is not None:
                self.evaluations += 1
                return Slopes(*(each / self._area(scene) for each in found))
        return None

    def slopes_at_jumps(self, x: Floats) -> Slopes:
        """Return the derivatives of the control [m] where the law jumps; NaN where they are not known.

        At a fold the indentation has no derivative with respect to the radius of the contact, so that it changes as it
        does at a given radius: under JKR by -dl = -d sqrt(2 pi a w/E*) (H 44). Behind a spring of compliance c, the
        far end is at h - c F, and moves with the separation of the jump, if that moves, and with the force.
        """
        changes, compliance = self.point(x).law.changes, self.stretch(self.scene(x), np.ones(1))
        path, jumps = self._along(x, self.curve.values)
        separation = path.separation if isinstance(path, LoadingPath) else np.empty(0)
        shifts = np.outer([0.0, -0.5, 0.5], changes.let_go)
        for jump in jumps:
            passed = (changes.control == jump.demand - self._offset(x)) & (changes.let_go != 0.0)
            if passed.any():
                before = np.append(separation[: jump.step], jump.before)
                found = self.slopes(x, None, LoadingPath.along(before, unload=False, adhesive=True))
                by_load = np.full((3, 1), np.nan) if found is None else compliance * np.array(found)[:, -1:]
                shifts[:, passed] = (1.0 + by_load[0]) * shifts[:, passed] - by_load
        return Slopes(np.ones(changes.step.size), *shifts[1:])

    def _borne_by(self, x: Floats, load: Floats, rule: ForceRule | None) -> Force:
        """Return the law where the spring of the machine bears another."""
        with self.held(load=load, rule=rule):
            return self.force(x, self.curve.values)

    def _along(self, x: Floats, values: Floats) -> tuple[LoadingPath | MachinePath, list[Jump]]:
        """Return the path of the flat, or of its machine where that needs the law, and the jumps of the machine."""
        scene = self.scene(x)
        path = self._path_in(scene, x, values)
        if not (self._is_plain and isinstance(path, MachinePath) and scene.asperities.all_alike):
            return path, []
        problem = Problem(scene.asperities.ensemble(0, 0), scene.effective_modulus, scene.adhesion_model)
        separation, jumps = separations_of(problem, path.machine, path.demand, jumps=self.jumps)
        return LoadingPath.along(separation, unload=False, adhesive=path.adhesive), jumps

    def _path_in(self, scene: Scene, x: Floats, values: Floats) -> LoadingPath | MachinePath:
        """Return the path of the flat or of its machine in the scene."""
        if self.curve.control == "separation":  # along the measured steps alone
            return self._path.relative_to(-self._offset(x))
        steps = values + self._offset(x)
        if self.borne is None:
            return machine_path(scene, steps)
        borne = self.curve.load - self.baseline(x) if self.borne is self.curve.load else self.borne
        return LoadingPath.along(steps + self.stretch(scene, borne), unload=False, adhesive=scene.work > 0.0)

    @contextmanager
    def held(self, *, load: Floats | None = None, rule: ForceRule | None = None) -> Iterator[None]:
        """Hold what the law takes long to find: the rule over shape parameters, and the load [N or Pa] that the spring
        of a machine bears, by which the separation is known.
        """
        before, self.borne, self._rule = (self.borne, self._rule), load, rule
        try:
            yield
        finally:
            self.borne, self._rule = before

    def assume_noise_of(self, deviations: Floats, slopes: Floats) -> None:
        """Take the noise of a curve from its deviations, so that priors count: its size where that is not stated, and
        how much less it tells where it is correlated.
        """
        points = self.curve.load.size
        deviations, left = deviations[:points], np.linalg.svd(slopes[:points], full_matrices=False)[0]
        if self.curve.error is None:
            freedom = max(points - len(self.parameters), 1)
            self.noise = max(float(np.sqrt(np.sum(np.square(deviations)) / freedom)), LEAST_NOISE)
        self.noise *= (points / correlation_of_noise(left, deviations).effective(points)) ** 0.5
        self._points = {}

    def take(self, begin: Floats, at: list[int], told: tuple[Floats, Floats, Floats]) -> None:
        """Take what other curves tell of the parameters ``at`` these places, and begin the next search elsewhere."""
        matrix, best, spread = told
        every, before = np.zeros((best.size, begin.size)), self.spread.shape[0] - self.told[1].size
        every[:, at] = matrix
        self.begin, self.told, self._points = begin, (every, best), {}
        self.spread = np.eye(before + best.size)
        self.spread[before:, before:] = spread

    def point(self, x: Floats) -> Point:
        """Return the law with these parameters at the measured steps; the last ones are kept, by what is held."""
        held = self.borne, self._rule
        key = x.tobytes(), *map(id, held)
        if key not in self._points:
            if len(self._points) == _KEPT[self.jumps]:
                self._points.clear()
            self._points[key] = self._point(x.copy()), held
        return self._points[key][0]

    def _point(self, x: Floats) -> Point:
        priors, (low, high) = self._from_priors(x), self.bounds
        nothing = Point(x, np.full(self.curve.load.size + priors.size, np.inf), Force(np.empty(0), 0.0, _NOWHERE, None))
        if not ((low <= x) & (x <= high)).all():
            return nothing
        try:
            law = self.force(x, self.curve.values)
        except RoughmdrError as failure:
            self.last_error = failure
            return nothing
        deviations = np.append((law.force + self.baseline(x) - self.curve.load) / self.curve.weight, priors)
        return Point(x, deviations, law) if np.isfinite(deviations).all() else nothing

    def _from_priors(self, x: Floats) -> Floats:
        """Return the deviations from what is known of the parameters otherwise, as if it had been measured."""
        pairs = zip(self.parameters, x.tolist(), strict=True)
        known = [(p.value(each) - p.prior[0]) / p.prior[1] for p, each in pairs if p.prior is not None]
        matrix, best = self.told
        return self.noise * np.append(known, matrix @ x - best)

    def stretch(self, scene: Scene, load: Floats) -> Floats:
        """Return the stretch of the machine's spring by a load [m]."""
        return load * self._area(scene) / (scene.path.machine_stiffness or np.inf)

    def _area(self, scene: Scene) -> float:
        """Return the force over the load: the nominal area [m2] of a pressure."""
        return 1.0 if self.curve.quantity == "force" else scene.nominal_area or np.nan

    def baseline(self, x: Floats) -> Floats:
        """Return what the measurement reads without contact at each step [N or Pa]."""
        return np.asarray(self.baselines @ x)

    def _offset(self, x: Floats) -> float:
        """Return the offset that is added to the measured control [m]."""
        zero = (p.value(float(number)) for p, number in zip(self.parameters, x, strict=True) if p.key == OFFSET)
        return sum(zero, 0.0)


def _control_of(changes: Changes, jumps: list[Jump]) -> Floats:
    """Return the control [m] at each change: on a machine that of the jump that passes it.

    Where none does, no force acts, and the far end of the spring is at the separation.
    """
    control = changes.control.copy()
    for jump in jumps:
        lower, upper = sorted((jump.before, jump.after))
        passed = (changes.step == jump.step - 1) & (lower <= changes.control) & (changes.control <= upper)
        control[passed] = jump.demand
    return control
