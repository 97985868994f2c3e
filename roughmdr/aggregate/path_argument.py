"""The path as keyword arguments of a Python function: separations of the flat, or controls of a machine."""

from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError, SceneError
from roughmdr.kernels.adhesion import AdhesiveMaterial
from roughmdr.loading.machine import PRELOAD, STEPS, STIFFNESS, MachinePath, Preload, travel
from roughmdr.loading.path import LoadingPath
from roughmdr.schema.arguments import check_values, exactly_one
from roughmdr.variables import CONTROLS, DEFAULT_STEPS, PRELOADS


class MachineArguments(TypedDict, total=False):
    """Controls of a machine as keyword arguments, in place of a separation."""

    force: ArrayLike | None
    pressure: ArrayLike | None
    remote: ArrayLike | None
    machine_stiffness: float | str | None
    preload: float | str | None
    preload_pressure: float | str | None
    preload_contact_fraction: float | None
    steps: int | None


class LawArguments(AdhesiveMaterial, MachineArguments, total=False):
    """The elastic constants, how the surfaces attract each other, and the machine."""


def path_of(
    separation: ArrayLike | None, given: LawArguments, *, unload: bool, area: float | None, adhesive: bool
) -> LoadingPath | MachinePath:
    """Take the path out of the keyword arguments of a function; ``area`` is the nominal area [m2].

    RoughmdrError unless exactly one control is given, and a machine's stiffness with "remote" alone; OutOfRange for a
    number; SceneError for a pressure without nominal area.
    """
    names = [*(name for name in CONTROLS if name != "separation"), *PRELOADS]
    machines = {name: given.pop(name, None) for name in names}  # type: ignore[misc]
    stiffness, steps = given.pop("machine_stiffness", None), given.pop("steps", None)
    control, raw = exactly_one("load_separation", separation=separation, **machines)
    if control == "remote" and stiffness is None:
        raise RoughmdrError("machine_stiffness is missing; remote needs it")
    if control != "remote" and control not in PRELOADS and stiffness is not None:
        raise RoughmdrError("machine_stiffness goes with remote or a preload only")
    if control not in PRELOADS and steps is not None:
        raise RoughmdrError(f"steps goes with a preload only; {control} holds its own")
    spring = None if stiffness is None else STIFFNESS.argument("machine_stiffness", stiffness)
    per_area = control in ("pressure", "preload_pressure", "preload_contact_fraction")
    if per_area and area is None:
        raise SceneError(f"ensemble: attribute nominal_area is missing; {control} needs it")
    if control in PRELOADS:
        values = travel(DEFAULT_STEPS if steps is None else STEPS.argument("steps", steps))
    else:
        values = np.atleast_1d(check_values(control, raw, CONTROLS[control]))
    if values.size == 0:
        raise OutOfRange(f"{control} is empty; it must hold at least one number")
    if control == "separation":
        return LoadingPath.along(values, unload=unload, adhesive=adhesive)
    values = np.concatenate([values, values[::-1]]) if unload else values
    if control in PRELOADS:
        preload = Preload(PRELOADS[control][0], PRELOAD[control].argument(control, raw))
        return MachinePath.to_preload(values, preload, machine_stiffness=spring, adhesive=adhesive)
    return MachinePath.along(control, values, machine_stiffness=spring or 0.0, area=area or 1.0, adhesive=adhesive)
