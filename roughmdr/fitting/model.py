"""The expected law of a scene at the steps of a measured curve, as a function of the free parameters."""

import copy
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.batch.realization import simulate_realization
from roughmdr.batch.usual_path import machine_path
from roughmdr.errors import OutOfRange, RoughmdrError, SceneError
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.parameters import MACHINE, OFFSET, Parameter, free_parameters
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import set_key
from roughmdr.schema.toml_text import parse_toml

_NONE: tuple[Floats, Floats] = np.empty(0), np.empty(0)
_STEP = 1e-4  # of x, in differences
_FINE_STEP = 1e-3  # where the difference is a central one


class Model:
    """The expected law at the measured steps; ``x`` are the free parameters as they are sought."""

    def __init__(self, scene: Scene, curve: MeasuredCurve, free: list[str]) -> None:
        if reason := scene.reason_against("expected"):
            raise SceneError(f"scene: cannot be fitted, for it has no expected law: {reason}")
        if curve.quantity == "pressure" and scene.nominal_area is None:
            raise SceneError(
                f"{curve.origin}: pressure needs a nominal area in the scene: asperities.patch, and no [nominal]"
            )
        self._table = parse_toml(scene.toml)
        self.curve = curve
        self.parameters: list[Parameter] = free_parameters(free, scene, self._table, curve)
        self.exact = True
        self.evaluations = 0
        self._last = _NONE
        self.last_error: RoughmdrError = OutOfRange("the expected law is not finite")

    def scene(self, x: Floats) -> Scene:
        """Return the scene with these parameters; SceneError where it does not allow them."""
        return read(self._with(x))

    def fitted(self, x: Floats) -> Scene:
        """Return the scene with these parameters along the whole path, whose run is the fitted law."""
        table = self._with(x)
        table["path"][self.curve.control] = self._steps(x).tolist()
        table["batch"] = {"estimator": "expected"}
        return read(table)

    def law(self, x: Floats) -> LoadSeparation:
        """Return the law with these parameters; RoughmdrError where there is none."""
        self.evaluations += 1
        scene, steps, quantity = self.scene(x), self._steps(x), self.curve.quantity
        names = [quantity] if scene.nominal_area is None else [quantity, "model_error_curve"]
        path: LoadingPath | MachinePath
        if self.curve.control == "remote" and self.exact:
            path = machine_path(scene, steps)
        else:
            along = steps if self.curve.control == "separation" else steps + self._stretch(scene)
            path = LoadingPath.along(along, unload=False, adhesive=scene.work > 0.0)
        law = simulate_realization(scene, path, 0, names, "expected")
        if not np.isfinite(law.variables[quantity]).all():
            raise OutOfRange("the expected law is not finite")
        return law

    @contextmanager
    def at_measured_separations(self) -> Iterator[None]:
        """Let the spring of a machine bear the measured force: the separation is known then, and the law soon found."""
        self.exact, self._last = False, _NONE
        try:
            yield
        finally:
            self.exact, self._last = True, _NONE

    def deviations(self, x: Floats) -> Floats:
        """Return law minus measurement, weighted; inf where the law cannot be computed, as ``last_error`` says."""
        if not np.array_equal(x, self._last[0]):
            self._last = x.copy(), self._deviations(x)
        return self._last[1]

    def _deviations(self, x: Floats) -> Floats:
        try:
            load = self.law(x).variables[self.curve.quantity]
        except RoughmdrError as error:
            self.last_error = error
            return np.full(self.curve.load.size, np.inf)
        return np.asarray((load - self.curve.load) / self.curve.weight)

    def slopes(self, x: Floats) -> Floats:
        """Return the derivatives [step, parameter] of the deviations for the search, one evaluation each."""
        return self._slopes(x, _STEP, central=False)

    def fine_slopes(self, x: Floats) -> Floats:
        """Return them with the error of a central difference, two evaluations each."""
        return self._slopes(x, _FINE_STEP, central=True)

    def _slopes(self, x: Floats, step: float, *, central: bool) -> Floats:
        columns = [self._slope(x, step * direction, central=central) for direction in np.eye(x.size)]
        return np.stack(columns, axis=1)

    def _slope(self, x: Floats, change: Floats, *, central: bool) -> Floats:
        """Return the derivative in one direction; to one side where the law ends, RoughmdrError where it has none."""
        ends = list[tuple[float, Floats]]()
        for side in (1.0, -1.0):
            end = self.deviations(x + side * change)
            if np.isfinite(end).all():
                ends.append((side * float(change.sum()), end))
            if ends and not central:
                break
        if not ends:
            raise self.last_error
        (first, above), (second, below) = [*ends, (0.0, self.deviations(x))][:2]
        return np.asarray((above - below) / (first - second))

    def _stretch(self, scene: Scene) -> Floats:
        """Return by how much the measured force stretches the spring of the machine [m]."""
        area = scene.nominal_area if self.curve.quantity == "pressure" else None
        return self.curve.load * (1.0 if area is None else area) / (scene.path.machine_stiffness or np.inf)

    def _steps(self, x: Floats) -> Floats:
        """Return the control at each step in the scene [m]."""
        zero = [p.value(float(number)) for p, number in zip(self.parameters, x, strict=True) if p.key == OFFSET]
        return self.curve.values + sum(zero)

    def _with(self, x: Floats) -> dict[str, Any]:
        table = copy.deepcopy(self._table)
        for parameter, number in zip(self.parameters, x, strict=True):
            if parameter.key != OFFSET:
                set_key(table, parameter.key, parameter.value(float(number)))
        return table


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
        if "nominal" in table:  # which has no other law than the expected one
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
