"""The free parameters of a fit: numbers of the scene, positive ones by their logarithm, and the zero of the control."""

import math
from functools import reduce
from operator import getitem
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.scene import Scene
from roughmdr.scene.keys import key_readers
from roughmdr.scene.sweep import SECTIONS
from roughmdr.schema.quantities import Reader, WholeNumber
from roughmdr.schema.wording import short_repr, suggestion
from roughmdr.stages import STAGES

OFFSET = "offset"
"""The separation, or position of the far end, of the scene where the measurement reads 0."""
MACHINE = "path.machine_stiffness"
_FITTED = {*SECTIONS} - {stage.key for stage in STAGES if not stage.fitted}  # on which a normal law depends
_WIDEST = math.log(1e4)  # bound of |x| of a logarithm: a factor of 10^4 from the start
_FARTHEST = 1e4  # bound of |x| of other numbers: 10^4 scales from the start
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

    @property
    def name(self) -> str:
        """The name of the variable in the result."""
        return self.key.replace(".", "_")

    @property
    def logarithmic(self) -> bool:
        """Whether the logarithm is fitted."""
        return self.scale == 0.0

    def value(self, x: float) -> float:
        """Return the number in SI."""
        x = min(max(x, self.bounds[0]), self.bounds[1])
        return self.start * math.exp(x) if self.logarithmic else self.start + self.scale * x

    def per_x(self, x: float) -> float:
        """Return the derivative of the number with respect to x."""
        return self.value(x) if self.logarithmic else self.scale


def free_parameters(free: list[str], scene: Scene, table: dict[str, Any], curve: MeasuredCurve) -> list[Parameter]:
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
            is_offset = key == OFFSET
            parameters.append(_offset(scene, curve) if is_offset else _parameter(key, readers, table, scene, curve))
        except RoughmdrError as error:
            faults.append(Fault(key, "", str(error), "free"))
    if not free:
        faults.append(Fault("free", "", "names no key; expected some like adhesion.work, material.modulus"))
    if faults:
        raise SceneError.of(faults)
    return parameters


def _parameter(
    key: str, readers: dict[str, Reader], table: dict[str, Any], scene: Scene, curve: MeasuredCurve
) -> Parameter:
    reader = readers.get(key)
    if reader is None or not reader.dimension:
        numeric = sorted(name for name, each in readers.items() if each.dimension and _entry(name, table) is not None)
        raise RoughmdrError(f"is no number of the scene that can be fitted{suggestion(key, [*numeric, OFFSET])}")
    entry = _entry(key, table)
    if entry is None:
        raise RoughmdrError("is not in the scene; give it there, with a value to start from")
    if isinstance(reader, WholeNumber):
        raise RoughmdrError("takes whole numbers only, which a fit cannot vary")
    if isinstance(entry, dict | list):
        raise RoughmdrError(f"is {short_repr(entry)}; name one number in it, like {key}.mean")
    read = reader(entry)
    start = float(getattr(read, "constant", read))
    above, at_least, high = (getattr(reader, end, None) for end in ("above", "at_least", "at_most"))
    low = at_least if above is None else above
    if _refuses(reader, -abs(start) or -1.0) and low in (None, 0.0):
        if not start > 0.0:
            raise RoughmdrError(f"is {start:g}; it must start above 0")
        most = _WIDEST if high is None else math.log(high / start)
        return Parameter(key, reader.dimension, start, 0.0, (-_WIDEST, min(most, _WIDEST)))
    scale = length_scale(scene, curve) if reader.dimension == "m" else abs(start) or 1.0
    ends = [None if end is None else (end - start) / scale for end in (low, high)]
    bounds = max(-_FARTHEST, -_FARTHEST if ends[0] is None else ends[0]), ends[1] if ends[1] is not None else _FARTHEST
    return Parameter(key, reader.dimension, start, scale, bounds, (-1.0, 1.0))


def _offset(scene: Scene, curve: MeasuredCurve) -> Parameter:
    """Return the zero of the control, sought where the highest asperities are touched along the path, or were before
    it within six standard deviations of their heights.
    """
    scale, source = length_scale(scene, curve), scene.asperities
    highest, closest = float(source.extremes(1e-3).height.max()), float(curve.values.min())
    way = max(float(np.ptp(curve.values)), 6.0 * source.sigma if source.sigma < math.inf else 0.0)
    nearby = (highest - closest - way) / scale, (highest - closest) / scale
    bounds = min(nearby[0], 0.0) - _FARTHEST, max(nearby[1], 0.0) + _FARTHEST
    return Parameter(OFFSET, "m", 0.0, scale, bounds, nearby)


def length_scale(scene: Scene, curve: MeasuredCurve) -> float:
    """Return the length [m] over which the measured load changes: the range of the control times the mean load over the
    largest; the rise of an asperity where the control stays the same.
    """
    size = np.abs(curve.load)
    length = float(np.ptp(curve.values) * size.mean() / size.max())
    return length or float(scene.asperities.extremes(1e-3).columns.rise.max())


def _entry(key: str, table: dict[str, Any]) -> Any:
    """Return the entry of a dotted key; None where there is none."""
    try:
        return reduce(getitem, key.split("."), table)
    except (KeyError, TypeError):
        return None


def _refuses(reader: Reader, number: float) -> bool:
    try:
        reader(number)
    except RoughmdrError:
        return True
    return False
