"""Error against run time, a curve for each method: of one asperity, and of the mean curve of a rough surface.

Errors are those against many digits, of the force at given separations, the contact area and the pull-off force; run
times are those of a curve of 50 to 200 states. A method joins by a line in ``METHODS`` of tip.py or surface.py.
"""

import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from studies.study import named
from studies.work_precision import surface, tip
from studies.work_precision.points import QUANTITIES, Method, Reference

import roughmdr as rm


class Part(NamedTuple):
    """Some scenes, the methods for their curves, and their exact results."""

    scenes: dict[str, Any]
    methods: tuple[Method, ...]
    reference: Callable[..., Reference]


PARTS = (Part(tip.TIPS, tip.METHODS, tip.reference), Part(surface.SURFACES, surface.METHODS, surface.reference))


def measure(quick: bool) -> xr.Dataset:
    """Return the points of all methods on all scenes; quick without the last scene of each part."""
    found = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # all methods suppose the same
        for part in PARTS:
            for title, scene in list(part.scenes.items())[: -1 if quick else None]:
                exact = part.reference(scene, quick=quick)
                for method in part.methods:
                    found += [(title, method, *point) for point in method.points(scene, exact, quick)]
    titles, methods, settings, errors, seconds, evaluations = map(list, zip(*found, strict=True))
    counted = named("evaluations of a state, a profile, an integrand or a spring for a curve")
    competes = [int(method.competes) for method in methods]
    return xr.Dataset(
        {
            "error": (("point", "quantity"), errors, named("relative error of a quantity")),
            "seconds": ("point", seconds, named("run time of a curve", "s")),
            "evaluations": ("point", np.array(evaluations, dtype=float), counted),
            "setting": ("point", np.array(settings, dtype=float), named("what the error is set by")),
            "setting_of": ("point", [method.setting for method in methods]),
            "competes": ("point", competes, named("whether it may be the cheapest")),
        },
        {
            "scene": ("point", titles),
            "method": ("point", [method.name for method in methods]),
            "quantity": list(QUANTITIES),
        },
    )


def points_of(result: xr.Dataset, **names: str) -> xr.Dataset:
    """Return the points of one ``scene``, one ``method`` or both."""
    chosen = np.all([result[key].to_numpy() == name for key, name in names.items()], axis=0)
    return result.isel(point=np.flatnonzero(chosen))


def cheapest(result: xr.Dataset, scene: str, quantity: str, error: float) -> xr.Dataset | None:
    """Return the point of least run time that comes to an error in a quantity; None where none does."""
    competes = (result.scene == scene) & (result.competes == 1)
    good_enough = np.flatnonzero(competes & (result.error.sel(quantity=quantity) <= error))
    if good_enough.size == 0:
        return None
    return result.isel(point=good_enough[np.argmin(result.seconds.to_numpy()[good_enough])])
