"""The path of the machine of a cell, and that on which it moves the flat over usual asperities."""

import numpy as np

from roughmdr.aggregate import LoadingPath, Problem, simulate
from roughmdr.errors import Fault, RoughmdrError, SceneError
from roughmdr.loading.machine import MachinePath
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene


def machine_path(cell: Scene, values: Floats) -> MachinePath:
    """Return the path of a machine that controls these values, in SI; SceneError where it needs a nominal area."""
    path, area = cell.path, cell.asperities.nominal_area
    if path.area_key and area is None:
        raise SceneError.of([Fault(path.area_key, "", "needs a nominal area, which these asperities do not have")])
    if path.to_preload:
        stiffness, adhesive = path.machine_stiffness, cell.work > 0.0
        return MachinePath.to_preload(values, path.to_preload, machine_stiffness=stiffness, adhesive=adhesive)
    return MachinePath.along(
        path.control,
        values,
        machine_stiffness=path.machine_stiffness or 0.0,
        area=area or 1.0,
        adhesive=cell.work > 0.0,
    )


def usual_path(cell: Scene, machine: MachinePath) -> LoadingPath:
    """Return the path of the flat on evenly drawn, independent asperities; clear of them where it has been pulled off.

    SceneError where there is none.
    """
    problem = Problem(cell.asperities.evenly_drawn(cell.seed), cell.effective_modulus, cell.adhesion_model)
    try:
        law = simulate(problem, machine, ["separation"])
    except RoughmdrError as error:
        raise SceneError.of([Fault(f"path.{cell.path.key}", "", f"cannot be followed: {error}")]) from error
    separation = np.where(np.isnan(law.variables["separation"]), problem.clear, law.variables["separation"])
    return LoadingPath.along(separation, unload=False, adhesive=machine.adhesive)
