"""Small scenes and ensembles for the tests."""

import copy
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.shapes import SHAPES, Shape

ASPERITIES: dict[str, Any] = {
    "source": "random",
    "shape": "paraboloid",
    "count": 1000,
    "patch": "1 mm",
    "height": {"distribution": "normal", "std": "1 um"},
    "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
}
SCENE: dict[str, Any] = {
    "title": "A small scene",
    "seed": 7,
    "material": {"modulus": "3 MPa", "poisson": 0.49},
    "adhesion": {"model": "jkr", "work": "50 mJ/m^2"},
    "asperities": ASPERITIES,
    "path": {"separation": {"start": "3 sigma", "stop": "-0.5 sigma", "steps": 40}, "unload": True},
    "batch": {"realizations": 16},
}
CONDUCTION = {"conductivity": "400 W/m/K", "resistivity": "17 nohm m", "counter_resistivity": "30 nohm m"}
"""The section [conduction], without which a scene has no conductances."""

WIDER_SHAPES: dict[str, dict[str, Any]] = {
    "flat_punch": {"radius": (1e-6, 3e-6)},
    "sphere": {"radius": (3e-5, 8e-5)},
    "truncated_cone": {"slope": (0.1, 0.2), "flat_radius": (1e-6, 3e-6)},
    "truncated_paraboloid": {"radius": (3e-5, 8e-5), "flat_radius": (1e-6, 3e-6)},
    "rounded_cone": {"slope": (0.1, 0.2), "blend_radius": (1e-6, 4e-6)},
    "capped_paraboloid": {"radius": (3e-5, 5e-5), "cap_radius": (6e-5, 9e-5), "blend_radius": (2e-6, 9e-6)},
    "rounded_punch": {"flat_radius": (1e-6, 3e-6), "edge_radius": (1e-5, 5e-5)},
}
"""Shapes that are no power laws, with ranges of their parameters."""


def scene(**changes: Any) -> dict[str, Any]:
    """The small scene with sections replaced; None leaves one out."""
    table = copy.deepcopy(SCENE) | copy.deepcopy(changes)
    return {key: value for key, value in table.items() if value is not None}


def ensemble(height: Any, area: float | None = 1e-4, shape: str = "paraboloid", **parameters: Any) -> xr.Dataset:
    """An ensemble made by hand."""
    z = np.atleast_1d(np.asarray(height, dtype=float))
    columns = {
        name: ("asperity", np.broadcast_to(np.asarray(value, float), z.shape)) for name, value in parameters.items()
    }
    attrs: dict[str, Any] = {"shape": shape} | ({} if area is None else {"nominal_area": area})
    return xr.Dataset({"height": ("asperity", z), **columns}, attrs=attrs)


def shapes_of(asperities: xr.Dataset) -> list[Shape]:
    """Return the shape of each asperity of an ensemble."""
    names, kind = [str(name) for name in asperities if name != "height"], SHAPES[asperities.attrs["shape"]]
    count = asperities.sizes["asperity"]
    return [kind(**{name: float(asperities[name][i]) for name in names}) for i in range(count)]


def detachment_depths(asperities: xr.Dataset, **law: Any) -> np.ndarray:
    """Return how far [m] each contact of an ensemble is stretched under fixed grips when it lets go."""
    folds = [rm.pull_off(shape, **law, control="displacement").indentation for shape in shapes_of(asperities)]
    return -np.array(folds, dtype=float)
