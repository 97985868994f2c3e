"""roughmdr: batch simulation of rough, multi-asperity contact by the method of dimensionality reduction.

Everything listed in ``__all__`` is loaded when it is first used, so that what is not used costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roughmdr.analysis.register import register

if TYPE_CHECKING:
    from roughmdr import spectrum, theory
    from roughmdr.aggregate import load_separation
    from roughmdr.asperity.equilibria import equilibria
    from roughmdr.asperity.fields.evaluate import axis_stress, pressure, surface_displacement
    from roughmdr.asperity.indent import indent
    from roughmdr.asperity.pull_off import pull_off
    from roughmdr.asperity.tabor import tabor
    from roughmdr.ensemble import generate
    from roughmdr.errors import (
        FailedRuns,
        LimitWarning,
        OutOfRange,
        RoughmdrError,
        SceneError,
        ShapeError,
        StoreError,
        Unfinished,
    )
    from roughmdr.fitting.fit import fit
    from roughmdr.pictures.plot import plot
    from roughmdr.report.cite import cite
    from roughmdr.report.export.write import export
    from roughmdr.report.page import write_report
    from roughmdr.report.summary import info
    from roughmdr.runner.run import run
    from roughmdr.scene import Scene
    from roughmdr.schema.material import effective_modulus
    from roughmdr.shapes import (
        CappedParaboloid,
        Cone,
        FlatPunch,
        MdrTable,
        Paraboloid,
        PowerLaw,
        PowerSeries,
        RoundedCone,
        RoundedPunch,
        Sphere,
        Tabulated,
        TruncatedCone,
        TruncatedParaboloid,
    )

_ROOMS = {
    "aggregate": ("load_separation",),
    "asperity.equilibria": ("equilibria",),
    "asperity.indent": ("indent",),
    "asperity.pull_off": ("pull_off",),
    "asperity.tabor": ("tabor",),
    "ensemble": ("generate",),
    "errors": (
        "FailedRuns",
        "LimitWarning",
        "OutOfRange",
        "RoughmdrError",
        "SceneError",
        "ShapeError",
        "StoreError",
        "Unfinished",
    ),
    "asperity.fields.evaluate": ("axis_stress", "pressure", "surface_displacement"),
    "fitting.fit": ("fit",),
    "report.cite": ("cite",),
    "report.export.write": ("export",),
    "report.summary": ("info",),
    "report.page": ("write_report",),
    "pictures.plot": ("plot",),
    "runner.run": ("run",),
    "scene": ("Scene",),
    "schema.material": ("effective_modulus",),
}
"""Public names by the module that holds them; the others are modules, or shapes."""

__all__ = [
    "CappedParaboloid",
    "Cone",
    "FailedRuns",
    "FlatPunch",
    "LimitWarning",
    "MdrTable",
    "OutOfRange",
    "Paraboloid",
    "PowerLaw",
    "PowerSeries",
    "RoughmdrError",
    "RoundedCone",
    "RoundedPunch",
    "Scene",
    "SceneError",
    "ShapeError",
    "Sphere",
    "StoreError",
    "Tabulated",
    "TruncatedCone",
    "TruncatedParaboloid",
    "Unfinished",
    "axis_stress",
    "cite",
    "effective_modulus",
    "equilibria",
    "export",
    "fit",
    "generate",
    "indent",
    "info",
    "load_separation",
    "plot",
    "pressure",
    "pull_off",
    "run",
    "spectrum",
    "surface_displacement",
    "tabor",
    "theory",
    "write_report",
]

register()


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("roughmdr")
    if name in ("spectrum", "theory"):
        return import_module(f"roughmdr.{name}")
    if name in __all__:
        module = next((module for module, names in _ROOMS.items() if name in names), "shapes")
        value = globals()[name] = getattr(import_module(f"roughmdr.{module}"), name)
        return value
    raise AttributeError(f"module 'roughmdr' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
