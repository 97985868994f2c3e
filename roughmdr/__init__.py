"""roughmdr: batch simulation of rough, multi-asperity contact by the method of dimensionality reduction.

Most people need these first; ``help(roughmdr.run)`` says more of each, and ``dir(roughmdr)`` lists all there are.

    run(scene, out)                compute a scene: its law over separation or load, as an xarray.Dataset
    info(result)                   tell what a result holds, and how far to trust it
    plot(result, out)              draw it
    write_report(result, out)      one page with all of it
    fit(measured, scene, free)     find parameters of a scene by a measured curve
    export(result, out)            a table for finite elements or another program
    cite(target)                   the papers to cite
    generate(asperities)           asperities of a rough surface
    indent(shape, ...)             one asperity: force, contact radius and energy by indentation, or the reverse
    pull_off(shape, ...)           force and place at which one asperity detaches

Shapes are classes, such as ``Paraboloid(radius="10 um")``; ``roughmdr.theory`` has laws of the literature. Every result
has the accessor ``result.roughmdr``: values at a load, statistics, energies lost, normalised laws. Numbers are in SI,
or strings with a unit. All is loaded when it is first used, so that what is not used costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roughmdr.analysis.register import register

if TYPE_CHECKING:
    from roughmdr import spectrum as spectrum, theory as theory
    from roughmdr.aggregate import load_separation as load_separation
    from roughmdr.asperity.equilibria import equilibria as equilibria
    from roughmdr.asperity.fields.evaluate import (
        axis_stress as axis_stress,
        pressure as pressure,
        surface_displacement as surface_displacement,
    )
    from roughmdr.asperity.indent import indent as indent
    from roughmdr.asperity.pull_off import pull_off as pull_off
    from roughmdr.asperity.tabor import tabor as tabor
    from roughmdr.ensemble import generate as generate
    from roughmdr.errors import (
        FailedRuns as FailedRuns,
        LimitWarning as LimitWarning,
        OutOfRange as OutOfRange,
        RoughmdrError as RoughmdrError,
        SceneError as SceneError,
        ShapeError as ShapeError,
        StoreError as StoreError,
        Unfinished as Unfinished,
    )
    from roughmdr.fitting.fit import fit as fit
    from roughmdr.pictures.kinds import plot as plot
    from roughmdr.report.cite import cite as cite
    from roughmdr.report.export.write import export as export
    from roughmdr.report.page import write_report as write_report
    from roughmdr.report.summary import info as info
    from roughmdr.runner.run import run as run
    from roughmdr.scene import Scene as Scene
    from roughmdr.schema.material import effective_modulus as effective_modulus
    from roughmdr.shapes import (
        CappedParaboloid as CappedParaboloid,
        Cone as Cone,
        FlatPunch as FlatPunch,
        MdrTable as MdrTable,
        Paraboloid as Paraboloid,
        PowerLaw as PowerLaw,
        PowerSeries as PowerSeries,
        RoundedCone as RoundedCone,
        RoundedPunch as RoundedPunch,
        Sphere as Sphere,
        Tabulated as Tabulated,
        TruncatedCone as TruncatedCone,
        TruncatedParaboloid as TruncatedParaboloid,
    )

_ROOMS = {
    "aggregate": "load_separation",
    "asperity.equilibria": "equilibria",
    "asperity.fields.evaluate": "axis_stress pressure surface_displacement",
    "asperity.indent": "indent",
    "asperity.pull_off": "pull_off",
    "asperity.tabor": "tabor",
    "ensemble": "generate",
    "errors": "FailedRuns LimitWarning OutOfRange RoughmdrError SceneError ShapeError StoreError Unfinished",
    "fitting.fit": "fit",
    "pictures.kinds": "plot",
    "report.cite": "cite",
    "report.export.write": "export",
    "report.page": "write_report",
    "report.summary": "info",
    "runner.run": "run",
    "scene": "Scene",
    "schema.material": "effective_modulus",
    "shapes": "CappedParaboloid Cone FlatPunch MdrTable Paraboloid PowerLaw PowerSeries RoundedCone RoundedPunch "
    "Sphere Tabulated TruncatedCone TruncatedParaboloid",
}
"""Public names by the module that holds them; ``help`` would print all that an ``__all__`` lists."""
_MODULE_OF = {name: module for module, names in _ROOMS.items() for name in names.split()}

register()


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("roughmdr")
    if name in ("spectrum", "theory"):
        return import_module(f"roughmdr.{name}")
    if name in _MODULE_OF:
        value = globals()[name] = getattr(import_module(f"roughmdr.{_MODULE_OF[name]}"), name)
        return value
    raise AttributeError(f"module 'roughmdr' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*_MODULE_OF, "spectrum", "theory", "__version__"])
