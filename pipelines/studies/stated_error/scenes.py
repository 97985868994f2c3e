"""Random scenes over all shapes, adhesion models, distributions, paths and estimators."""

import math
from typing import Any, NamedTuple

import numpy as np

from roughmdr.shapes import SCENE_SHAPES, SHAPES

Table = dict[str, Any]
Rng = np.random.Generator

SEED = 2026
ESTIMATORS = ("sampled", "stratified", "expected")
ADHESIONS = ("none", "jkr", "dugdale")
COHESIVE = ("paraboloid", "flat_punch", "truncated_cone")
"""Shapes drawn with adhesion of finite range, the last not for the expected curve: each of the others takes half a
minute to compile, and seconds for its reference."""
_EXPONENTS = (1, 1.5, 2, 2.5, 3, 4, 6)  # exponents of power series
_LARGEST_WORK = 10.0  # [J/m2]


class RandomScene(NamedTuple):
    """A scene and its choices."""

    number: int
    shape: str
    adhesion: str
    estimator: str
    table: Table


class Scales(NamedTuple):
    """Lengths [m]: a tip is ``rise`` high at the radius ``width``, and ``depth`` is its natural depth with adhesion.

    Heights have a standard deviation of about ``std`` around about ``datum``.
    """

    width: float
    rise: float
    depth: float
    std: float
    datum: float


def decades(rng: Rng, low: float, high: float) -> float:
    """Draw a number between powers of ten, uniform in its logarithm."""
    return float(10.0 ** rng.uniform(low, high))


def scene(number: int) -> RandomScene:
    """Return the scene of a number; every fourth is for the expected curve."""
    rng = np.random.default_rng([SEED, number])
    estimator = "expected" if number % 4 == 0 else str(rng.choice(["sampled", "sampled", "stratified"]))
    adhesion = str(rng.choice(ADHESIONS, p=[0.25, 0.6, 0.15]))
    shapes = list(SCENE_SHAPES) if adhesion != "dugdale" else COHESIVE[: 2 if estimator == "expected" else 3]
    shape = str(rng.choice(shapes))
    nayak = shape == "paraboloid" and rng.uniform() < 0.2
    effective_modulus, width, slope = decades(rng, 3, 13), decades(rng, -9, 0), decades(rng, -4, 0)
    stretch = decades(rng, -2, 1.5)  # dl at the edge of a contact of this width, over the rise of the tip there
    rise = slope * width
    work = min(stretch**2 * rise**2 * effective_modulus / (2.0 * math.pi * width), _LARGEST_WORK)
    dl = math.sqrt(2.0 * math.pi * width * work / effective_modulus)
    depth = rise * (dl / rise) ** (4.0 / 3.0) if adhesion != "none" else 0.0
    std = max(depth * decades(rng, -1.5, 2), rise * 1e-6) if adhesion != "none" else rise * decades(rng, -3, 0.5)
    datum = 0.0 if rng.uniform() < 0.8 else float(rng.choice([-1.0, 1.0])) * std * decades(rng, 1, 7)
    scales = Scales(width, rise, depth, std, 0.0 if nayak else datum)
    asperities = _summits(rng, scales) if nayak else _asperities(rng, shape, adhesion, estimator, scales)
    table: Table = {
        "title": f"Random scene {number}",
        "seed": int(rng.integers(2**31)),
        "material": {"effective_modulus": effective_modulus},
        "asperities": asperities,
        "path": _path(rng, scales._replace(datum=2.0 * std) if nayak else scales),  # lower, contacts fill the patch
        "output": {"variables": ["force"]},
        "batch": {"estimator": estimator},
    }
    if adhesion != "none":
        table["adhesion"] = {"model": adhesion, "work": work}
    if adhesion == "dugdale":
        tabor = decades(rng, -2, 2)
        table["adhesion"]["strength"] = tabor * math.pi ** (2.0 / 3.0) * work / dl
    if estimator != "expected" and rng.uniform() < 0.2:
        table["batch"]["realizations"] = 3
        table["output"]["keep"] = "statistics"
    return RandomScene(number, shape, adhesion, estimator, table)


def _asperities(rng: Rng, shape: str, adhesion: str, estimator: str, scales: Scales) -> Table:
    slow = adhesion == "dugdale" and shape not in ("paraboloid", "flat_punch")
    count, patch = int(rng.integers(1, 3 if slow else 10)), 1e6 * scales.width
    height = _heights(rng, scales.std, scales.datum)
    section: Table = {"source": "random", "shape": shape, "count": count, "patch": patch, "height": height}
    if shape in ("power_series", "tabulated"):
        return section | _fixed_profile(rng, shape, scales)
    values = _tip(rng, shape, scales)
    max_varied = 0 if slow else len(values)
    if estimator == "expected":  # two at once take seconds, in the run and for its reference
        max_varied = min(max_varied, 2 if shape == "power_law" and rng.uniform() < 0.3 else 1)
    varied = list(rng.permutation(list(values)))[: int(rng.integers(0, max_varied + 1))]
    ordered = shape == "capped_paraboloid"
    for name, value in values.items():
        section[name] = _spread(rng, value, ordered or name == "exponent") if name in varied else value
    if varied and rng.uniform() < 0.25:
        section["correlation"] = {varied[0]: float(rng.uniform(-0.9, 0.9))}
    if rng.uniform() < 0.15:
        other = {name: value * (0.9 if ordered else decades(rng, -0.5, 0.5)) for name, value in values.items()}
        other.pop("exponent", None)
        changed = list(rng.permutation(list(other)))[: 0 if ordered else 1]
        share, std = float(rng.uniform(0.1, 0.9)), scales.std * decades(rng, -1, 0.5)
        height = _heights(rng, std, scales.datum + scales.std * float(rng.uniform(-1, 1)))
        section["second"] = {"share": share, "height": height, **{name: other[name] for name in changed}}
    return section


def _tip(rng: Rng, shape: str, scales: Scales) -> dict[str, float]:
    """Return parameters of a tip of this size."""
    width, rise, _, _, _ = scales
    radius, blend = width**2 / (2.0 * rise), width * decades(rng, -1.5, 0.5)
    values = {"slope": rise / width, "width": width, "rise": rise, "edge_radius": radius}
    values |= {"radius": width if shape == "flat_punch" else radius, "flat_radius": blend, "blend_radius": blend}
    if shape == "power_law":
        values["exponent"] = decades(rng, -0.1, 1.0)
    if shape == "capped_paraboloid":
        values["cap_radius"] = radius * (1.0 + decades(rng, -0.3, 1.5))
    return {name: values[name] for name in SHAPES[shape].parameter_sets[-1]}


def _fixed_profile(rng: Rng, shape: str, scales: Scales) -> Table:
    """Return the one profile of all asperities."""
    width, rise, _, _, _ = scales
    if shape == "power_series":
        exponents = sorted(rng.choice(_EXPONENTS, int(rng.integers(1, 4)), replace=False).tolist())
        shares = rng.uniform(0.1, 1.0, len(exponents)).tolist()
        return {"terms": {f"{n:g}": share * rise * width**-n for n, share in zip(exponents, shares, strict=True)}}
    r = np.append(0.0, np.cumsum(rng.uniform(0.3, 1.0, int(rng.integers(2, 7))))) * width
    return {"r": r.tolist(), "f": (rise * (r / width) ** rng.uniform(1.3, 3.0)).tolist()}


def _spread(rng: Rng, value: float, ordered: bool) -> Table:
    """Return a distribution about a value; a narrow one where parameters must stay ``ordered``."""
    if ordered or rng.uniform() < 0.4:
        width = float(rng.uniform(0.02, 0.36 if ordered else 1.0))
        return {"distribution": "uniform", "loc": value * (1.0 - 0.5 * width), "scale": value * width}
    return {"distribution": "lognormal", "mean": value, "std": value * decades(rng, -2, -0.2)}


def _heights(rng: Rng, std: float, datum: float) -> Table:
    normal = {"distribution": "normal", "mean": datum, "std": std}
    match rng.integers(6):
        case 0:
            return {"distribution": "expon", "loc": datum, "scale": std}
        case 1:
            return {"distribution": "uniform", "loc": datum - 1.7 * std, "scale": 3.4 * std}
        case 2:
            return {"distribution": "weibull_min", "c": float(rng.uniform(1.0, 4.0)), "mean": datum, "std": std}
        case 3:
            return normal | {"max": datum + float(rng.uniform(0.0, 2.0)) * std}
    return normal


def _summits(rng: Rng, scales: Scales) -> Table:
    """Return the summits of a Gaussian surface of about this roughness and size."""
    alpha, count = 1.5 + decades(rng, -1, 2), int(rng.integers(3, 10))
    m0, curvature = scales.std * scales.std, 2.0 * scales.rise / scales.width**2
    m4 = (3.0 / 8.0 * curvature) ** 2 * math.pi
    m2 = math.sqrt(m0 * m4 / alpha)
    patch = math.sqrt(count * 6.0 * math.pi * math.sqrt(3.0) * m2 / m4)
    return {"source": "nayak", "patch": patch, "m0": m0, "m2": m2, "m4": m4}


def _path(rng: Rng, scales: Scales) -> Table:
    """Return a path of loading, of loading and unloading, or back and forth."""
    low = scales.datum + scales.std * float(rng.uniform(-1.0, 0.5))
    high = scales.datum + scales.std * float(rng.uniform(1.0, 3.0))
    far = high + scales.depth * float(rng.uniform(0.0, 2.0))
    kind = rng.integers(4)
    if kind == 0:
        return {"separation": {"start": high, "stop": low, "steps": int(rng.integers(3, 9))}}
    if kind == 1:
        return {"separation": {"start": far, "stop": low, "steps": int(rng.integers(3, 7))}, "unload": True}
    inner = rng.uniform(low, far, int(rng.integers(1, 6))).tolist()
    return {"separation": [high, low, *inner] if kind == 2 else [high, *inner, low, *sorted(inner)]}
