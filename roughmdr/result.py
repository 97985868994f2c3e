"""What a run found out, put together: variables, coordinates and the attributes that say where it comes from."""

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.labelled import Array, Labelled
from roughmdr.plan import Plan
from roughmdr.statistics import summarise
from roughmdr.store import provenance
from roughmdr.variables import LAW, RUN

_REFERENCES = (
    "M. Hess, On the reduction method of dimensionality: the exact mapping of axisymmetric contact problems "
    "with and without adhesion (2012)"
)
DONE, FAILED, NOT_RUN = 0, 1, 2


LAWS = ("none", "jkr", "dugdale")


def assemble(
    plan: Plan,
    variables: dict[str, Floats],
    warnings: list[str],
    command: str,
    *,
    run_time: Floats,
    numerical_error: Floats,
    tabor: Floats,
    adhesion_law: Floats,
) -> Labelled:
    """The result, from ``variables`` [run, step] in SI, and over the runs: run times [s], numerical errors, the least
    Tabor numbers and the laws of adhesion that were taken. ``warnings`` are for the user.
    """
    scene = plan.scene
    swept, realization = tuple(plan.sizes), ("realization",)
    shape = (*plan.sizes.values(), scene.batch.realizations)
    curves = {name: values.reshape(*shape, -1) for name, values in variables.items()}
    run_time, error = run_time.reshape(shape), numerical_error.reshape(shape)
    tabor, laws = np.where(np.isfinite(tabor), tabor, np.nan).reshape(shape), adhesion_law.reshape(shape)
    coordinates = plan.coordinates()
    data = {}
    if scene.output.keep == "curves":
        dims = (*swept, *realization)
        data = {name: Array((*dims, "step"), values, LAW[name].attrs) for name, values in curves.items()}
    else:
        dims, count = swept, float(scene.batch.realizations)
        snaps = np.array([cell.route.snaps() for cell in plan.cells]).reshape(*shape[:-1], -1)
        for name in list(curves):
            data |= summarise(name, (*dims, "step"), curves.pop(name), snaps)
        data["realization_count"] = Array(dims, np.full(shape[:-1], count), RUN["realization_count"].attrs)
        run_time, error = run_time.sum(axis=-1), error.max(axis=-1)
        tabor, laws = tabor.min(axis=-1), laws.max(axis=-1)
    status = np.full(run_time.shape, DONE, dtype=np.int8)
    flags = {"flag_values": np.array([DONE, FAILED, NOT_RUN], dtype=np.int8), "flag_meanings": "done failed not_run"}
    data["run_time"] = Array(dims, run_time, RUN["run_time"].attrs)
    data["numerical_error"] = Array(dims, error, RUN["numerical_error"].attrs)
    data["status"] = Array(dims, status, {"long_name": RUN["status"].long_name, **flags})
    if any(cell.scene.law.known for cell in plan.cells):
        flags = {"flag_values": np.arange(len(LAWS), dtype=np.int8), "flag_meanings": " ".join(LAWS)}
        data["tabor_number"] = Array(dims, tabor, RUN["tabor_number"].attrs)
        data["adhesion_law"] = Array(dims, laws.astype(np.int8), {"long_name": RUN["adhesion_law"].long_name, **flags})
    attrs = {"references": _REFERENCES, "seed": scene.seed, "scene": scene.toml, "left_out": "\n".join(plan.left_out)}
    if warnings:
        attrs["warnings"] = "\n".join(warnings)
    return Labelled(data, coordinates, {**provenance(scene.title, command), **attrs})
