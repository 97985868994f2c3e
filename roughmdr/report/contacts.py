"""Contacts of a result in words: how few carry the load, their mean pressure, errors of what passes through them."""

import math
from collections.abc import Iterator

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import format_quantity

_FEW = 10.0
"""Effective number of contacts below which the load of a sample scatters by more than a third of itself."""

_SAMPLES = {"surface": "map", "spectrum": "map", "file": "ensemble"}  # words for a sample, by source
_ELASTIC = "plastic flow is not modelled: above about the hardness of the softer body they yield, and become larger"
_ERRORS = {"conductance": "conductance_error", "sticking": "tangential_error"}


def describe_sample(effective: list[Floats], scene: str) -> str:
    """Return where few contacts carry the load at closest approach in cells of a scene, as TOML; empty where none do.

    ``effective`` are the effective numbers of contacts in the runs of each cell, above 0 where they are known; their
    median counts. Nothing is said where the scene asks for so few asperities.
    """
    runs = [cell[np.isfinite(cell) & (cell > 0.0)] for cell in effective]
    known = [float(np.median(cell)) for cell in runs if cell.size]
    few = [number for number in known if number < _FEW]
    asperities = parse_toml(scene).get("asperities")
    if not few or not isinstance(asperities, dict):
        return ""
    count = asperities.get("count")
    if isinstance(count, int) and count < _FEW:
        return ""
    least = min(few)
    counted = " to ".join(dict.fromkeys(f"{number:.2g}" for number in (least, max(few))))
    share = f" in {len(few)} of {len(known)} cells" if len(known) > 1 else ""
    sample = _SAMPLES.get(str(asperities.get("source")), "realisation")
    scatter = f"{'up to ' if len(few) > 1 else ''}about {100.0 / math.sqrt(least):.2g} %"
    return (
        f"about {counted} contacts carry the load at closest approach{share}: one {sample} is one sample; at the same "
        f"separation the load of another differs by {scatter}"
    )


def sample_of_result(result: ResultView) -> str:
    """Return that of a result; empty where an earlier version did not store what it takes."""
    if "effective_contacts" not in result.variables:
        return ""
    runs = [np.atleast_1d(result.variables["effective_contacts"].values[cell]) for cell in result.cells]
    return describe_sample(runs, result.attrs["scene"])


def contact_pressure_lines(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield mean force over mean contact area where that area is largest; nothing without both, or under tension."""
    asperities, elements = _range(result, ""), _range(result, "reference_")
    if asperities:
        beside = f", {elements} by boundary elements," if elements else ""
        yields = "hardness tells which of them yield" if "yielded_load_fraction" in result.variables else _ELASTIC
        yield "pressure", f"{asperities}{beside} on average in the contacts at closest approach; {yields}"


def _range(result: ResultView, of: str) -> str:
    """Return the pressures of all cells; ``of`` is what the names of the variables begin with."""
    if not result.holds(f"{of}force") or (area := _mean_area(result, of)) is None:
        return ""
    force = result.mean(f"{of}force")[0]
    known = np.where(np.isfinite(area) & np.isfinite(force), area, 0.0)
    closest = known.argmax(axis=-1)[..., None]
    largest, there = (np.take_along_axis(each, closest, -1)[..., 0] for each in (known, force))
    pressed = (largest > 0.0) & (there > 0.0)
    if not pressed.any():
        return ""
    pressure = there[pressed] / largest[pressed]
    low, high = float(pressure.min()), float(pressure.max())
    return format_quantity(low, "Pa", to=high if high > 1.01 * low else None)


def _mean_area(result: ResultView, of: str) -> Floats | None:
    """Return the mean contact area [m2] over swept keys and step; None where a result does not have it."""
    if result.holds(f"{of}contact_area"):
        return result.mean(f"{of}contact_area")[0]
    if result.holds(fraction := f"{of}contact_fraction") and "nominal_area" in result.variables:
        return np.asarray(result.mean(fraction)[0] * result.variables["nominal_area"].values[..., None])
    return None


def conduction_lines(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield within which errors these hold at given separation, where a result has them."""
    for label, name in _ERRORS.items():
        if name in result.variables:
            known = result.known(name).size
            within = f"at given separation within about {100.0 * result.largest(name):.2g} %" if known else ""
            yield label, within or "its error is not known: the asperities have no nominal area"
