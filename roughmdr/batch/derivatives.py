"""Derivatives of expected laws with respect to numbers of their scenes, by differences that tell their own error."""

import numpy as np

from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.realization import simulate_realization
from roughmdr.batch.usual_path import machine_path
from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import key_readers, must_be_positive, number_at, set_key
from roughmdr.scene.sweep import SECTIONS
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import spelled_in_results
from roughmdr.schema.wording import short_repr
from roughmdr.storage.labelled import Array
from roughmdr.variables import DERIVATIVE, DERIVATIVE_ERROR, LAW_VARIABLES, PULL_OFF_NUMBERS

_STEP = 1e-3  # change of a number in differences, over its scale: laws are rounded to 1e-12, and so over it to 1e-9
_SIDES = (-2.0, -1.0, 1.0, 2.0)  # changes of a number, in steps, where laws are computed beside that of the scene
_OF_FOURTH = 0.5  # error of the derivative over the fourth difference: 0.25 at a kink amid them, 0.2 at a jump
_MACHINE = "path.machine_stiffness"


def check_derivatives(plan: Plan) -> None:
    """Raise SceneError where a law of a plan cannot be differentiated as its scene asks."""
    keys = plan.scene.output.derivatives
    if keys and set(plan.scene.estimators) != {"expected"}:
        fault = Fault(
            "output.derivatives", short_repr(keys), 'are those of an expected law: batch.estimator = "expected"'
        )
        raise plan.scene.located(SceneError.of([fault]))
    for cell in plan.cells:
        for key in keys:
            for side in (_SIDES[0], _SIDES[-1]):
                _varied(cell, key, side)


def derivatives_of(plan: Plan) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the derivatives of all variables of a plan with their errors, and the keys and units of the parameters.

    That of a variable over its steps has the dimensions of the swept keys, ``parameter`` and ``step``. It is exact to
    about 1e-9 of what a change by the number itself makes; the error is larger where contacts are made or lost nearby.
    """
    keys, names = plan.scene.output.derivatives, plan.variables
    found = np.array([_derivatives(cell, names, keys) for cell in plan.cells])
    dims, sizes = (*plan.sizes, "parameter"), (*plan.sizes.values(), len(keys))
    found = found.reshape(*sizes, *found.shape[2:])
    variables, steps = dict[str, Array](), plan.steps
    for ending, values, words in (
        (DERIVATIVE, found[..., 0, :], ""),
        (DERIVATIVE_ERROR, found[..., 1, :], "error of "),
    ):
        about = f"{words}derivative of the {{}} with respect to a number of the scene, in SI"
        for number, name in enumerate(names):
            attrs = {"long_name": about.format(LAW_VARIABLES[name].long_name)}
            of_name = values[..., number * steps : (number + 1) * steps]
            variables[f"{name}{ending}"] = Array((*dims, "step"), of_name, attrs)
        for number, (name, variable) in enumerate(PULL_OFF_NUMBERS.items() if plan.unloads else ()):
            attrs = {"long_name": about.format(variable.long_name)}
            variables[f"{name}{ending}"] = Array(dims, values[..., len(names) * steps + number], attrs)
    units = [spelled_in_results(_number(plan.cells[0], key)[1]) for key in keys]
    return variables, {
        "parameter_name": Array(("parameter",), np.array(keys), {"long_name": "key of the number in the scene"}),
        "parameter_unit": Array(("parameter",), np.array(units), {"long_name": "unit of the number"}),
    }


def _derivatives(cell: Cell, names: list[str], keys: list[str]) -> Floats:
    """Return the derivatives, and their errors, of variables at all steps and of the pull-off: [key, 2, number]."""
    here, found = (
        _law(cell, names, cell.scene),
        np.empty((len(keys), 2, len(names) * cell.steps + len(PULL_OFF_NUMBERS))),
    )
    for (first, fourth), key in zip(found, keys, strict=True):
        far, near, beyond, further = (_law(cell, names, _varied(cell, key, side)) for side in _SIDES)
        step = _STEP * _number(cell, key)[2]
        first[:] = (8.0 * (beyond - near) - (further - far)) / (12.0 * step)
        fourth[:] = _OF_FOURTH * np.abs((far + further) - 4.0 * (near + beyond) + 6.0 * here) / step
    return found


def _law(cell: Cell, names: list[str], scene: Scene) -> Floats:
    """Return variables at all steps, and the pull-off, of the law of a cell with another number in its scene."""
    path = cell.controlled
    if isinstance(path, MachinePath):
        path = machine_path(scene, path.values)
    law = simulate_realization(scene, path, 0, names, "expected")
    return np.concatenate([*(law.variables[name] for name in names), law.pull_off])


def _varied(cell: Cell, key: str, side: float) -> Scene:
    """Return the scene of a cell with a number changed by so many steps; SceneError where it does not allow that."""
    table = parse_toml(cell.scene.toml)
    try:
        value, _, scale = _number(cell, key)
        set_key(table, key, value + side * _STEP * scale)
        return read(table)
    except RoughmdrError as error:
        raise SceneError.of([Fault("output.derivatives", key, str(error))]) from None


def _number(cell: Cell, key: str) -> tuple[float, str, float]:
    """Return the value of a number, its unit, and the scale on which it is changed; RoughmdrError for no number.

    A length that may be negative, such as a height, is changed on the scale of the heights, or of the indentation.
    """
    source, table = cell.scene.asperities, parse_toml(cell.scene.toml)
    readers = {
        name: reader
        for name, reader in key_readers([Scene], table)
        if name.partition(".")[0] in SECTIONS or name == _MACHINE
    }
    reader, value = number_at(key, readers, table)
    if must_be_positive(reader, value):
        return value, reader.dimension, value
    if reader.dimension != "m":
        return value, reader.dimension, abs(value) or 1.0
    if 0.0 < source.sigma < np.inf:
        return value, reader.dimension, source.sigma
    highest = source.extremes(1e-3)
    depth = float(highest.height.max()) - float(cell.path.separation.min())
    return value, reader.dimension, depth if depth > 0.0 else float(highest.columns.rise.max())
