"""Derivatives of expected laws with respect to numbers of their scenes, by differences that tell their own error."""

from itertools import product
from typing import NamedTuple

import numpy as np

from roughmdr.batch.paths import machine_path
from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.realization import simulate_realization
from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, with_numbers
from roughmdr.scene.keys import key_readers, must_be_positive, number_at
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


def derivatives_of(plan: Plan) -> tuple[dict[str, Array], dict[str, Array], list[str]]:
    """Return the derivatives of the variables of a plan, keys and units of the parameters, and warnings.

    They lie over the swept keys, ``parameter`` and, where the variable has them, steps, each with its error; NaN in
    cells where a law has none. They are exact to about 1e-9 of what a change by the number itself makes, and less where
    contacts are made or lost nearby, as their errors tell.
    """
    keys, names, steps = plan.scene.output.derivatives, plan.variables, plan.steps
    found = np.full((len(plan.cells), len(keys), 2, len(names) * steps + len(PULL_OFF_NUMBERS)), np.nan)
    failures = list[str]()
    for number, cell in enumerate(plan.cells):
        try:
            found[number] = _derivatives(cell, names, keys)
        except RoughmdrError as error:
            failures.append(f"{plan.name_of(number)}: {error}")
    found = found.reshape(*plan.sizes.values(), *found.shape[1:])
    declared = {name: LAW_VARIABLES[name] for name in names} | (PULL_OFF_NUMBERS if plan.unloads else {})
    dims, variables, first = (*plan.sizes, "parameter"), dict[str, Array](), 0
    for name, variable in declared.items():
        count = steps if name in names else 1
        for row, (ending, words) in enumerate({DERIVATIVE: "", DERIVATIVE_ERROR: "error of the "}.items()):
            about = f"{words}derivative of the {variable.long_name}, with respect to a number of the scene, in SI"
            values, attrs = found[..., row, first : first + count], {"long_name": about}
            over = Array((*dims, "step"), values, attrs) if name in names else Array(dims, values[..., 0], attrs)
            variables[f"{name}{ending}"] = over
        first += count
    units = [spelled_in_results(_number(plan.cells[0], key).unit) for key in keys]
    coordinates = {
        "parameter": Array(("parameter",), np.array(keys), {"long_name": "key of the number in the scene"}),
        "parameter_unit": Array(("parameter",), np.array(units), {"long_name": "unit of the number"}),
    }
    told = f"no derivatives of {len(failures)} of {len(plan.cells)} cells: "
    return variables, coordinates, [f"{told}{each}" for each in failures[:1]]


class _Number(NamedTuple):
    """A number of a scene that is varied."""

    value: float
    """In SI."""
    unit: str
    scale: float
    """On which it is changed."""


def check_derivatives(plan: Plan) -> None:
    """Raise SceneError where a law of a plan cannot be differentiated as its scene asks."""
    keys = plan.scene.output.derivatives
    if keys and {*plan.scene.estimators} != {"expected"}:
        told = 'are those of an expected law: batch.estimator = "expected"'
        raise plan.scene.located(SceneError.of([Fault("output.derivatives", short_repr(keys), told)]))
    for key, cell, side in product(keys, plan.cells, (_SIDES[0], _SIDES[-1])):
        try:
            _varied(cell, key, _number(cell, key), side)
        except RoughmdrError as error:
            told = f"{error}; it is changed by {2.0 * _STEP:g} of it, or of its scale, to both sides"
            raise plan.scene.located(SceneError.of([Fault("output.derivatives", key, told)])) from None


def _derivatives(cell: Cell, names: list[str], keys: list[str]) -> Floats:
    """Return the derivatives, and their errors, of variables at all steps and of the pull-off: [key, 2, number]."""
    here, found = _law(cell, names, cell.scene), list[list[Floats]]()
    for key in keys:
        number = _number(cell, key)
        far, near, beyond, further = (_law(cell, names, _varied(cell, key, number, side)) for side in _SIDES)
        first = (8.0 * (beyond - near) - (further - far)) / 12.0
        fourth = (far + further) - 4.0 * (near + beyond) + 6.0 * here
        found.append([each / (_STEP * number.scale) for each in (first, _OF_FOURTH * np.abs(fourth))])
    return np.array(found)


def _law(cell: Cell, names: list[str], scene: Scene) -> Floats:
    """Return variables at all steps, and the pull-off, of the law of a cell with another number in its scene."""
    path = cell.controlled
    if isinstance(path, MachinePath):
        path = machine_path(scene, path.values)
    law = simulate_realization(scene, path, 0, names, "expected")
    return np.concatenate([*(law.variables[name] for name in names), law.pull_off])


def _varied(cell: Cell, key: str, number: _Number, side: float) -> Scene:
    """Return the scene of a cell with a number changed by so many steps; SceneError where it does not allow that."""
    return with_numbers(cell.scene, {key: number.value + side * _STEP * number.scale})


def _number(cell: Cell, key: str) -> _Number:
    """Return a number of the scene of a cell; RoughmdrError where the key holds none that can be changed.

    A length that may be negative, such as a height, is changed on the scale of the heights, or of the indentation.
    """
    source, table = cell.scene.asperities, parse_toml(cell.scene.toml)
    readers = {
        name: reader
        for name, reader in key_readers([Scene], table)
        if name.partition(".")[0] in SECTIONS or name == _MACHINE
    }
    reader, value = number_at(key, readers, table)
    unit, scale = reader.dimension, abs(value) or 1.0
    if must_be_positive(reader, value):
        if value == 0.0:
            raise RoughmdrError("is 0, the end of what is allowed; set it above 0")
    elif unit == "m":
        highest = source.extremes(1e-3)
        depth = float(highest.height.max()) - float(cell.path.separation.min())
        scale = depth if depth > 0.0 else float(highest.columns.rise.max())
        scale = source.sigma if 0.0 < source.sigma < np.inf else scale
    return _Number(value, unit, scale)
