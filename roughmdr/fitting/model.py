"""The expected law of a scene at the steps of a measured curve, as a function of the free parameters."""

import copy
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.batch.realization import simulate_realization
from roughmdr.batch.usual_path import machine_path
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError
from roughmdr.expected import force_of_equal_shapes
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.parameters import MACHINE, OFFSET, Parameter, free_parameters
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import set_key
from roughmdr.schema.toml_text import parse_toml
from roughmdr.stages import stages_in

_LEAST_ERROR = 1e-12  # relative error of the force of a contact
_LONGEST_STEP = 0.01  # largest change of x in differences
_JUMP = 0.5  # ratio of the differences to both sides of x, beyond which one of them holds a jump
_LITTLE = 1e-5  # change of x in differences of the positions of jumps
_FINER, _REFINEMENTS = 64, 4  # steps that replace one, and how often, to locate a jump


class Point(NamedTuple):
    """The law with certain parameters."""

    x: Floats
    deviations: Floats
    """Law minus measurement, weighted; inf where the law cannot be computed."""
    error: float
    """Relative error of the law."""
    jumps: tuple[int, ...]
    """The steps after which the contact is made or lost."""


class Jumps(NamedTuple):
    """Where the contact is made and lost along the path, in order."""

    control: Floats
    """[m]"""
    slopes: Floats
    """Derivatives [jump, parameter] of the control."""


_NONE = Point(np.empty(0), np.empty(0), 0.0, ())


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
        alike = scene.asperities.node_count(2) == scene.asperities.node_count(1)
        self._is_plain = alike and scene.interaction is None and not scene.unlike
        self.adheres = scene.work > 0.0
        self.jumps = scene.asperities.equal_heights and self.adheres
        self._path = LoadingPath.along(curve.values, unload=False, adhesive=scene.work > 0.0)
        self.exact = True
        self.evaluations = 0
        self._last = _NONE
        self.last_error: RoughmdrError = OutOfRange("the expected law is not finite")

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
        names += ["stiffness"] * (self.curve.control == "remote")
        law = simulate_realization(scene, self._path_in(scene, x, self.curve.values), 0, names, "expected")
        if not np.isfinite(law.variables[quantity]).all():
            raise OutOfRange("the expected law is not finite")
        return law

    def _load(self, x: Floats, values: Floats) -> tuple[Floats, float, NDArray[np.integer]]:
        """Return the load of the law along a control, its relative error, and a number that changes at each step at
        which asperities of one height make or lose contact; RoughmdrError where there is no law.
        """
        self.evaluations += 1
        scene = self.scene(x)
        path = self._path_in(scene, x, values)
        if not (self._is_plain and isinstance(path, LoadingPath)):
            law = simulate_realization(scene, path, 0, [self.curve.quantity], "expected")
            load = law.variables[self.curve.quantity]
            return load, law.numerical_error, (load != 0.0).astype(np.int64)
        modulus, adhesion = scene.effective_modulus, scene.adhesion_model
        force, error, touching = force_of_equal_shapes(scene.asperities, path, modulus, adhesion)
        area = 1.0 if self.curve.quantity == "force" else scene.nominal_area or np.nan
        return force / area, error, touching

    def _path_in(self, scene: Scene, x: Floats, values: Floats) -> LoadingPath | MachinePath:
        """Return the path of the flat or of its machine in the scene."""
        if self.curve.control == "separation" and values is self.curve.values:
            return self._path.relative_to(-self._offset(x))
        steps = values + self._offset(x)
        if self.curve.control == "remote" and self.exact:
            return machine_path(scene, steps)
        stretch = 0.0 if self.curve.control == "separation" else self._stretch(scene)
        return LoadingPath.along(steps + stretch, unload=False, adhesive=scene.work > 0.0)

    @contextmanager
    def at_measured_separations(self) -> Iterator[None]:
        """Let the spring of a machine bear the measured force: then the separation is known, and the law is fast."""
        self.exact, self._last = False, _NONE
        try:
            yield
        finally:
            self.exact, self._last = True, _NONE

    def deviations(self, x: Floats) -> Floats:
        """Return law minus measurement, weighted; inf where the law cannot be computed, as ``last_error`` says."""
        return self.point(x).deviations

    def point(self, x: Floats) -> Point:
        """Return the law with these parameters at the measured steps."""
        if not np.array_equal(x, self._last.x):
            self._last = self._point(x.copy())
        return self._last

    def _point(self, x: Floats) -> Point:
        try:
            load, error, touching = self._load(x, self.curve.values)
        except RoughmdrError as failure:
            self.last_error = failure
            return Point(x, np.full(self.curve.load.size, np.inf), 0.0, ())
        found = (load - self.curve.load) / self.curve.weight
        if not np.isfinite(found).all():
            return Point(x, np.full(found.size, np.inf), 0.0, ())
        return Point(x, found, error, tuple(_changes(touching).tolist()))

    def jumps_at(self, x: Floats) -> Jumps | None:
        """Return where the contact is made and lost; None where the law, there or nearby, has no or other jumps."""
        if not self.point(x).jumps:
            return None
        changes = np.where(x + _LITTLE > self.bounds[1], -_LITTLE, _LITTLE)
        found = [self._control_of_jumps(each) for each in [x, *(x + np.diag(changes))]]
        if len({each.size for each in found}) > 1 or not found[0].size:
            return None
        return Jumps(found[0], np.stack([each - found[0] for each in found[1:]], axis=1) / changes)

    def _control_of_jumps(self, x: Floats) -> Floats:
        """Return the control [m] at each jump of the contact, in order; empty where the law has none."""
        at = np.array(self._point(x).jumps, dtype=int)
        first, last = self.curve.values[at], self.curve.values[at + 1]
        for _ in range(_REFINEMENTS if at.size else 0):
            apart = np.append(True, (np.diff(first) != 0.0) | (np.diff(at) > 0))  # jumps in different intervals
            between = np.linspace(first[apart], last[apart], _FINER + 1)
            finer = np.insert(self.curve.values, np.repeat(at[apart] + 1, _FINER + 1), between.T.ravel())
            try:
                _, _, touching = self._load(x, finer)
            except RoughmdrError:
                return np.empty(0)
            found = _changes(touching)
            if found.size != at.size:
                return np.empty(0)
            first, last = finer[found], finer[found + 1]
        return np.asarray(0.5 * (first + last))

    def slopes(self, x: Floats) -> Floats:
        """Return the derivatives [step, parameter] of the deviations; RoughmdrError where the law has none.

        The step of the differences is the best one, the cube root of the error of the law.
        """
        middle = self.point(x)
        step = min(max(middle.error, _LEAST_ERROR) ** (1.0 / 3.0), _LONGEST_STEP)
        return np.stack([self._slope(middle, step * direction) for direction in np.eye(x.size)], axis=1)

    def _slope(self, middle: Point, change: Floats) -> Floats:
        """Return the derivative in one direction from the differences to both sides, or to the one with a law.

        Where a contact jumps within one of them, the other, which is much smaller, is taken alone.
        """
        x, here = middle.x, middle.deviations
        pair = np.array([self._point(x + change).deviations - here, here - self._point(x - change).deviations])
        pair = pair[np.isfinite(pair).all(axis=1)] / change.sum()
        if not pair.size:
            raise self.last_error
        sizes = np.abs(pair)
        smaller = np.where(sizes[0] < sizes[-1], pair[0], pair[-1])
        return np.asarray(np.where(sizes.min(axis=0) < _JUMP * sizes.max(axis=0), smaller, pair.mean(axis=0)))

    def _stretch(self, scene: Scene) -> Floats:
        """Return the stretch of the machine's spring by the measured force [m]."""
        area = scene.nominal_area if self.curve.quantity == "pressure" else None
        return self.curve.load * (1.0 if area is None else area) / (scene.path.machine_stiffness or np.inf)

    def on_machine(self, x: Floats, law: LoadSeparation, change: Floats) -> Floats:
        """Return the change of the load at the measured control that a ``change`` at given separation makes.

        A spring of stiffness k yields: with contacts of stiffness S the change is k/(k + S) times as large.
        """
        if self.curve.control == "separation":
            return change
        spring, contacts = self.scene(x).path.machine_stiffness, law.variables["stiffness"]
        if spring is None:
            return change
        stiffness = np.where(contacts > -spring, contacts, np.inf)  # contacts jump there
        return np.asarray(change * spring / (spring + stiffness))

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


def _changes(touching: NDArray[np.integer]) -> NDArray[np.intp]:
    """Return the steps after which contact is made or lost, each as often as that happens there."""
    changes = np.abs(np.diff(touching))
    return np.repeat(np.arange(changes.size), changes)


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
