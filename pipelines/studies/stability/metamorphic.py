"""Changes of a question whose answer must not change, or must change in a known way, whatever the answer is."""

import math
import warnings
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.aggregate import LoadingPath, compute
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES, Shape

MODULUS, WORK, TABOR = 4.1e6, 0.047, 1.3  # of a soft rubber [Pa], [J/m^2], and where neither DMT nor JKR is right
KINDS: dict[str, dict[str, float]] = {
    "paraboloid": {"radius": 47e-6},
    "cone": {"slope": 0.13},
    "flat_punch": {"radius": 2.3e-6},
    "power_law": {"exponent": 2.7, "width": 11e-6, "rise": 2.1e-6},
    "rounded_cone": {"slope": 0.13, "blend_radius": 2.9e-6},
    "truncated_cone": {"slope": 0.07, "flat_radius": 1.7e-6},
}
"""About what the parameters of the asperities are."""
COHESIVE = ("paraboloid", "flat_punch", "power_law", "rounded_cone")
"""Those that are looked at with adhesion of finite range."""
QUICK = ("paraboloid", "cone", "power_law")
SAME_BITS = {("elastic", kind) for kind in ("paraboloid", "cone", "flat_punch")} | {
    ("jkr", "cone"),
    ("jkr", "flat_punch"),
}
"""Laws that only add, multiply, divide and take square roots of what has no unit."""
COUNT, LOW = 300, 200  # more than a block of the sum
HEIGHT = 1.1e-6  # standard deviation of the heights [m]
VARIABLES = ["force", "contact_area", "contact_count", "stiffness", "energy", "dissipated_energy"]
POWERS = {"force": (0, 1), "contact_area": (2, 0), "contact_count": (0, 0), "stiffness": (-1, 1)} | dict.fromkeys(
    ("energy", "dissipated_energy"), (1, 1)
)
"""Of the units of length and force in each."""
UNITS = ((20, -13), (-7, 9), (3, 1))
"""Powers of two that lengths and forces are counted in."""
_WORKS = 4.0 ** -np.arange(40.0)
_SMALL, _LARGE = 1e-9, 1e-3  # of the answer: between them a difference has one power of w


class Check(NamedTuple):
    """One change, of one law and shape."""

    name: str
    law: str
    kind: str
    error: float
    allowed: float


def law_of(law: str, kind: str) -> dict[str, Any]:
    """The material."""
    asked: dict[str, Any] = {"effective_modulus": MODULUS, "work": 0.0 if law == "elastic" else WORK}
    if law == "dugdale":
        strength = TABOR / rm.tabor(SHAPES[kind](**KINDS[kind]), effective_modulus=MODULUS, work=WORK, strength=1.0)
        asked |= {"adhesion": "dugdale", "strength": strength}
    return asked


def ensemble(kind: str, seed: int = 3) -> xr.Dataset:
    """Asperities of all sizes about those of ``KINDS``; steep powers less."""
    rng = np.random.default_rng(seed)
    height = rng.normal(0.0, HEIGHT, COUNT)
    columns = {name: about * np.exp(rng.normal(0.0, 0.1, COUNT)) for name, about in KINDS[kind].items()}
    data = {name: ("asperity", column) for name, column in {"height": height, **columns}.items()}
    return xr.Dataset(data, attrs={"shape": kind})


def path(asked: dict[str, Any]) -> Floats:
    """Steps [m] from out of contact to half-way in."""
    reach = asked["work"] / asked["strength"] if "strength" in asked else 0.0
    return np.linspace(3.0 * HEIGHT + reach, -0.3 * HEIGHT, 9)


def answered(data: xr.Dataset, separation: Floats, asked: dict[str, Any]) -> dict[str, Floats]:
    """The law in and out."""
    found = rm.load_separation(data, separation=separation, unload=True, variables=VARIABLES, **asked)
    return {name: found[name].to_numpy() for name in VARIABLES}


def apart(one: dict[str, Floats], other: dict[str, Floats]) -> float:
    """The largest difference of any variable over its largest magnitude."""
    return max(
        float(np.abs(one[name] - other[name]).max() / max(np.abs(other[name]).max(), np.finfo(float).tiny))
        for name in VARIABLES
    )


def in_other_units(data: xr.Dataset, asked: dict[str, Any], length: int, force: int) -> dict[str, Floats]:
    """The law where lengths and forces are counted in 2^-length m and 2^-force N, back in SI."""
    units = {"height": "m", **SHAPES[data.attrs["shape"]].units}
    scaled = data.assign(
        {name: np.ldexp(data[name], length * (units[name] == "m")) for name in map(str, data.data_vars)}
    )
    powers = {"effective_modulus": force - 2 * length, "strength": force - 2 * length, "work": force - length}
    there = {name: math.ldexp(value, powers[name]) if name in powers else value for name, value in asked.items()}
    found = answered(scaled, np.ldexp(path(asked), length), there)
    return {name: np.ldexp(found[name], -length * POWERS[name][0] - force * POWERS[name][1]) for name in VARIABLES}


def visits(data: xr.Dataset, asked: dict[str, Any]) -> int:
    """How often an asperity is visited."""
    adhesion = Adhesion.checked(asked.get("adhesion", "jkr"), asked["work"], asked.get("strength"))
    route = LoadingPath.along(path(asked), unload=True, adhesive=adhesion.work > 0.0)
    own = Ensemble.from_dataset(data)
    return compute(
        own, route, effective_modulus=asked["effective_modulus"], adhesion=adhesion, variables=["force"]
    ).visits


def without_adhesion(shape: Shape, asked: dict[str, Any]) -> tuple[float, float]:
    """How far the powers of w that radius and force come to Hertz with are from 1/2 and 1, and what is left at last."""
    hertz = rm.indent(shape, effective_modulus=MODULUS, indentation=HEIGHT)
    found = [rm.indent(shape, **{**asked, "work": WORK * part}, indentation=HEIGHT) for part in _WORKS]
    wrong, left = 0.0, 0.0
    for name, power in (("contact_radius", 0.5), ("force", 1.0)):
        away = np.abs(np.array([float(each[name]) for each in found]) / float(hertz[name]) - 1.0)
        chosen = (away > _SMALL) & (away < _LARGE)
        slope = np.polynomial.polynomial.polyfit(np.log(_WORKS[chosen]), np.log(away[chosen]), 1)[1]
        wrong, left = max(wrong, abs(float(slope) - power)), max(left, float(away[-1]))
    return wrong, left


def checks(quick: bool) -> list[Check]:
    """All of them; roughly, of three shapes."""
    kinds = [kind for kind in KINDS if not quick or kind in QUICK]
    pairs = [(law, kind) for law in ("elastic", "jkr") for kind in kinds]
    pairs += [("dugdale", kind) for kind in kinds if kind in COHESIVE]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        return [Check(name, *pair, error, allowed) for pair in pairs for name, error, allowed in _checks(*pair)]


def _checks(law: str, kind: str) -> Iterator[tuple[str, float, float]]:
    data, asked, rng = ensemble(kind), law_of(law, kind), np.random.default_rng(7)
    way = path(asked)
    whole = answered(data, way, asked)
    other = max(apart(in_other_units(data, asked, *units), whole) for units in UNITS)
    same = (law, kind) in SAME_BITS
    yield "units, only + x / sqrt" if same else "units", other, 0.0 if same else 1e-13
    yield "order", apart(answered(data.isel(asperity=rng.permutation(COUNT)), way, asked), whole), 0.0
    parts = [answered(data.isel(asperity=part), way, asked) for part in (slice(0, 117), slice(117, None))]
    yield "two parts", apart({name: parts[0][name] + parts[1][name] for name in VARIABLES}, whole), 1e-14
    beyond = asked["work"] / asked["strength"] if law == "dugdale" else 0.0
    low = ensemble(kind, seed=5).isel(asperity=slice(0, LOW))
    low = low.assign(height=("asperity", way.min() - beyond - rng.uniform(0.01, 5.0, LOW) * HEIGHT))
    more = xr.concat([data, low], "asperity", combine_attrs="override")
    yield "asperities out of reach", apart(answered(more, way, asked), whole), 0.0
    yield "visits of asperities out of reach", float(abs(visits(more, asked) - visits(data, asked))), 0.0
    if law != "elastic" and kind != "flat_punch":  # whose contact is the same without adhesion
        wrong, left = without_adhesion(SHAPES[kind](**KINDS[kind]), asked)
        yield "power of w on the way to Hertz", wrong, 0.01
        yield "Hertz at w/4^39", left, 1e-11
