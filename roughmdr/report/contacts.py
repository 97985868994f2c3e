"""Contacts of a result in words: how far one sample stands for others, mean pressure, errors of what passes through."""

from collections.abc import Iterator, Mapping

import numpy as np

from roughmdr.model_error.parts import PLASTIC
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import format_quantity
from roughmdr.variables import SAMPLE

_FEW = 10
"""Number of asperities below which a scene asks for just these: nothing is said of other samples."""
_TOLD = 0.01
"""Sampling error below which nothing is said."""

_SAMPLES = {"surface": "map", "spectrum": "map", "file": "ensemble"}  # words for a sample, by source
_ELASTIC = "; plastic flow is not modelled: above about the hardness of the softer body they yield, and become larger"
_ERRORS = {"conductance": "conductance_error", "sticking": "tangential_error"}


def describe_sample(numbers: Mapping[str, Floats], scene: str) -> str:
    """Return how far another sample than that of each cell of a scene, as TOML, differs at closest approach.

    ``numbers`` are ``SAMPLE`` in the cells, NaN where they are not known. Empty where nothing is of note, and where the
    scene asks for few asperities.
    """
    asperities, errors = parse_toml(scene).get("asperities", {}), numbers["sampling_error"]
    count = asperities.get("count")
    if not np.fmax.reduce(errors, initial=0.0) >= _TOLD or (isinstance(count, int) and count < _FEW):
        return ""
    sample = _SAMPLES.get(str(asperities.get("source")), "realisation")
    area = numbers["area_sampling_error"]
    of_area = f", at the same force the contact area by {_from_to(100.0 * area)} %" if np.isfinite(area).any() else ""
    return (
        f"about {_from_to(numbers['effective_contacts'])} contacts carry the load at closest approach: one {sample} is "
        f"one sample; at the same separation the load of another differs by about {_from_to(100.0 * errors)} %{of_area}"
    )


def _from_to(values: Floats) -> str:
    return " to ".join(dict.fromkeys(f"{end(values):.2g}" for end in (np.fmin.reduce, np.fmax.reduce)))


def sample_of_result(result: ResultView) -> str:
    """Return that of a result with one realisation; empty for one of a version that did not store what it takes."""
    if result.realizations > 1 or not set(SAMPLE) <= result.variables.keys():
        return ""
    return describe_sample({name: result.variables[name].values.ravel() for name in SAMPLE}, result.attrs["scene"])


def contact_pressure_lines(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield mean force over mean contact area where that area is largest; nothing without both, or under tension."""
    asperities, elements = _range(result, ""), _range(result, "reference_")
    if asperities:
        beside = f", {elements} by boundary elements," if elements else ""
        told = "; hardness tells which of them yield" if "yielded_load_fraction" in result.variables else _ELASTIC
        told = "" if PLASTIC in result.variables else told
        yield "pressure", f"{asperities}{beside} on average in the contacts at closest approach{told}"


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
