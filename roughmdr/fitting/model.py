"""The expected law of a scene at the steps of a measured curve, as a function of the free parameters."""

import copy
from collections.abc import Iterator
from contextlib import contextmanager
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
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import set_key
from roughmdr.schema.toml_text import parse_toml


class Point(NamedTuple):
    """The law with certain parameters."""

    x: Floats
    deviations: Floats
    """Law minus measurement, weighted; inf where the law cannot be computed."""
    law: Force
    """Empty where it cannot be computed."""

    @property
    def jumps(self) -> tuple[int, ...]:
        """The steps after which the contact is made or lost."""
        return tuple(self.law.changes.step.tolist())


LEAST_NOISE = 1e-12  # least noise over the largest load: of a curve without any, that of rounding
_NOWHERE = Changes(np.empty(0, dtype=np.int64), np.empty(0))
_NONE = Point(np.full(1, np.nan), np.empty(0), Force(np.empty(0), 0.0, _NOWHERE, None))


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
        self._table = parse_toml(scene.toml)
        self.curve = curve._replace(level=curve.far) if any(key.startswith("baseline") for key in free) else curve
        self.parameters: list[Parameter] = free_parameters(free, scene, self._table, self.curve, known)
        self.baselines = baselines(self.parameters, self.curve)
        """Load per x of each parameter without contact [step, parameter]."""
        self.bounds: tuple[Floats, Floats] = tuple(np.transpose([each.bounds for each in self.parameters]))
        self._is_plain = scene.interaction is None and not scene.unlike
        self.adheres = scene.work > 0.0
        self.jumps = scene.asperities.equal_heights and self.adheres
        self._path = LoadingPath.along(curve.values, unload=False, adhesive=scene.work > 0.0)
        self.borne: Floats | None = None
        """Load that the spring of a machine bears where it is given; None where it is that of the law."""
        self._rule: ForceRule | None = None
        self.near: Spring | None = None
        """How the load on a machine changes near the last parameters whose slopes were found, where it does not jump.
        """
        self.noise = 0.0 if curve.error is None else 1.0
        """Standard deviation of the noise in units of the deviations; priors count from when it is known."""
        count = len(self.parameters)
        self.begin, self.told = np.zeros(count), (np.empty((0, count)), np.empty(0))
        """Where the search begins, and what other curves tell: A x = b."""
        self.spread = np.eye(sum(each.prior is not None for each in self.parameters))
        """A square root of the covariance of what is known otherwise, by priors and by other curves."""
        self.evaluations = 0
        self._last, self._read = _NONE, (np.empty(0), scene)
        self.last_error: RoughmdrError = OutOfRange("the expected law is not finite")

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
        own = np.array([0.0 if p.key in OF_THE_CURVE else each for p, each in zip(self.parameters, x, strict=True)])
        if not np.array_equal(own, self._read[0]):
            self._read = own, read(self._with(x))
        return self._read[1]

    def fitted(self, x: Floats) -> Scene:
        """Return the scene with these parameters along the whole path, whose run is the fitted law."""
        table = self._with(x)
        table["path"][self.curve.control] = (self.curve.values + self._offset(x)).tolist()
        table["batch"] = {"estimator": "expected"}
        return read(table)

    def law(self, x: Floats) -> LoadSeparation:
        """Return the law with these parameters; RoughmdrError where there is none."""
        scene, quantity = self.scene(x), self.curve.quantity
        names = [quantity] if scene.nominal_area is None else [quantity, "model_error_curve"]
        law = simulate_realization(scene, self._path_in(scene, x, self.curve.values), 0, names, "expected")
        if not np.isfinite(law.variables[quantity]).all():
            raise OutOfRange("the expected law is not finite")
        return law

    def force(self, x: Floats, values: Floats) -> Force:
        """Return the force, or pressure, of the law along a control; RoughmdrError where there is no law."""
        if self.borne is None and self.near is not None and values is self.curve.values:
            first = self._borne_by(x, self.near.load, None)
            load = self.near.found(first.force, lambda load: self._borne_by(x, load, first.rule).force)
            if load is not None:
                return first._replace(force=load)
        self.evaluations += 1
        scene = self.scene(x)
        path, jumps = self._path_in(scene, x, values), list[Jump]()
        if self._is_plain and isinstance(path, MachinePath) and scene.asperities.all_alike:
            problem = Problem(scene.asperities.ensemble(0, 0), scene.effective_modulus, scene.adhesion_model)
            separation, jumps = separations_of(problem, path.machine, path.demand, jumps=self.jumps)
            path = LoadingPath.along(separation, unload=False, adhesive=path.adhesive)
        if not (self._is_plain and isinstance(path, LoadingPath)):
            law = simulate_realization(scene, path, 0, [self.curve.quantity], "expected")
            return Force(law.variables[self.curve.quantity], law.numerical_error, _NOWHERE, None)
        own = scene.asperities, path, scene.effective_modulus, scene.adhesion_model
        found = expected_force(*own, self._rule)
        changes = found.changes._replace(control=_control_of(found.changes, jumps) - self._offset(x))
        return found._replace(force=found.force / self._area(scene), changes=changes)

    def slopes(self, x: Floats, rule: ForceRule | None) -> Slopes | None:
        """Return the derivatives of the force at the separations that the law has; None where other numbers matter."""
        scene = self.scene(x)
        path = self._path_in(scene, x, self.curve.values)
        if not (self._is_plain and isinstance(path, LoadingPath)):
            return None
        own = scene.asperities, path, scene.effective_modulus, scene.adhesion_model
        try:
            found = expected_slopes(*own, rule)
        except OutOfRange:  # the stiffness is infinite where contact is lost
            return None
        if found is None:
            return None
        self.evaluations += 1
        return Slopes(*(each / self._area(scene) for each in found))

    def _borne_by(self, x: Floats, load: Floats, rule: ForceRule | None) -> Force:
        """Return the law where the spring of the machine bears another."""
        with self.held(load=load, rule=rule):
            return self.force(x, self.curve.values)

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
        before, self.borne, self._rule, self._last = (self.borne, self._rule, self._last), load, rule, _NONE
        try:
            yield
        finally:
            self.borne, self._rule, self._last = before

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
        self._last = _NONE

    def take(self, begin: Floats, at: list[int], told: tuple[Floats, Floats, Floats]) -> None:
        """Take what other curves tell of the parameters ``at`` these places, and begin the next search elsewhere."""
        matrix, best, spread = told
        every, before = np.zeros((best.size, begin.size)), self.spread.shape[0] - self.told[1].size
        every[:, at] = matrix
        self.begin, self.told, self._last = begin, (every, best), _NONE
        self.spread = np.eye(before + best.size)
        self.spread[before:, before:] = spread

    def deviations(self, x: Floats) -> Floats:
        """Return law minus measurement, weighted; inf where the law cannot be computed, as ``last_error`` says."""
        return self.point(x).deviations

    def point(self, x: Floats) -> Point:
        """Return the law with these parameters at the measured steps."""
        if not np.array_equal(x, self._last.x):
            self._last = self.point_at(x.copy())
        return self._last

    def point_at(self, x: Floats) -> Point:
        """Return the law with these parameters, which is not kept."""
        far = np.full(self.curve.load.size + len(self._from_priors(x)), np.inf)
        nothing = _NONE._replace(x=x, deviations=far)
        try:
            law = self.force(x, self.curve.values)
        except RoughmdrError as failure:
            self.last_error = failure
            return nothing
        measured = (law.force + self.baseline(x) - self.curve.load) / self.curve.weight
        found = np.append(measured, self._from_priors(x))
        if not np.isfinite(found).all():
            return nothing
        return Point(x, found, law)

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

    def _with(self, x: Floats) -> dict[str, Any]:
        table = copy.deepcopy(self._table)
        for parameter, number in zip(self.parameters, x, strict=True):
            if parameter.key not in OF_THE_CURVE:
                set_key(table, parameter.key, parameter.value(float(number)))
        return table


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
