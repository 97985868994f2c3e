"""Random scenes over all that a scene may ask for, each small enough to be one of thousands.

Lengths lie around one size, stresses around one modulus, so that most scenes have contacts to compute; a few numbers
are as extreme as floats can be, so that each of them meets the check that must refuse it.
"""

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter

import roughmdr as rm
from roughmdr.shapes import SCENE_SHAPES, SHAPES
from roughmdr.variables import CONDUCTANCES, CURVE_VARIABLES
from studies.random_scenes.numbers import (
    Draw,
    Table,
    distribution,
    entry,
    number,
    power_of_ten,
    quantity,
    seldom,
    viscoelastic,
)

_FILE_SIZE = 1e-6  # scale of the heights in files [m]
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
_PLACEMENTS = {"placement": "hexagonal", "vacancies": True}, {"placement": "hard_core", "min_distance": 1e-9}


def write_inputs(folder: Path) -> None:
    """Write the files that scenes read: a small ensemble of each shape and two small maps."""
    profiles: dict[str, Table] = {
        "power_series": {"terms": {"2": 1e4, "4": 1e13}},
        "tabulated": {"r": [0.0, 1e-5, 3e-5, 6e-5], "f": [0.0, 5e-7, 5e-6, 3e-5]},
    }
    height = {"distribution": "normal", "std": _FILE_SIZE}
    for name, shape in SCENE_SHAPES.items():
        numbers = {key: 1e2 * _FILE_SIZE if shape.units[key] == "m" else 2.5 for key in shape.parameter_sets[-1]}
        section: Table = {"source": "random", "shape": name, "count": 5, "patch": 1e-3, "height": height}
        rm.generate(section | profiles.get(name, numbers), seed=1).to_netcdf(folder / f"{name}.nc")
    smooth = gaussian_filter(np.random.default_rng(1).standard_normal((48, 48)), 2.25, mode="wrap")
    x = np.arange(48) * 1e-6
    rough = xr.Dataset({"height": (("x", "y"), smooth * (_FILE_SIZE / smooth.std()))}, coords={"x": x, "y": x})
    rough.assign_attrs(periodic=1).to_netcdf(folder / "periodic.nc")
    rough.where(rough.height < 2.5 * _FILE_SIZE).to_netcdf(folder / "open.nc")


class Frame(NamedTuple):
    """The scales that the numbers of a scene lie around, and what restricts them."""

    size: float  # [m]
    effective_modulus: float  # [Pa]
    datum: float  # the mean of the heights [m]
    smooth: bool  # whether the expected curve is, or may be, computed
    expensive: bool  # whether each asperity takes milliseconds to set up: adhesion of finite range on most shapes

    @property
    def max_distributed(self) -> int:
        """How many shape parameters may be distributed."""
        return len(SHAPES) if not self.smooth else 0 if self.expensive else 1


def shape_parameters(draw: Draw, frame: Frame, shape: str) -> Table:
    """Draw the parameters of asperities."""
    if shape in PARAMETERS:
        return _plain_parameters(draw, frame, shape)
    exponent, width, rise = number(draw, -0.28, 1.0), number(draw, 0, 3, frame.size), number(draw, -1, 2, frame.size)
    power = math.log10(rise) - exponent * math.log10(width)
    coefficient = _limited_power_of_ten(power)
    if shape == "power_law":
        if not frame.max_distributed:
            return {"exponent": exponent, "coefficient": coefficient}
        if draw(st.booleans()):
            return {"exponent": entry(draw, exponent, "1"), "width": width, "rise": rise}
        return {"exponent": exponent, "coefficient": entry(draw, coefficient, "1")}
    if shape == "power_series":
        powers = (power - k * math.log10(frame.size) for k in range(draw(st.integers(1, 3))))
        return {"terms": {str(exponent + k): _limited_power_of_ten(each) for k, each in enumerate(powers)}}
    r = np.linspace(0.0, 1.0, draw(st.integers(3, 9)))
    flat = 0.2 * draw(st.booleans())
    profile = np.maximum(r - flat, 0.0) ** power_of_ten(draw, 0.0, 0.7)
    return {"r": (width * r).tolist(), "f": (rise * profile).tolist()}


def _limited_power_of_ten(power: float) -> float:
    """Return ten to a power, limited to what floats hold."""
    return float(10.0 ** min(max(power, -300.0), 300.0))


def _plain_parameters(draw: Draw, frame: Frame, shape: str) -> Table:
    """Draw those of a shape whose parameters may be distributed."""
    found: Table = {}
    sizes: dict[str, float] = {}
    for name, ends in PARAMETERS[shape].items():
        dimension = SHAPES[shape].units[name]
        unit = 1.0 if dimension != "m" else sizes["radius"] if name == "cap_radius" else frame.size
        sizes[name] = number(draw, *ends, unit)
        if len(found) >= frame.max_distributed:
            found[name] = quantity(draw, sizes[name], dimension)
        else:
            found[name] = entry(draw, sizes[name], dimension, bounded=bool(SHAPES[shape].not_below))
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
    section: Table = {"source": "random", "shape": shape, "patch": number(draw, 4, 7, frame.size), "height": height}
    count = draw(st.integers(1, 3 if frame.expensive else 300))
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
            name, ends = next(iter(PARAMETERS[shape].items()))
            section["second"][name] = number(draw, *ends, 1.0 if name == "slope" else frame.size)
    if seldom(draw, 20):
        section |= draw(st.sampled_from(_PLACEMENTS))
    return section | parameters


def nayak_asperities(draw: Draw, frame: Frame) -> Table:
    """Draw a section with source = "nayak", some tens of summits."""
    across = power_of_ten(draw, 0.3, 1.0)
    if draw(st.booleans()):
        m0, m2 = number(draw, -1, 1, frame.size * frame.size), number(draw, -4, 0)
        m4 = (1.5 + number(draw, -2, 3)) * m2 * m2 / m0 if m0 > 0.0 and m2 < 1e100 else 1.0
        side = across * 5.7 * math.sqrt(m2 / m4) if m4 > 0.0 else 1.0
        return {"source": "nayak", "m0": m0, "m2": m2, "m4": m4, "patch": side}
    short = number(draw, 0, 2, frame.size)
    hurst, long = draw(st.floats(0.0, 1.0)), short * power_of_ten(draw, 0.01, 2.0)
    amplitude = {"rms_height": frame.size} if draw(st.booleans()) else {"rms_slope": number(draw, -3, 0)}
    waves = {"hurst": hurst, "long_wave": long, "short_wave": short}
    return {"source": "nayak", **waves, **amplitude, "patch": 2.0 * across * short}


def asperities(draw: Draw, frame: Frame, shape: str, source: str, folder: Path) -> Table:
    """Draw [asperities]."""
    if source == "random":
        return random_asperities(draw, frame, shape)
    if source == "nayak":
        return nayak_asperities(draw, frame)
    if source == "file":
        return {"source": "file", "file": str(folder / f"{shape}.nc")}
    section: Table = {"source": "surface", "file": str(folder / draw(st.sampled_from(("periodic.nc", "open.nc"))))}
    options = {"detrend": ("none", "mean", "plane", "quadratic"), "periodic": (True, False), "cutoff": ("3 um", 8e-6)}
    return section | {key: draw(st.sampled_from(values)) for key, values in options.items() if seldom(draw, 4)}


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
        section["error"] = power_of_ten(draw, -4.0, 0.0)
    return section


def material(draw: Draw, frame: Frame) -> Table:
    """Draw [material] and [counter]."""
    if draw(st.booleans()):
        return {"material": {"effective_modulus": quantity(draw, frame.effective_modulus, "Pa")}}
    ratio = st.sampled_from((0.0, 0.3, 0.49, 0.5, -0.9))
    bodies = {"material": {"modulus": quantity(draw, frame.effective_modulus, "Pa"), "poisson": draw(ratio)}}
    if draw(st.booleans()):
        modulus = quantity(draw, number(draw, 0.0, 4.0, frame.effective_modulus), "Pa")
        bodies["counter"] = {"modulus": modulus, "poisson": draw(ratio)}
    return bodies


def path(draw: Draw, frame: Frame) -> Table:
    """Draw [path]: a range in metres or sigma, or a list that goes up and down and returns to earlier heights."""
    unload = draw(st.booleans())
    if draw(st.booleans()):
        heights = draw(st.lists(st.integers(-6, 10), min_size=1, max_size=12))
        return {"separation": [frame.datum + 0.5 * frame.size * each for each in heights], "unload": unload}
    start, stop, steps = draw(st.floats(0.0, 5.0)), draw(st.floats(-3.0, 2.0)), draw(st.integers(2, 25))
    separation = {"start": frame.datum + start * frame.size, "stop": frame.datum + stop * frame.size, "steps": steps}
    if frame.datum == 0.0 and draw(st.booleans()):
        separation |= {"start": f"{start:.6f} sigma", "stop": f"{stop:.6f} sigma"}
    return {"separation": separation, "unload": unload}


def batch(draw: Draw, frame: Frame, *, drawn: bool) -> Table:
    """Draw [output], [batch] and [accuracy]."""
    names = draw(st.lists(st.sampled_from(sorted(CURVE_VARIABLES | CONDUCTANCES)), min_size=1, max_size=9, unique=True))
    keep = draw(st.sampled_from(("curves", "statistics")))
    parts: Table = {
        "output": {"variables": names if draw(st.booleans()) else sorted(CURVE_VARIABLES | CONDUCTANCES), "keep": keep}
    }
    parts["conduction"] = {"conductivity": power_of_ten(draw, -2.0, 3.0), "resistivity": power_of_ten(draw, -8.0, 9.0)}
    if not drawn:
        return parts
    if frame.smooth and draw(st.booleans()):
        return parts | {"batch": {"estimator": "expected"}}
    if frame.smooth or seldom(draw, 12):
        method = "auto" if frame.smooth else draw(st.sampled_from(("sampled", "stratified")))
        relative, most = power_of_ten(draw, -3.0, 0.0), draw(st.integers(2, 3 if frame.expensive else 20))
        return parts | {"accuracy": {"relative": relative, "max_realizations": most, "method": method}}
    estimator = draw(st.sampled_from(("sampled", "sampled", "stratified")))
    realizations = draw(st.integers(1, 2 if frame.expensive else 4))
    return parts | {"batch": {"estimator": estimator, "realizations": realizations}}


def sweep(draw: Draw, table: Table) -> Table:
    """Draw [sweep] over one or two keys of the scene."""
    section, height, separation = table["asperities"], table["asperities"].get("height"), table["path"]["separation"]
    keys: dict[str, list[Any]] = {"material.poisson": [0.2, 0.5]} if "poisson" in table["material"] else {}
    if "adhesion" in table:
        work = table["adhesion"]["work"]
        values = draw(st.permutations([0.0, work, 10.0 * work])) if isinstance(work, float) else [work, 0.0]
        keys["adhesion.work"] = values
    if "count" in section:
        keys["asperities.count"] = [section["count"], section["count"] + 1]
    if isinstance(height, dict) and isinstance(height.get("scale"), float):
        keys["asperities.height.scale"] = [height["scale"], 2.0 * height["scale"]]
    if isinstance(section.get("radius"), float):
        keys["asperities.radius"] = [section["radius"], 1.5 * section["radius"]]
    if isinstance(separation, dict):
        start = separation["start"]
        keys["path.separation.start"] = [start, "6 sigma"] if isinstance(start, str) else [start, start * 1.5]
    if not keys:
        return {}
    chosen = draw(st.lists(st.sampled_from(sorted(keys)), min_size=1, max_size=2, unique=True))
    if seldom(draw, 4):
        return {"sweep": {"mode": "zip", **{key: keys[key][:2] for key in chosen}}}
    return {"sweep": {key: keys[key][: draw(st.integers(1, 3))] for key in chosen}}


@st.composite
def scenes(draw: Draw, folder: Path, cohesive: tuple[str, ...]) -> Table:
    """Draw a whole scene, as a table: ``folder`` holds its files, ``cohesive`` shapes have adhesion of finite range."""
    source = draw(st.sampled_from(("random",) * 8 + ("nayak", "file", "surface")))
    shapes = [shape for shape in SCENE_SHAPES if shape != "tabulated"] * 3 + ["tabulated"]
    shape = draw(st.sampled_from(shapes)) if source in ("random", "file") else "paraboloid"
    models = ("none", "jkr", "jkr", "dugdale", "auto") if shape in cohesive else ("none", "jkr")
    model = draw(st.sampled_from(models))
    drawn = source in ("random", "nayak")
    smooth = drawn and seldom(draw, 60)
    size = number(draw, -9.5, 0.0) if drawn else _FILE_SIZE
    remote = source == "random" and not smooth and seldom(draw, 12)
    datum = size * power_of_ten(draw, 0.0, 9.0) if remote else 0.0
    expensive = model in ("dugdale", "auto") and shape not in ("paraboloid", "flat_punch")
    frame = Frame(size, number(draw, 3.0, 12.0), datum, smooth, expensive)
    table: Table = {"title": "Drawn", "seed": draw(st.integers(0, 2**63 - 1)), **material(draw, frame)}
    if model != "none":
        table["adhesion"] = adhesion(draw, frame, model)
    table["asperities"] = asperities(draw, frame, shape, source, folder)
    table |= {"path": path(draw, frame), **batch(draw, frame, drawn=drawn)}
    if model == "none" and seldom(draw, 3):
        table |= viscoelastic(draw, frame.size, frame.datum)
    return table | (sweep(draw, table) if seldom(draw, 5) else {})
