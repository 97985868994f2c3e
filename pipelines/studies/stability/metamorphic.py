"""Changes of a problem that must leave the result as it is, or change it in a known way, whatever the result is."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES
from studies.study import without_limits

MODULUS, WORK, TABOR = 4.1e6, 0.047, 1.3  # a soft rubber [Pa], [J/m^2]; neither DMT nor JKR is right
KINDS: dict[str, dict[str, float]] = {
    "paraboloid": {"radius": 47e-6},
    "cone": {"slope": 0.13},
    "flat_punch": {"radius": 2.3e-6},
    "power_law": {"exponent": 2.7, "width": 11e-6, "rise": 2.1e-6},
    "rounded_cone": {"slope": 0.13, "blend_radius": 2.9e-6},
    "truncated_cone": {"slope": 0.07, "flat_radius": 1.7e-6},
}
"""Typical parameters of the asperities."""
COHESIVE = ("paraboloid", "flat_punch", "power_law", "rounded_cone")
"""Kinds that are computed with adhesion of finite range too."""
QUICK = ("paraboloid", "cone", "power_law")
SAME_BITS = {"elastic": ("paraboloid", "cone", "flat_punch"), "jkr": ("cone", "flat_punch"), "dugdale": ()}
"""Kinds for which a model only adds, multiplies, divides and takes square roots of what has no unit."""
COUNT, LOW = 300, 200  # more than a block of the sum
HEIGHT = 1.1e-6  # standard deviation of the heights [m]
VARIABLES = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]
POWERS = {"force": (0, 1), "contact_area": (2, 0), "contact_count": (0, 0), "stiffness": (-1, 1),
          "energy": (1, 1), "dissipated_energy": (1, 1)}  # fmt: skip
"""Powers of the units of length and force in each variable."""
UNITS = ((20, -13), (-7, 9), (3, 1))  # powers of two in which lengths and forces are counted


def material(model: str, kind: str) -> dict[str, Any]:
    """Return the arguments of an adhesion model."""
    given: dict[str, Any] = {"effective_modulus": MODULUS, "work": 0.0 if model == "elastic" else WORK}
    if model == "dugdale":
        given["strength"] = TABOR / rm.tabor(SHAPES[kind](**KINDS[kind]), **given, strength=1.0)
        given["adhesion"] = "dugdale"
    return given


def ensemble(kind: str, seed: int = 3) -> xr.Dataset:
    """Return asperities with parameters about those of ``KINDS``."""
    rng = np.random.default_rng(seed)
    height = rng.normal(0.0, HEIGHT, COUNT)
    columns = {name: typical * np.exp(rng.normal(0.0, 0.1, COUNT)) for name, typical in KINDS[kind].items()}
    data = {name: ("asperity", column) for name, column in {"height": height, **columns}.items()}
    return xr.Dataset(data, attrs={"shape": kind})


def path(given: dict[str, Any]) -> Floats:
    """Return separations [m] from out of contact to half of the asperities in contact."""
    return np.linspace(3.0 * HEIGHT + given["work"] / given.get("strength", math.inf), -0.3 * HEIGHT, 9)


def curves(data: xr.Dataset, separation: Floats, given: dict[str, Any]) -> dict[str, Floats]:
    """Return the variables in loading and unloading."""
    found = rm.load_separation(data, separation=separation, unload=True, variables=VARIABLES, **given)
    return {name: found[name].to_numpy() for name in VARIABLES}


def difference(one: dict[str, Floats], other: dict[str, Floats]) -> float:
    """Return the largest difference of any variable over its largest magnitude."""
    tiny = np.finfo(float).tiny
    return max(float(np.abs(one[name] - other[name]).max() / max(np.abs(other[name]).max(), tiny))
               for name in VARIABLES)  # fmt: skip


def in_other_units(data: xr.Dataset, given: dict[str, Any], length: int, force: int) -> dict[str, Floats]:
    """Return the curves with lengths and forces counted in 2^-length m and 2^-force N, back in SI."""
    units = {"height": "m", **SHAPES[data.attrs["shape"]].units}
    scaled = data.assign(
        {name: np.ldexp(data[name], length * (units[name] == "m")) for name in map(str, data.data_vars)}
    )
    powers = {"effective_modulus": force - 2 * length, "strength": force - 2 * length, "work": force - length}
    other = {name: math.ldexp(value, powers[name]) if name in powers else value for name, value in given.items()}
    found = curves(scaled, np.ldexp(path(given), length), other)
    return {name: np.ldexp(found[name], -length * POWERS[name][0] - force * POWERS[name][1]) for name in VARIABLES}


def checks(quick: bool) -> list[dict[str, Any]]:
    """Return change, model, shape, difference over the largest magnitude, and what is allowed; quick: three shapes."""
    kinds = [kind for kind in KINDS if not quick or kind in QUICK]
    pairs = [(model, kind) for model in ("elastic", "jkr") for kind in kinds]
    pairs += [("dugdale", kind) for kind in kinds if kind in COHESIVE]
    with without_limits():
        return [
            {"name": name, "law": model, "kind": kind, "error": error, "allowed": allowed}
            for model, kind in pairs
            for name, error, allowed in _checks(model, kind)
        ]


def _checks(model: str, kind: str) -> Iterator[tuple[str, float, float]]:
    data, given, rng = ensemble(kind), material(model, kind), np.random.default_rng(7)
    separation = path(given)
    whole = curves(data, separation, given)
    worst = max(difference(in_other_units(data, given, *units), whole) for units in UNITS)
    yield ("units, only + x / sqrt", worst, 0.0) if kind in SAME_BITS[model] else ("units", worst, 1e-13)
    shuffled = data.isel(asperity=rng.permutation(COUNT))
    yield "order", difference(curves(shuffled, separation, given), whole), 0.0
    parts = [curves(data.isel(asperity=part), separation, given) for part in (slice(0, 117), slice(117, None))]
    yield "two parts", difference({name: parts[0][name] + parts[1][name] for name in VARIABLES}, whole), 1e-14
    below = separation.min() - given["work"] / given.get("strength", math.inf) - rng.uniform(0.01, 5.0, LOW) * HEIGHT
    low = ensemble(kind, seed=5).isel(asperity=slice(0, LOW)).assign(height=("asperity", below))
    more = xr.concat([data, low], "asperity", combine_attrs="override")
    yield "asperities out of reach", difference(curves(more, separation, given), whole), 0.0
