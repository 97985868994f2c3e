"""The expected law of a scene at the steps of a measured curve, as a function of the free parameters."""

import copy
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath, LoadSeparation, Problem
from roughmdr.aggregate.under_machine import separations_of
from roughmdr.batch.realization import simulate_realization
from roughmdr.batch.usual_path import machine_path
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError
from roughmdr.expected import ForceRule, expected_force
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.parameters import MACHINE, OFFSET, Parameter, free_parameters
from roughmdr.fitting.spring import Spring
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import set_key
from roughmdr.schema.toml_text import parse_toml
from roughmdr.stages import stages_in


class Load(NamedTuple):
    """The load of the law at the steps of a control."""

    load: Floats
    """[N or Pa]"""
    error: float
    """Relative error of the law."""
    touching: NDArray[np.integer]
    """A number that changes at each step at which asperities of one height make or lose contact."""
    rule: ForceRule | None = None
    """The rule over shape parameters by which it was found, where there is one."""


class Point(NamedTuple):
    """The law with certain parameters."""

    x: Floats
    deviations: Floats
    """Law minus measurement, weighted; inf where the law cannot be computed."""
    error: float
    """Relative error of the law."""
    jumps: tuple[int, ...]
    """The steps after which the contact is made or lost."""
    load: Floats
    """[N or Pa]; empty where the law cannot be computed."""
    rule: ForceRule | None = None
    """The rule over shape parameters by which the law was found, where there is one."""


_NONE = Point(np.empty(0), np.empty(0), 0.0, (), np.empty(0))


class Model:
    """The expected law at the measured steps as a function of x, one number for each free parameter."""

    def __init__(self, scene: Scene, curve: MeasuredCurve, free: list[str]) -> None:
        if reason := scene.reason_against("expected"):
            raise SceneError(f"scene: cannot be fitted, for it has no expected law: {reason}")
        if curve.quantity == "pressure" and scene.nominal_area is None:
            raise SceneError(
                f"{curve.origin}: pressure needs a nominal area in the scene: asperities.patch, and a flat"
            )
        self._start, self._free = scene, free
        self._table = parse_toml(scene.toml)
        self.curve = curve
        self.parameters: list[Parameter] = free_parameters(free, scene, self._table, curve)
        self.bounds: tuple[Floats, Floats] = tuple(np.transpose([each.bounds for each in self.parameters]))
        self._is_plain = scene.interaction is None and not scene.unlike
        self.adheres = scene.work > 0.0
        self.jumps = scene.asperities.equal_heights and self.adheres
        self._path = LoadingPath.along(curve.values, unload=False, adhesive=scene.work > 0.0)
        self.borne: Floats | None = None
        """Load that the spring of a machine bears, where it is not that of the law."""
        self._rule: ForceRule | None = None
        self.near: Spring | None = None
        """How the load on a machine changes near the last parameters whose slopes were found, where it does not jump.
        """
        self.evaluations = 0
        self._last = _NONE
        self.last_error: RoughmdrError = OutOfRange("the expected law is not finite")

    @property
    def exact(self) -> bool:
        """Whether the spring of a machine bears the load of the law, not one that is given."""
        return self.borne is None

    def backwards(self) -> "Model":
        """Return the model of the curve as if it had been measured from its end."""
        return Model(self._start, self.curve.backwards(), self._free)

    def scene(self, x: Floats) -> Scene:
        """Return the scene with these parameters; SceneError where it does not allow them."""
        return read(self._with(x))

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

    def load(self, x: Floats, values: Floats) -> Load:
        """Return the load of the law along a control; RoughmdrError where there is no law."""
        if self.exact and self.near is not None and values is self.curve.values:
            first = self._borne_by(x, self.near.load, None)
            load = self.near.found(first.load, lambda load: self._borne_by(x, load, first.rule).load)
            if load is not None:
                return first._replace(load=load)
        self.evaluations += 1
        scene = self.scene(x)
        path = self._path_in(scene, x, values)
        if self._is_plain and isinstance(path, MachinePath) and scene.asperities.all_alike:
            path = path_under_machine(scene, path)
        if not (self._is_plain and isinstance(path, LoadingPath)):
            law = simulate_realization(scene, path, 0, [self.curve.quantity], "expected")
            load = law.variables[self.curve.quantity]
            return Load(load, law.numerical_error, (load != 0.0).astype(np.int64))
        own = scene.asperities, path, scene.effective_modulus, scene.adhesion_model
        force, error, touching, rule = expected_force(*own, self._rule)
        return Load(force / self._area(scene), error, touching, rule)

    def _borne_by(self, x: Floats, load: Floats, rule: ForceRule | None) -> Load:
        """Return the load of the law where the spring of the machine bears another."""
        with self.held(load=load, rule=rule):
            return self.load(x, self.curve.values)

    def _path_in(self, scene: Scene, x: Floats, values: Floats) -> LoadingPath | MachinePath:
        """Return the path of the flat or of its machine in the scene."""
        if self.curve.control == "separation" and values is self.curve.values:
            return self._path.relative_to(-self._offset(x))
        steps = values + self._offset(x)
        if self.curve.control == "remote" and self.exact:
            return machine_path(scene, steps)
        stretch = 0.0 if self.borne is None else self.stretch(scene, self.borne)
        return LoadingPath.along(steps + stretch, unload=False, adhesive=scene.work > 0.0)

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

    def deviations(self, x: Floats) -> Floats:
        """Return law minus measurement, weighted; inf where the law cannot be computed, as ``last_error`` says."""
        return self.point(x).deviations

    def point(self, x: Floats) -> Point:
        """Return the law with these parameters at the measured steps."""
        if not np.array_equal(x, self._last.x):
            self._last = self.point_at(x.copy())
        return self._last

    def point_at(self, x: Floats) -> Point:
        """Return likewise the law, which is not kept."""
        nothing = Point(x, np.full(self.curve.load.size, np.inf), 0.0, (), np.empty(0))
        try:
            load, error, touching, rule = self.load(x, self.curve.values)
        except RoughmdrError as failure:
            self.last_error = failure
            return nothing
        found = (load - self.curve.load) / self.curve.weight
        if not np.isfinite(found).all():
            return nothing
        return Point(x, found, error, tuple(changes_of(touching).tolist()), load, rule)

    def stretch(self, scene: Scene, load: Floats) -> Floats:
        """Return the stretch of the machine's spring by a load [m]."""
        return load * self._area(scene) / (scene.path.machine_stiffness or np.inf)

    def _area(self, scene: Scene) -> float:
        """Return the force over the load: the nominal area [m2] of a pressure."""
        return 1.0 if self.curve.quantity == "force" else scene.nominal_area or np.nan

    def _offset(self, x: Floats) -> float:
        """Return the offset that is added to the measured control [m]."""
        zero = (p.value(float(number)) for p, number in zip(self.parameters, x, strict=True) if p.key == OFFSET)
        return sum(zero, 0.0)

    def _with(self, x: Floats) -> dict[str, Any]:
        table = copy.deepcopy(self._table)
        for parameter, number in zip(self.parameters, x, strict=True):
            if parameter.key != OFFSET:
                set_key(table, parameter.key, parameter.value(float(number)))
        return table


def changes_of(touching: NDArray[np.integer]) -> NDArray[np.intp]:
    """Return the steps after which contact is made or lost, each as often as that happens there."""
    changes = np.abs(np.diff(touching))
    return np.repeat(np.arange(changes.size), changes)


def path_under_machine(scene: Scene, path: MachinePath) -> LoadingPath:
    """Return the path of the flat whose asperities are all alike."""
    problem = Problem(scene.asperities.ensemble(0, 0), scene.effective_modulus, scene.adhesion_model)
    separation, _ = separations_of(problem, path.machine, path.demand)
    return LoadingPath.along(separation, unload=False, adhesive=path.adhesive)


def scene_to_fit(source: Any, changes: Any, curve: MeasuredCurve, free: list[str]) -> Scene:
    """Return the scene of a curve: the path begins as measured, and nothing is swept; SceneError where it is wrong.

    A free key that is swept has its first value.
    """

    def amend(table: dict[str, Any]) -> None:
        path, sweep = table.get("path"), table.pop("sweep", {})
        steps: dict[str, Any] = {curve.control: [float(curve.values[0])]}
        if curve.control == "remote" and isinstance(path, dict) and "machine_stiffness" in path:
            steps["machine_stiffness"] = path["machine_stiffness"]
        table["path"] = steps
        for section in ("batch", "accuracy"):
            table.pop(section, None)
        if not all(stage.flat for stage in stages_in(table)):  # else there is no law but the expected one
            table["batch"] = {"estimator": "expected"}
        for key, entries in sweep.items() if isinstance(sweep, dict) else ():
            if key in free:
                _set_first(table, key, entries)
            elif key != "mode" and (key == MACHINE or not key.startswith("path.")):
                raise SceneError(
                    f"sweep.{key}: a curve is of one scene; free the key, or fix it with --set {key}=VALUE"
                )

    return read(source, changes, amend)


def _set_first(table: dict[str, Any], key: str, entries: Any) -> None:
    """Set a swept key that the scene leaves out to the first of its entries."""
    inner: Any = table
    for part in key.split("."):
        inner = inner.get(part) if isinstance(inner, dict) else None
    if isinstance(entries, dict):
        entries = entries.get("linspace", entries.get("logspace"))
    if inner is None and isinstance(entries, list) and entries:
        set_key(table, key, entries[0])
