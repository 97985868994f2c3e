"""The free parameters of a fit: numbers of the scene, positive ones by their logarithm, and the zero of the control."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.scene.keys import key_readers, must_be_positive, number_at
from roughmdr.scene.sweep import SECTIONS
from roughmdr.schema.quantities import Quantity, Reader
from roughmdr.schema.units import as_text
from roughmdr.schema.wording import short_repr
from roughmdr.stages import STAGES
from roughmdr.variables import plain_name

OFFSET = "offset"
"""The separation, or position of the far end, of the scene where the measurement reads 0."""
BASELINE, BASELINE_SLOPE = "baseline", "baseline_slope"
"""The load that the measurement reads at its first row without contact, and its change per metre of the control."""
MACHINE = "path.machine_stiffness"
_FITTED = {*SECTIONS} - {stage.key for stage in STAGES if not stage.fitted}  # on which a normal law depends
_WIDEST = math.log(1e4)  # bound of |x| of a logarithm: a factor of 10^4 from the start
_FARTHEST = 1e4  # bound of |x| of other numbers: 10^4 scales from the start
AT_BOUND = 1e-3
"""Distance of x from a bound within which it is there."""
_NEARBY = math.log(5.0)  # largest |x| of other starts of a logarithm: a factor of 5


class Parameter(NamedTuple):
    """A free parameter p(x) = start exp(x) if it must stay positive, else start + scale x; the search begins at 0."""

    key: str
    unit: str
    start: float
    scale: float
    """Scale in the unit of the parameter; 0 where the logarithm is fitted."""
    bounds: tuple[float, float] = (-_WIDEST, _WIDEST)
    """Bounds of x."""
    nearby: tuple[float, float] = (-_NEARBY, _NEARBY)
    """Range of x from which other starts are drawn."""
    prior: tuple[float, float] | None = None
    """Mean and standard deviation of what is known of the number beforehand."""

    @property
    def name(self) -> str:
        """The name of the variable in the result."""
        return plain_name(self.key)

    @property
    def logarithmic(self) -> bool:
        """Whether the logarithm is fitted."""
        return self.scale == 0.0

    def bound_met(self, x: float) -> str:
        """Return that the search ended at a bound, in words; empty where it did not."""
        if min(x - self.bounds[0], self.bounds[1] - x) >= AT_BOUND:
            return ""
        far = ", far from where it started: are all units right?" * (abs(x) > _WIDEST - 2.0 * AT_BOUND)
        return f"{self.key} ended at the bound of what is allowed, {self.value(x):g}{far}"

    def value(self, x: float) -> float:
        """Return the number in SI."""
        x = min(max(x, self.bounds[0]), self.bounds[1])
        return self.start * math.exp(x) if self.logarithmic else self.start + self.scale * x

    def x(self, value: float) -> float:
        """Return the x of a number within the bounds of its sign."""
        if not self.logarithmic:
            return (value - self.start) / self.scale
        return math.log(value / self.start) if value > 0.0 else -_WIDEST

    def per_x(self, x: float) -> float:
        """Return the derivative of the number with respect to x."""
        return self.value(x) if self.logarithmic else self.scale


class Known(NamedTuple):
    """Knowledge of free parameters from elsewhere: pairs of numbers, in SI or with units, by their keys."""

    bounds: Mapping[str, Any] = {}
    """Low and high."""
    priors: Mapping[str, Any] = {}
    """Mean and standard deviation."""


def free_parameters(
    free: list[str], scene: Scene, table: dict[str, Any], curve: MeasuredCurve, known: Known = Known()
) -> list[Parameter]:
    """Return the parameters with these keys; SceneError, with all faults, where a key cannot be fitted."""
    readers = {
        key: reader
        for key, reader in key_readers([Scene], table)
        if key.split(".")[0] in _FITTED or (key == MACHINE and curve.control == "remote")
    }
    parameters, faults = [], []
    for position, key in enumerate(free):
        try:
            if key in free[:position]:
                raise RoughmdrError("is given twice")
            own = OF_THE_CURVE.get(key)
            parameter = own(scene, curve) if own else _parameter(key, readers, table, curve)
            parameters.append(_with_known(parameter, readers.get(key, Quantity(parameter.unit)), known))
        except RoughmdrError as error:
            faults.append(Fault(key, "", str(error), "free"))
    faults += [Fault(key, "", "is not free", "bounds, priors") for each in known for key in each if key not in free]
    if faults:
        raise SceneError.of(faults)
    return parameters


def _parameter(key: str, readers: dict[str, Reader], table: dict[str, Any], curve: MeasuredCurve) -> Parameter:
    reader, start = number_at(key, readers, table, tuple(OF_THE_CURVE))
    above, at_least, high = (getattr(reader, end, None) for end in ("above", "at_least", "at_most"))
    low = at_least if above is None else above
    if must_be_positive(reader, start):
        if not start > 0.0:
            raise RoughmdrError(f"is {start:g}; it must start above 0")
        most = _WIDEST if high is None else math.log(high / start)
        return Parameter(key, reader.dimension, start, 0.0, (-_WIDEST, min(most, _WIDEST)))
    scale = length_scale(curve) if reader.dimension == "m" else abs(start) or 1.0
    ends = [None if end is None else (end - start) / scale for end in (low, high)]
    bounds = max(-_FARTHEST, -_FARTHEST if ends[0] is None else ends[0]), ends[1] if ends[1] is not None else _FARTHEST
    return Parameter(key, reader.dimension, start, scale, bounds, (-1.0, 1.0))


def _with_known(parameter: Parameter, reader: Reader, known: Known) -> Parameter:
    """Return a parameter with its prior and its bounds, between which it starts."""
    key = parameter.key
    if key in known.priors:
        prior = _pair("prior", known.priors[key], (reader, Quantity(reader.dimension, above=0.0)))
        parameter = parameter._replace(prior=prior)
    if key not in known.bounds:
        return parameter
    low, high = _pair("bounds", known.bounds[key], (reader, reader))
    if not low < high:
        raise RoughmdrError(f"has the bounds {low:g} and {high:g}; the first must be below the second")
    if not low <= parameter.start <= high:
        middle = math.sqrt(low * high) if parameter.logarithmic and low > 0.0 else 0.5 * (low + high)
        parameter = parameter._replace(start=middle)
    low, high = parameter.x(low), parameter.x(high)
    nearby = min(max(parameter.nearby[0], low), high), min(max(parameter.nearby[1], low), high)
    return parameter._replace(bounds=(low, high), nearby=nearby)


def _pair(name: str, given: Any, readers: tuple[Reader, Reader]) -> tuple[float, float]:
    """Return two numbers in SI that a user gave; RoughmdrError where they are none."""
    given = given.tolist() if isinstance(given, np.ndarray) else given
    given = as_text(given) if hasattr(given, "magnitude") else given
    if not (isinstance(given, list | tuple) and len(given) == 2 and not any(isinstance(one, dict) for one in given)):
        raise RoughmdrError(f"has {name} = {short_repr(given)}; expected two numbers")
    try:
        found = [read(one) for read, one in zip(readers, given, strict=True)]
        first, second = (float(getattr(one, "constant", one)) for one in found)
    except RoughmdrError as error:
        hint = "; give the number itself, not a percentage" * ("%" in str(given))
        raise RoughmdrError(f"has {name} = {short_repr(given)}: {error}{hint}") from None
    return first, second


def _offset(scene: Scene, curve: MeasuredCurve) -> Parameter:
    """Return the zero of the control, sought where the highest asperities are touched along the path, or were before
    it within six standard deviations of their heights.
    """
    scale, source = length_scale(curve), scene.asperities
    highest, closest = float(source.extremes(1e-3).height.max()), float(curve.values.min())
    way = max(float(np.ptp(curve.values)), 6.0 * source.sigma if source.sigma < math.inf else 0.0)
    nearby = (highest - closest - way) / scale, (highest - closest) / scale
    bounds = min(nearby[0], 0.0) - _FARTHEST, max(nearby[1], 0.0) + _FARTHEST
    return Parameter(OFFSET, "m", 0.0, scale, bounds, nearby)


def _baseline(scene: Scene, curve: MeasuredCurve) -> Parameter:
    """Return the constant of the baseline; other searches start where the curve is far from contact."""
    far = curve.far / curve.largest
    return Parameter(BASELINE, curve.unit, 0.0, curve.largest, (-_FARTHEST, _FARTHEST), (far, far))


def _baseline_slope(scene: Scene, curve: MeasuredCurve) -> Parameter:
    """Return the slope of the baseline, which hardly matters where a search starts."""
    scale = curve.largest / float(np.ptp(curve.values))
    return Parameter(BASELINE_SLOPE, f"{curve.unit}/m", 0.0, scale, (-_FARTHEST, _FARTHEST), (0.0, 0.0))


def baselines(parameters: list[Parameter], curve: MeasuredCurve) -> Floats:
    """Return the load per x of each parameter without contact, [step, parameter]; 0 for all but the baseline's."""
    along = {BASELINE: np.ones_like(curve.values), BASELINE_SLOPE: curve.values - curve.values[0]}
    rows = [each.scale * along.get(each.key, np.zeros_like(curve.values)) for each in parameters]
    return np.stack(rows, axis=1) if rows else np.empty((curve.values.size, 0))


OF_THE_CURVE = {OFFSET: _offset, BASELINE: _baseline, BASELINE_SLOPE: _baseline_slope}
"""Parameters of the measurement, which are no keys of the scene."""


def length_scale(curve: MeasuredCurve) -> float:
    """Return the length [m] over which the measured load changes: the range of the control times the mean load over the
    largest.
    """
    return float(np.ptp(curve.values) * np.abs(curve.load - curve.level).mean() / curve.largest)
