"""The path as keyword arguments of a Python function: separations of the flat, or what a machine does."""

from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError, SceneError
from roughmdr.kernels.adhesion import AdhesiveMaterial
from roughmdr.loading.machine import MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.schema.arguments import check_number, check_values, exactly_one
from roughmdr.variables import CONTROLS


class MachineArguments(TypedDict, total=False):
    """Controls of a machine as keyword arguments, in place of a separation."""

    force: ArrayLike | None
    pressure: ArrayLike | None
    remote: ArrayLike | None
    machine_stiffness: float | str | None


class LawArguments(AdhesiveMaterial, MachineArguments, total=False):
    """The elastic constants, how the surfaces attract each other, and the machine."""


def path_of(
    separation: ArrayLike | None, given: LawArguments, *, unload: bool, area: float | None, adhesive: bool
) -> LoadingPath | MachinePath:
    """Take the path out of the keyword arguments of a function; ``area`` is the nominal area [m2].

    RoughmdrError unless exactly one control is given, and a machine's stiffness with "remote" alone; OutOfRange for a
    number; SceneError for a pressure without nominal area.
    """
    machines = {name: given.pop(name, None) for name in CONTROLS if name != "separation"}  # type: ignore[misc]
    stiffness = given.pop("machine_stiffness", None)
    control, raw = exactly_one("load_separation", separation=separation, **machines)
    values = np.atleast_1d(check_values(control, raw, CONTROLS[control]))
    if values.size == 0:
        raise OutOfRange(f"{control} is empty; it must hold at least one number")
    if (stiffness is None) == (control == "remote"):
        got = "goes with remote only" if stiffness is not None else "is missing; remote needs it"
        raise RoughmdrError(f"machine_stiffness {got}")
    if control == "separation":
        return LoadingPath.along(values, unload=unload, adhesive=adhesive)
    if control == "pressure" and area is None:
        raise SceneError("ensemble: attribute nominal_area is missing; a path of pressures needs it")
    return MachinePath.along(
        control,
        np.concatenate([values, values[::-1]]) if unload else values,
        machine_stiffness=check_number("machine_stiffness", stiffness, "N/m") if stiffness is not None else 0.0,
        area=area or 1.0,
        adhesive=adhesive,
    )
