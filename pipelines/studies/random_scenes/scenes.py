"""Random scenes over all that a scene may ask for, each small enough to be one of thousands.

Lengths lie around one size, stresses around one modulus, so that most scenes have contacts to compute; a few numbers
are as extreme as floats can be, so that each of them meets the check that must refuse it.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st
from studies.random_scenes.inputs import FILE_SIZE, Inputs
from studies.random_scenes.numbers import Draw, Table, distribution, entry, number, quantity, seldom

from roughmdr.shapes import SHAPES
from roughmdr.variables import CURVE_VARIABLES

# Powers of ten of shape parameters; of lengths over the size of all.
FLANK, NARROW, WIDE, ROUND = (-4.0, 0.5), (-1.0, 2.0), (0.0, 3.0), (0.0, 4.0)
PARAMETERS: dict[str, dict[str, tuple[float, float]]] = {
    "paraboloid": {"radius": ROUND},
    "cone": {"slope": FLANK},
    "flat_punch": {"radius": NARROW},
    "sphere": {"radius": ROUND},
    "truncated_cone": {"slope": FLANK, "flat_radius": NARROW},
    "truncated_paraboloid": {"radius": ROUND, "flat_radius": NARROW},
    "rounded_cone": {"slope": FLANK, "blend_radius": NARROW},
    "capped_paraboloid": {"radius": WIDE, "cap_radius": (1.0, 3.0), "blend_radius": NARROW},
    "rounded_punch": {"flat_radius": NARROW, "edge_radius": ROUND},
}


class Frame(NamedTuple):
    """The scales that the numbers of a scene lie around, and what restricts them."""

    size: float
    """[m]"""
    effective_modulus: float
    """[Pa]"""
    datum: float
    """The mean of the heights [m]."""
    smooth: bool
    """Whether the expected curve is, or may be, computed."""
    expensive: bool
    """Whether each asperity takes milliseconds to set up: adhesion of finite range on most shapes."""

    @property
    def max_distributed(self) -> int:
        """How many shape parameters may be distributed."""
        return len(SHAPES) if not self.smooth else 0 if self.expensive else 1

    @property
    def max_asperities(self) -> int:
        """How many asperities a realisation may have."""
        return 3 if self.expensive else 300


def shape_parameters(draw: Draw, frame: Frame, shape: str) -> Table:
    """Draw the parameters of asperities."""
    if shape in PARAMETERS:
        return _plain_parameters(draw, frame, shape)
    exponent, width, rise = number(draw, -0.28, 1.0), number(draw, 0, 3, frame.size), number(draw, -1, 2, frame.size)
    power = math.log10(rise) - exponent * math.log10(width)
    coefficient = _power_of_ten(power)
    if shape == "power_law":
        if not frame.max_distributed:
            return {"exponent": exponent, "coefficient": coefficient}
        if draw(st.booleans()):
            return {"exponent": entry(draw, exponent, "1"), "width": width, "rise": rise}
        return {"exponent": exponent, "coefficient": entry(draw, coefficient, "1")}
    if shape == "power_series":
        decade = math.log10(frame.size)
        return {"terms": {str(exponent + k): _power_of_ten(power - k * decade) for k in range(draw(st.integers(1, 3)))}}
    r = np.linspace(0.0, 1.0, draw(st.integers(3, 9)))
    flat = 0.2 * draw(st.booleans())
    profile = np.maximum(r - flat, 0.0) ** 10.0 ** draw(st.floats(0.0, 0.7))
    return {"r": (width * r).tolist(), "f": (rise * profile).tolist()}


def _power_of_ten(power: float) -> float:
    """Return ten to a power, limited to what floats hold."""
    return float(10.0 ** min(max(power, -300.0), 300.0))


def _plain_parameters(draw: Draw, frame: Frame, shape: str) -> Table:
    """Draw those of a shape whose parameters may be distributed."""
    ordered = bool(SHAPES[shape].not_below)
    found: Table = {}
    sizes: dict[str, float] = {}
    for name, ends in PARAMETERS[shape].items():
        dimension = SHAPES[shape].units[name]
        unit = 1.0 if dimension != "m" else sizes["radius"] if name == "cap_radius" else frame.size
        sizes[name] = number(draw, *ends, unit)
        if len(found) >= frame.max_distributed:
            found[name] = quantity(draw, sizes[name], dimension)
        else:
            found[name] = entry(draw, sizes[name], dimension, bounded=ordered)
    return found


def random_asperities(draw: Draw, frame: Frame, shape: str) -> Table:
    """Draw a section with source = "random"."""
    height: Any = distribution(draw, frame.size, "m", positive=False)
    if frame.datum:
        middle = "mean" if "std" in height else "loc"
        height = {key: value for key, value in height.items() if key not in ("min", "max")} | {middle: frame.datum}
    if seldom(draw, 40):
        height = frame.datum
    parameters = shape_parameters(draw, frame, shape)
    section: Table = {"source": "random", "shape": shape, "patch": number(draw, 1, 4, frame.size), "height": height}
    count = draw(st.integers(1, frame.max_asperities))
    if seldom(draw, 5):
        section["density"] = count / section["patch"] / section["patch"] if section["patch"] > 1e-150 else 1.0
    else:
        section["count"] = count
    drawn = [name for name, value in parameters.items() if isinstance(value, dict) and name != "terms"]
    if drawn and isinstance(height, dict) and seldom(draw, 4):
        section["correlation"] = {drawn[0]: draw(st.floats(-1.0, 1.0))}
    if seldom(draw, 6):
        section["second"] = {"share": draw(st.sampled_from((0.01, 0.2, 0.5, 1.0)))}
        if draw(st.booleans()):
            section["second"]["height"] = distribution(draw, 0.3 * frame.size, "m", positive=False)
        if shape in PARAMETERS and not SHAPES[shape].not_below:
            name = next(iter(PARAMETERS[shape]))
            section["second"][name] = number(draw, *PARAMETERS[shape][name], 1.0 if name == "slope" else frame.size)
    if seldom(draw, 20):
        section |= draw(st.sampled_from(({"placement": "hexagonal"}, {"placement": "hard_core", "min_distance": 1e-9})))
    return section | parameters


def nayak_asperities(draw: Draw, frame: Frame) -> Table:
    """Draw a section with source = "nayak", some tens of summits."""
    across = 10.0 ** draw(st.floats(0.3, 1.0))
    if draw(st.booleans()):
        m0, m2 = number(draw, -1, 1, frame.size * frame.size), number(draw, -4, 0)
        m4 = (1.5 + number(draw, -2, 3)) * m2 * m2 / m0 if m0 > 0.0 and m2 < 1e100 else 1.0
        side = across * 5.7 * math.sqrt(m2 / m4) if m4 > 0.0 else 1.0
        return {"source": "nayak", "m0": m0, "m2": m2, "m4": m4, "patch": side}
    short = number(draw, 0, 2, frame.size)
    waves = {
        "hurst": draw(st.floats(0.0, 1.0)),
        "long_wave": short * 10.0 ** draw(st.floats(0.01, 2.0)),
        "short_wave": short,
    }
    amplitude = {"rms_height": frame.size} if draw(st.booleans()) else {"rms_slope": number(draw, -3, 0)}
    return {"source": "nayak", **waves, **amplitude, "patch": 2.0 * across * short}


def asperities(draw: Draw, frame: Frame, shape: str, source: str, inputs: Inputs) -> Table:
    """Draw [asperities]."""
    if source == "random":
        return random_asperities(draw, frame, shape)
    if source == "nayak":
        return nayak_asperities(draw, frame)
    if source == "file":
        return {"source": "file", "file": inputs.ensembles[shape]}
    section: Table = {"source": "surface", "file": draw(st.sampled_from(inputs.maps))}
    for key, values in (
        ("detrend", ("none", "mean", "plane", "quadratic")),
        ("periodic", (True, False)),
        ("cutoff", ("3 um", 8e-6)),
    ):
        if seldom(draw, 4):
            section[key] = draw(st.sampled_from(values))
    return section


def adhesion(draw: Draw, frame: Frame, model: str) -> Table:
    """Draw [adhesion]."""
    work = number(draw, -8.0, 0.0, frame.effective_modulus * frame.size)
    work = 0.0 if seldom(draw, 20) else work
    section: Table = {"model": model, "work": quantity(draw, work, "J/m^2")}
    length = number(draw, -4.0, 1.0, frame.size)
    if model != "jkr" or seldom(draw, 6):
        if draw(st.booleans()) and work > 0.0 and length > 0.0 and 0.0 < work / length < math.inf:
            section["strength"] = quantity(draw, work / length, "Pa")
        else:
            section["range"] = quantity(draw, length, "m")
    if model == "auto" and draw(st.booleans()):
        section["error"] = 10.0 ** draw(st.floats(-4.0, 0.0))
    return section


def material(draw: Draw, frame: Frame) -> Table:
    """Draw [material] and [counter]."""
    if draw(st.booleans()):
        return {"material": {"effective_modulus": quantity(draw, frame.effective_modulus, "Pa")}}
    ratio = st.sampled_from((0.0, 0.3, 0.49, 0.5, -0.9))
    bodies = {"material": {"modulus": quantity(draw, frame.effective_modulus, "Pa"), "poisson": draw(ratio)}}
    if draw(st.booleans()):
        bodies["counter"] = {
            "modulus": quantity(draw, number(draw, 0.0, 4.0, frame.effective_modulus), "Pa"),
            "poisson": draw(ratio),
        }
    return bodies


def path(draw: Draw, frame: Frame) -> Table:
    """Draw [path]: a range in metres or sigma, or a list that goes up and down and returns to earlier heights."""
    unload = draw(st.booleans())
    if draw(st.booleans()):
        heights = draw(st.lists(st.integers(-6, 10), min_size=1, max_size=12))
        return {"separation": [frame.datum + 0.5 * frame.size * each for each in heights], "unload": unload}
    start, stop, steps = draw(st.floats(0.0, 5.0)), draw(st.floats(-3.0, 2.0)), draw(st.integers(2, 25))
    if frame.datum == 0.0 and draw(st.booleans()):
        return {
            "separation": {"start": f"{start:.6f} sigma", "stop": f"{stop:.6f} sigma", "steps": steps},
            "unload": unload,
        }
    ends = {"start": frame.datum + start * frame.size, "stop": frame.datum + stop * frame.size}
    return {"separation": {**ends, "steps": steps}, "unload": unload}


def batch(draw: Draw, frame: Frame, *, drawn: bool) -> Table:
    """Draw [output], [batch] and [accuracy]."""
    names = draw(st.lists(st.sampled_from(sorted(CURVE_VARIABLES)), min_size=1, max_size=9, unique=True))
    keep = draw(st.sampled_from(("curves", "statistics")))
    parts: Table = {"output": {"variables": names if draw(st.booleans()) else sorted(CURVE_VARIABLES), "keep": keep}}
    if not drawn:
        return parts
    if frame.smooth and draw(st.booleans()):
        return parts | {"batch": {"estimator": "expected"}}
    if frame.smooth or seldom(draw, 12):
        method = "auto" if frame.smooth else draw(st.sampled_from(("sampled", "stratified")))
        asked = {
            "relative": 10.0 ** draw(st.floats(-3.0, 0.0)),
            "max_realizations": draw(st.integers(2, 3 if frame.expensive else 20)),
        }
        return parts | {"accuracy": {**asked, "method": method}}
    estimator = draw(st.sampled_from(("sampled", "sampled", "stratified")))
    return parts | {
        "batch": {"estimator": estimator, "realizations": draw(st.integers(1, 2 if frame.expensive else 4))}
    }


def sweep(draw: Draw, table: Table) -> Table:
    """Draw [sweep] over one or two keys of the scene."""
    section, height = table["asperities"], table["asperities"].get("height")
    keys: dict[str, list[Any]] = {"material.poisson": [0.2, 0.5]} if "poisson" in table["material"] else {}
    if "adhesion" in table:
        work = table["adhesion"]["work"]
        keys["adhesion.work"] = (
            draw(st.permutations([0.0, work, 10.0 * work])) if isinstance(work, float) else [work, 0.0]
        )
    if "count" in section:
        keys["asperities.count"] = [section["count"], section["count"] + 1]
    if isinstance(height, dict) and isinstance(height.get("scale"), float):
        keys["asperities.height.scale"] = [height["scale"], 2.0 * height["scale"]]
    if isinstance(section.get("radius"), float):
        keys["asperities.radius"] = [section["radius"], 1.5 * section["radius"]]
    if isinstance(table["path"]["separation"], dict):
        start = table["path"]["separation"]["start"]
        keys["path.separation.start"] = [start, "6 sigma"] if isinstance(start, str) else [start, start * 1.5]
    if not keys:
        return {}
    chosen = draw(st.lists(st.sampled_from(sorted(keys)), min_size=1, max_size=2, unique=True))
    if seldom(draw, 4):
        return {"sweep": {"mode": "zip", **{key: keys[key][:2] for key in chosen}}}
    return {"sweep": {key: keys[key][: draw(st.integers(1, 3))] for key in chosen}}


@st.composite
def scenes(draw: Draw, inputs: Inputs) -> Table:
    """Draw a whole scene, as a table."""
    source = draw(st.sampled_from(("random",) * 8 + ("nayak", "file", "surface")))
    shapes = [shape for shape in SHAPES if shape != "tabulated"] * 3 + ["tabulated"]
    shape = draw(st.sampled_from(shapes)) if source in ("random", "file") else "paraboloid"
    models = ("none", "jkr", "jkr", "dugdale", "auto") if shape in inputs.cohesive else ("none", "jkr")
    model = draw(st.sampled_from(models))
    drawn = source in ("random", "nayak")
    smooth = drawn and seldom(draw, 60)
    size = number(draw, -9.5, 0.0) if drawn else FILE_SIZE
    datum = size * 10.0 ** draw(st.floats(0.0, 9.0)) if source == "random" and not smooth and seldom(draw, 12) else 0.0
    expensive = model in ("dugdale", "auto") and shape not in ("paraboloid", "flat_punch")
    frame = Frame(size, number(draw, 3.0, 12.0), datum, smooth, expensive)
    table: Table = {"title": "Drawn", "seed": draw(st.integers(0, 2**63 - 1)), **material(draw, frame)}
    if model != "none":
        table["adhesion"] = adhesion(draw, frame, model)
    table["asperities"] = asperities(draw, frame, shape, source, inputs)
    table |= {"path": path(draw, frame), **batch(draw, frame, drawn=drawn)}
    return table | (sweep(draw, table) if seldom(draw, 5) else {})
