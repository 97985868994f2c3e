"""Results without dimensions, by the scales of a theory.

J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. Lond. A 295 (1966) 300: N paraboloids of radius R whose heights have
the standard deviation sigma. Without adhesion sums over them are F_n(d) = int_d^inf (s - d)^n phi(s) ds at the
separation d sigma, where phi is the density of the heights over sigma.
"""

import math
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roughmdr.ensemble import NayakAsperities, RandomAsperities
from roughmdr.ensemble.nodes import Rule
from roughmdr.errors import StoreError
from roughmdr.result.cells import of_cells
from roughmdr.result.curves import result_of
from roughmdr.scene import Scene
from roughmdr.schema.wording import short_repr

if TYPE_CHECKING:
    import xarray as xr

_STATISTICS = ("_mean", "_sem", "_min", "_max", "_of_mean")
_PREFIXES = ("pull_off_", "reference_")
_KEPT = ("status", "realization_count")
_SCORES = 100
_COMMENT = (
    "over the scales of Greenwood and Williamson (1966): N asperities of mean radius R whose heights have the standard "
    "deviation sigma, on the nominal area A, with the effective modulus E*"
)


class _Factors(NamedTuple):
    """A scale: a number times powers of N, E*, R, sigma and the nominal area."""

    number: float
    powers: tuple[float, float, float, float, float]
    text: str


_FORCE = _Factors(4.0 / 3.0, (1.0, 1.0, 0.5, 1.5, 0.0), "4/3 N E* R^(1/2) sigma^(3/2)")
_AREA = _Factors(math.pi, (1.0, 0.0, 1.0, 1.0, 0.0), "pi N R sigma")
_ENERGY = _Factors(8.0 / 15.0, (1.0, 1.0, 0.5, 2.5, 0.0), "8/15 N E* R^(1/2) sigma^(5/2)")
_STIFFNESS = _Factors(2.0, (1.0, 1.0, 0.5, 0.5, 0.0), "2 N E* (R sigma)^(1/2)")
_COUNT = _Factors(1.0, (1.0, 0.0, 0.0, 0.0, 0.0), "N")
_HEIGHT = _Factors(1.0, (0.0, 0.0, 0.0, 1.0, 0.0), "sigma")
_SCALES = {
    "force": _FORCE,
    "contact_area": _AREA,
    "contact_count": _COUNT,
    "contacts": _COUNT,
    "stiffness": _STIFFNESS,
    "pressure": _Factors(4.0 / 3.0, (1.0, 1.0, 0.5, 1.5, -1.0), f"{_FORCE.text}/A"),
    "contact_fraction": _Factors(math.pi, (1.0, 0.0, 1.0, 1.0, -1.0), f"{_AREA.text}/A"),
    "contact_radius_sum": _Factors(1.0, (1.0, 0.0, 0.5, 0.5, 0.0), "N (R sigma)^(1/2)"),
    "conductance_radius": _Factors(1.0, (1.0, 0.0, 0.5, 0.5, 0.0), "N (R sigma)^(1/2)"),
    "energy": _ENERGY,
    "dissipated_energy": _ENERGY,
    "machine_dissipated_energy": _ENERGY,
    "friction_energy": _ENERGY,
    "tangential_force": _FORCE,
    "tangential_stiffness": _STIFFNESS,
    "lateral": _HEIGHT,
    "separation": _HEIGHT,
    "remote": _HEIGHT,
}


def normalise(dataset: "xr.Dataset", theory: str) -> "xr.Dataset":
    """Return the curves and pull-offs of a result over the scales of a theory, and the path over sigma."""
    import xarray as xr

    result = result_of(dataset)
    if theory != "gw":
        raise StoreError(f"theory is {short_repr(theory)}; it must be 'gw', Greenwood and Williamson")
    parts = _count, attrgetter("effective_modulus"), _radius, _sigma, _area
    numbers = [of_cells(dataset, part, "normalise") for part in parts]
    control = result.control
    names = [*dataset.data_vars, *([control] if control in _SCALES else [])]
    found: dict[str, xr.DataArray] = {}
    for name in map(str, names):
        if (scale := _scale_of(name)) is not None:
            factor = scale.number * math.prod(
                each**power for each, power in zip(numbers, scale.powers, strict=True) if power
            )
            array = dataset[name]
            about = {"units": "1", "long_name": f"{array.attrs.get('long_name', name)}, over {scale.text}"}
            scaled = (array / factor).drop_vars(control, errors="ignore").assign_attrs(about)
            found[name] = scaled.transpose(..., "step", missing_dims="ignore")
    kept = {name: dataset[name] for name in _KEPT if name in dataset}
    coordinates: dict[Any, Any] = {name: array for name, array in dataset.coords.items() if name != control}
    coordinates[control] = found.pop(control, dataset[control])
    attrs = {"title": dataset.attrs["title"], "comment": _COMMENT}
    return xr.Dataset(found | kept, attrs=attrs).assign_coords(coordinates)


def _scale_of(name: str) -> _Factors | None:
    """Return the scale of a variable, of its statistics, at pull-off or of the reference; None where it has none."""
    for suffix in reversed(_STATISTICS):
        name = name.removesuffix(suffix)
    for prefix in _PREFIXES:
        name = name.removeprefix(prefix)
    return _SCALES.get(name)


def _checked(scene: Scene) -> Scene:
    shape = scene.asperities.shape_name
    if body := next((stage.key for stage in scene.stages if not stage.flat), ""):
        raise StoreError(f"normalise needs a flat that presses all asperities alike; this scene has [{body}]")
    if shape != "paraboloid":
        raise StoreError(f"normalise needs paraboloids, which have a radius; the asperities of this scene are {shape}s")
    return scene


def _count(scene: Scene) -> float:
    section = _checked(scene).asperities
    return section.expected_count if section.is_random else float(section.ensemble(scene.seed, 0).height.size)


def _radius(scene: Scene) -> float:
    """Return the mean radius [m]: of the distribution, or else of the asperities of the first realisation."""
    section = scene.asperities
    if isinstance(section, RandomAsperities):
        members = section.populations.members
        mean = sum(each.fraction * each.parameters["radius"].mean for each in members)
    elif isinstance(section, NayakAsperities):
        nodes = section.nodes(Rule.smooth(_SCORES))
        mean = float(np.sum(nodes.weights * nodes.parameters["radius"]))
    else:
        mean = float(section.ensemble(scene.seed, 0).parameters["radius"].mean())
    if not 0.0 < mean < math.inf:
        raise StoreError(f"normalise needs a mean radius; that of the asperities of this scene is {mean:g} m")
    return mean


def _sigma(scene: Scene) -> float:
    sigma = scene.asperities.sigma
    if not 0.0 < sigma < math.inf:
        raise StoreError(f"normalise needs heights that scatter; their standard deviation in this scene is {sigma:g} m")
    return sigma


def _area(scene: Scene) -> float:
    return scene.asperities.nominal_area or math.nan
