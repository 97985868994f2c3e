"""Numbers, quantities with units and distributions, drawn for scenes."""

from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

from roughmdr.variables import CONDUCTANCES, CURVE_VARIABLES

Draw = Callable[[st.SearchStrategy[Any]], Any]
Table = dict[str, Any]

EXTREME = (5e-324, 1e-310, 1e-200, 1e-60, 1e-20, 1e20, 1e60, 1e200, 1.7e308)
ONE_IN = 60  # one number in so many is extreme
UNITS = {
    "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "angstrom": 1e-10},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/m^2": 1.0},
    "J/m^2": {"J/m^2": 1.0, "mJ/m^2": 1e-3, "N/m": 1.0, "erg/cm^2": 1e-3},
}
PLAIN = ("arcsine", "cauchy", "exponential", "gumbel_r", "halfnorm", "levy", "lognormal", "normal", "uniform")
FAMILIES: dict[str, dict[str, tuple[float, float]]] = {name: {} for name in PLAIN} | {
    "lognorm": {"s": (-2, 0.5)},
    "weibull": {"c": (-0.5, 1)},
    "gamma": {"a": (-1, 2)},
    "beta": {"a": (-0.7, 1), "b": (-0.7, 1)},
    "t": {"df": (-0.3, 2)},
    "pareto": {"b": (-0.5, 1)},
    "genextreme": {"c": (-2, 0.5)},
    "skewnorm": {"a": (-1, 1)},
    "triang": {"c": (-2, 0)},
    "truncnorm": {"a": (-1, 0), "b": (0.2, 1)},
    "invgauss": {"mu": (-1, 0.5)},
}
"""Families of scipy.stats, with the powers of ten between which their shape parameters lie."""
HEAVY = ("cauchy", "genextreme", "levy", "pareto", "t")  # families that need not have a variance


def seldom(draw: Draw, one_in: int) -> bool:
    """Return True once in so many times."""
    return bool(draw(st.integers(0, one_in - 1)) == one_in - 1)


def power_of_ten(draw: Draw, low: float, high: float) -> float:
    """Draw a number between two powers of ten."""
    return float(10.0 ** draw(st.floats(low, high)))


def number(draw: Draw, low: float, high: float, unit: float = 1.0) -> float:
    """Draw a number between two powers of ten, times a unit; seldom an extreme one."""
    if seldom(draw, ONE_IN):
        return float(draw(st.sampled_from(EXTREME)))
    return float(f"{unit * power_of_ten(draw, low, high):.4g}")


def quantity(draw: Draw, value: float, dimension: str) -> float | str:
    """Draw how a value is written: in SI, or as a string with a unit."""
    units = UNITS.get(dimension, {})
    unit = draw(st.sampled_from(["", *units]))
    return f"{value / units[unit]:.6g} {unit}" if unit else value


def distribution(draw: Draw, size: float, dimension: str, *, positive: bool, bounded: bool = False) -> Table:
    """Draw a distribution of about this size, around it where it is to be positive, else around 0."""
    family = draw(st.sampled_from(sorted(FAMILIES)))
    table: Table = {"distribution": family, **{key: number(draw, *ends) for key, ends in FAMILIES[family].items()}}
    spread = size * power_of_ten(draw, -2.0, 0.5) if positive else size
    by_moments = family == "lognormal" or (seldom(draw, 8) if family in HEAVY else draw(st.booleans()))
    middle, width = ("mean", "std") if by_moments else ("loc", "scale")
    table[width] = quantity(draw, spread, dimension)
    if positive and (by_moments or draw(st.booleans())):
        table[middle] = quantity(draw, size, dimension)
    elif family == "lognormal":
        table[middle] = quantity(draw, number(draw, -1.0, 1.0, size), dimension)
    if bounded or (positive and not seldom(draw, 6)):
        table["min"] = quantity(draw, size * (0.35 if bounded else power_of_ten(draw, -2.0, -0.1)), dimension)
    elif not positive and seldom(draw, 4):
        table["min"] = quantity(draw, -size * power_of_ten(draw, -1.0, 1.0), dimension)
    if bounded or seldom(draw, 3):
        table["max"] = quantity(draw, size * (3.0 if bounded else power_of_ten(draw, 0.1, 1.5)), dimension)
    return table


def entry(draw: Draw, size: float, dimension: str, *, bounded: bool = False) -> Any:
    """Draw a shape parameter: a number, a string with a unit, or a distribution."""
    if size in EXTREME or draw(st.booleans()):
        return quantity(draw, size, dimension)
    return distribution(draw, size, dimension, positive=True, bounded=bounded)


_VARIABLES = sorted(name for name in CURVE_VARIABLES | CONDUCTANCES if name != "stiffness" and "energy" not in name)


def viscoelastic(draw: Draw, size: float, datum: float) -> Table:
    """Draw [viscoelastic], with the [path] and the variables that it allows; heights are of a size around a datum."""
    count = draw(st.integers(1, 3))
    terms = [{"time": number(draw, -12.0, 12.0), "share": draw(st.floats(0.0, 1.0)) / count} for _ in range(count)]
    section: Table = {"relaxation": terms, "speed": number(draw, -12.0, 12.0, size)}
    if draw(st.booleans()):
        section["retraction_speed"] = number(draw, -12.0, 12.0, size)
    start, stop = draw(st.floats(0.0, 5.0)), draw(st.floats(-3.0, -0.1))
    steps = draw(st.integers(2, 15))
    separation = {"start": datum + start * size, "stop": datum + stop * size, "steps": steps}
    path: Table = {"separation": separation, "unload": draw(st.booleans()), "hold": draw(st.integers(0, 3))}
    if path["unload"] or path["hold"]:
        section["dwell"] = draw(st.sampled_from((0.0, power_of_ten(draw, -12.0, 12.0))))
    return {"viscoelastic": section, "path": path, "output": {"variables": _VARIABLES}}
