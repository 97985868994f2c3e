"""Contacts of a result in words: how far a sample stands for others, pressure, pull-off, errors of conduction."""

import math
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from roughmdr.model_error.parts import PLASTIC
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import format_quantity
from roughmdr.variables import LATERAL, SAMPLE, TRAVEL

_FEW = 10
"""Number of asperities below which a scene asks for just these: nothing is said of other samples."""
_TOLD = 0.01
"""Sampling error below which nothing is said."""
_SAMPLES = {"surface": "map", "spectrum": "map", "file": "ensemble"}  # words for a sample, by source
_ELASTIC = "; plastic flow is not modelled: above about the hardness of the softer body they yield, and become larger"
_ERRORS = {"conductance": "conductance_error", "sticking": "tangential_error"}
_FEW_CONTACTS = 10.0
"""Contacts: the number of fewer that carry the tension of a patch scatters by more than a third of itself."""
_MAX_CELLS = 30


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


def describe_pull_off(result: ResultView, not_known: str) -> Iterator[tuple[str, str]]:
    """Yield the pull-off of each cell, and how it is defined; ``not_known`` stands for cells that were not computed."""
    if result.control == LATERAL.name:
        return
    if "unloading" not in result.branches:
        yield "pull-off", "none: the path has no unloading"
        return
    if "pull_off_count" not in result.variables:
        yield "pull-off", "not stored: the result was made before pull-offs were"
        return
    cells = result.cells
    lines = [_describe_cell(result, cell) or not_known for cell in cells[:_MAX_CELLS]]
    width = max(map(len, lines))
    for number, (line, cell) in enumerate(zip(lines, cells, strict=False)):
        yield "" if number else "pull-off", f"{line:<{width}}  {result.label(cell)}".rstrip()
    if len(cells) > _MAX_CELLS:
        yield "", f"... and {len(cells) - _MAX_CELLS} more cells"
    contacts = result.mean("pull_off_contacts")[0].ravel()
    if (few := contacts[contacts < _FEW_CONTACTS]).size:
        counted = f"{few.min():.2g}" if few.size == 1 else f"{few.min():.2g} to {few.max():.2g}"
        share = f" in {few.size} of {len(cells)} cells" if len(cells) > 1 else ""
        verb = "carries" if few.max() == few.min() == 1.0 else "carry"
        noun = "contact" if verb == "carries" else "contacts"
        small = "a patch this small" if result.flat else "a body on so few"
        yield "", f"{counted} {noun} {verb} it{share}: {small} does not show the pull-off of a surface"
    yield "", f"({_definition(result)})"


def _definition(result: ResultView) -> str:
    if result.estimator == "expected":
        return "largest tension of the expected law; realisations detach contact by contact and go deeper"
    if result.realizations == 1:
        return "largest tension during unloading; one realisation has no standard error"
    mean = "" if result.control == TRAVEL.name else "; that of the mean law is less"
    return f"largest tension of each realisation during unloading: mean ± standard error{mean}"


def _describe_cell(result: ResultView, cell: tuple[int, ...]) -> str:
    """Describe the pull-off of a cell; empty where no run was computed."""
    runs = _runs(result)[cell]
    having = int(result.pull_off_counts[cell])
    if not runs:
        return ""
    if not having:
        return f"none: {'the unloading ends' if runs == 1 else f'all {runs} unloadings end'} in contact"
    force, error = (float(values[cell]) for values in result.mean("pull_off_force"))
    without = f"; {runs - having} of {runs} unloadings end in contact and have none" if having < runs else ""
    if force == 0.0:
        return f"0 N: contacts part without tension{without}"
    text = format_quantity(force, "N", error=error)
    if result.holds("pull_off_pressure") and math.isfinite(pressure := result.mean("pull_off_pressure")[0][cell]):
        text += f", {format_quantity(float(pressure), 'Pa')}"
    of_mean = float(result.variables["pull_off_force_of_mean"].values[cell])
    if runs > 1 and result.control != TRAVEL.name:  # at equal travel realisations stand at different places
        text += (
            "; the mean law has none" if math.isnan(of_mean) else f"; of the mean law {format_quantity(of_mean, 'N')}"
        )
    return text + without


def _runs(result: ResultView) -> NDArray[np.int64]:
    """Return the number of realisations of each cell that were computed."""
    done = result.done
    if result.keeps_runs:
        return np.asarray(done.sum(axis=-1))
    return np.where(done, result.variables["realization_count"].values, 0).astype(np.int64)
